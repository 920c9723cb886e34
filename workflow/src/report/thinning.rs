//! Lines thinned to what a page can show.

/// Points of a line on the page, at most.
const POINTS: usize = 400;

/// Rows of a line that keep its peaks: of each part its smallest and its largest value.
pub(super) fn extremes(values: &[f64]) -> Vec<usize> {
    if values.len() <= POINTS {
        return (0..values.len()).collect();
    }
    let part = values.len().div_ceil(POINTS / 2);
    let mut rows = Vec::with_capacity(POINTS);
    for first in (0..values.len()).step_by(part) {
        let of_part = || first..(first + part).min(values.len());
        let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
        let both = of_part().min_by(by_value).into_iter().chain(of_part().max_by(by_value));
        rows.extend(both);
    }
    rows.sort_unstable();
    rows.dedup();
    rows
}

/// Rows at even steps: a cloud of points keeps its density.
pub(super) fn every(count: usize) -> Vec<usize> {
    (0..count).step_by(count.div_ceil(POINTS).max(1)).collect()
}

/// The values of these rows, to four digits: a page shows no more, and a file is small.
pub(super) fn picked(values: &[f64], rows: &[usize]) -> Vec<f64> {
    rows.iter().map(|&row| rounded(values[row])).collect()
}

/// A value with the digits that a page can show.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::{POINTS, every, extremes, rounded};

    #[test]
    fn analytic_a_thinned_line_keeps_its_peaks_and_its_order() {
        let mut values = vec![0.0; 10_000];
        (values[4_321], values[7_777]) = (5.0, -3.0);
        let rows = extremes(&values);
        assert!(rows.contains(&4_321) && rows.contains(&7_777) && rows.len() <= POINTS);
        assert!(rows.is_sorted_by(|a, b| a < b));
        assert_eq!(extremes(&values[..3]), [0, 1, 2]);
        assert_eq!((every(3), every(10 * POINTS).len()), (vec![0, 1, 2], POINTS));
        assert_eq!((rounded(0.123_456), rounded(-98_764.0), rounded(0.0)), (0.1235, -98_760.0, 0.0));
    }
}
