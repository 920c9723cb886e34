//! Intervals at a stated confidence.

use super::distribution::{normal_quantile, student_quantile};
use super::sample::{mean, variance};

/// A two-sided interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Whether a value lies inside, ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// The interval of the value whose logarithm has this one.
    #[must_use]
    pub fn exponentiated(self) -> Self {
        Self { low: libm::exp(self.low), high: libm::exp(self.high) }
    }
}

/// Interval for the mean of independent values by Student's t at confidence `level`; `None` of fewer than two.
pub fn t_interval(values: &[f64], level: f64) -> Option<Interval> {
    mean_interval(values, 0.5 + 0.5 * level)
}

/// Interval for the mean that ends at Student's quantile of this share; `None` of fewer than two values.
pub(super) fn mean_interval(values: &[f64], share: f64) -> Option<Interval> {
    let n = values.len();
    if n < 2 {
        return None;
    }
    let t = student_quantile(share, (n - 1) as f64);
    let (m, half) = (mean(values), t * (variance(values) / n as f64).sqrt());
    Some(Interval { low: m - half, high: m + half })
}

/// Wilson's score interval for a proportion of `hits` in `trials` at confidence `level` (E. B. Wilson, JASA 22, 1927).
pub fn wilson_interval(hits: usize, trials: usize, level: f64) -> Option<Interval> {
    share_interval(hits as f64 / trials.max(1) as f64, trials, level)
}

/// Wilson's score interval for a share `p` of `trials`, which need not be a whole number of them: trials that are all alike
/// within groups count as one for each group.
pub fn share_interval(p: f64, trials: usize, level: f64) -> Option<Interval> {
    if trials == 0 {
        return None;
    }
    let z = normal_quantile(0.5 + 0.5 * level);
    let n = trials as f64;
    let centre = p + z * z / (2.0 * n);
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z * z / n;
    // Rounding may leave the ends a last bit inside of p where p is 0 or 1.
    Some(Interval { low: ((centre - half) / scale).clamp(0.0, p), high: ((centre + half) / scale).clamp(p, 1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_wilson_interval() {
        // Newcombe, Statistics in Medicine 17 (1998), table I, method 3: 81 of 263 gives 0.2553 to 0.3662.
        let interval = wilson_interval(81, 263, 0.95).unwrap();
        assert!((interval.low - 0.2553).abs() < 5e-5 && (interval.high - 0.3662).abs() < 5e-5);
    }

    #[test]
    fn published_t_interval() {
        // Student's t table: the 97.5 % quantile with 4 degrees of freedom is 2.776.
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        let interval = t_interval(&values, 0.95).unwrap();
        let half = 2.776 * (2.5_f64 / 5.0).sqrt();
        assert!((interval.high - (3.0 + half)).abs() < 5e-4 && (interval.low - (3.0 - half)).abs() < 5e-4);
        // Of two values it has one degree of freedom: 12.706.
        assert!((t_interval(&[1.0, 3.0], 0.95).unwrap().high - 14.706).abs() < 5e-4);
        assert_eq!(t_interval(&[1.0], 0.95), None);
    }
}
