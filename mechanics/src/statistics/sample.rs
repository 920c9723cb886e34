//! What describes a sample: mean, variance, quantiles.

/// Arithmetic mean; 0 of nothing.
pub fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// Unbiased sample variance, with n − 1; 0 of fewer than two values.
pub fn variance(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let m = mean(values);
    values.iter().map(|v| (v - m) * (v - m)).sum::<f64>() / (values.len() - 1) as f64
}

/// Root of the mean square; 0 of nothing.
pub fn root_mean_square(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt() }
}

/// The `p` quantile by linear interpolation between order statistics (Hyndman & Fan 1996, definition 7); `None` of
/// nothing.
pub fn quantile(values: &[f64], p: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile_of_sorted(&sorted, p)
}

fn quantile_of_sorted(sorted: &[f64], p: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let at = p.clamp(0.0, 1.0) * last as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(last);
    Some(sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64))
}

/// Five numbers that a box plot draws: 5 %, 25 %, 50 %, 75 % and 95 % quantiles.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Spread {
    /// 5 % quantile.
    pub low: f64,
    /// 25 % quantile.
    pub lower_quartile: f64,
    /// Median.
    pub median: f64,
    /// 75 % quantile.
    pub upper_quartile: f64,
    /// 95 % quantile.
    pub high: f64,
}

impl Spread {
    /// The five numbers of a sample; `None` where it is empty.
    pub fn new(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        Some(Self {
            low: quantile_of_sorted(&sorted, 0.05)?,
            lower_quartile: quantile_of_sorted(&sorted, 0.25)?,
            median: quantile_of_sorted(&sorted, 0.5)?,
            upper_quartile: quantile_of_sorted(&sorted, 0.75)?,
            high: quantile_of_sorted(&sorted, 0.95)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_quantiles_of_the_definition() {
        // R: quantile(c(1,2,3,4,10), c(.1,.5,.75), type = 7) gives 1.4, 3, 4.
        let values = [10.0, 1.0, 3.0, 2.0, 4.0];
        for (p, expected) in [(0.1, 1.4), (0.5, 3.0), (0.75, 4.0)] {
            assert!((quantile(&values, p).unwrap() - expected).abs() < 1e-15);
        }
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn analytic_the_root_mean_square_of_3_and_4_is_that_of_12_5() {
        assert_eq!(root_mean_square(&[3.0, -4.0]), 12.5_f64.sqrt());
        assert_eq!(root_mean_square(&[]), 0.0);
    }
}
