//! A curve as a reader sees it: no more points than pixels can show, and dashes cut by length.

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

/// The strokes of a dashed curve: `pattern` holds the lengths of stroke and gap in turn, px.
pub(crate) fn dashes(points: &[(f64, f64)], pattern: &[f64]) -> Vec<Vec<(f64, f64)>> {
    let mut strokes = Vec::new();
    let Some(&first) = points.first() else { return strokes };
    let mut part = 0;
    let mut left = pattern[0];
    let mut stroke = vec![first];
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = (dx * dx + dy * dy).sqrt();
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let at = (from.0 + dx * done / length, from.1 + dy * done / length);
            if part % 2 == 0 {
                stroke.push(at);
                strokes.push(std::mem::take(&mut stroke));
            } else {
                stroke = vec![at];
            }
            part = (part + 1) % pattern.len();
            left = pattern[part];
        }
        left -= length - done;
        if part % 2 == 0 {
            stroke.push(to);
        }
    }
    if stroke.len() > 1 {
        strokes.push(stroke);
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::{dashes, visible};

    #[test]
    fn analytic_dashes_of_a_straight_line() {
        let strokes = dashes(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0)], &[6.0, 2.0]);
        assert_eq!(
            strokes,
            vec![
                vec![(0.0, 0.0), (6.0, 0.0)],
                vec![(8.0, 0.0), (10.0, 0.0), (14.0, 0.0)],
                vec![(16.0, 0.0), (20.0, 0.0)]
            ]
        );
    }

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
