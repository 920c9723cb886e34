//! A curve as a reader sees it: no more points than pixels can show.

/// Curve with at most four points per half pixel of width and without points that move it by less than a twentieth of
/// a pixel: the first, last, lowest and highest point of each half pixel stay, so no peak is lost.
pub(crate) fn visible(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    straighten(&thin(points), 0.05)
}

/// Keeps first, lowest, highest and last point of every half-pixel column.
fn thin(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let mut start = 0;
    while start < points.len() {
        let column = (points[start].0 * 2.0).floor();
        let mut end = start + 1;
        while end < points.len()
            && (points[end].0 * 2.0).floor() >= column
            && (points[end].0 * 2.0).floor() < column + 1.0
        {
            end += 1;
        }
        let mut indices = [start, start, start, end - 1];
        for index in start..end {
            if points[index].1 < points[indices[1]].1 {
                indices[1] = index;
            }
            if points[index].1 > points[indices[2]].1 {
                indices[2] = index;
            }
        }
        indices.sort_unstable();
        let mut previous = None;
        for index in indices {
            if previous != Some(index) {
                kept.push(points[index]);
                previous = Some(index);
            }
        }
        start = end;
    }
    kept
}

/// Drops points that lie within `tolerance` px of the line between their kept neighbours (Douglas and Peucker, 1973).
fn straighten(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[points.len() - 1] = true;
    let mut pending = vec![(0, points.len() - 1)];
    while let Some((first, last)) = pending.pop() {
        let mut worst = (0.0, first);
        for index in first + 1..last {
            let distance = distance_to_segment(points[index], points[first], points[last]);
            if distance > worst.0 {
                worst = (distance, index);
            }
        }
        if worst.0 > tolerance {
            keep[worst.1] = true;
            pending.push((first, worst.1));
            pending.push((worst.1, last));
        }
    }
    points.iter().zip(keep).filter_map(|(&point, keep)| keep.then_some(point)).collect()
}

fn distance_to_segment((x, y): (f64, f64), (ax, ay): (f64, f64), (bx, by): (f64, f64)) -> f64 {
    let (dx, dy) = (bx - ax, by - ay);
    let length_squared = dx * dx + dy * dy;
    let along =
        if length_squared > 0.0 { (((x - ax) * dx + (y - ay) * dy) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    let (ex, ey) = (x - ax - along * dx, y - ay - along * dy);
    (ex * ex + ey * ey).sqrt()
}

#[cfg(test)]
mod tests {
    use super::visible;

    #[test]
    fn analytic_a_straight_line_keeps_its_ends_only() {
        let line: Vec<(f64, f64)> = (0..=1000).map(|k| (f64::from(k), 2.0 * f64::from(k))).collect();
        assert_eq!(visible(&line), vec![(0.0, 0.0), (1000.0, 2000.0)]);
    }

    #[test]
    fn analytic_a_spike_survives_thinning() {
        let mut noise: Vec<(f64, f64)> = (0..100_000).map(|k| (f64::from(k) * 0.002, f64::from(k % 3))).collect();
        noise[54_321].1 = 77.0;
        noise[60_001].1 = -55.0;
        let drawn = visible(&noise);
        assert!(drawn.len() < 2000, "{} points for 200 px", drawn.len());
        assert!(drawn.contains(&noise[54_321]) && drawn.contains(&noise[60_001]));
    }
}
