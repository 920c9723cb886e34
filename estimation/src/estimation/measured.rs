//! A number with its uncertainty.

use crate::statistics::student_quantile;

/// A measured number.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub std: f64,
    /// Ends of the 95 % interval.
    pub ci95: [f64; 2],
}

impl Measured {
    /// A value whose standard deviation was estimated with some degrees of freedom.
    pub fn new(value: f64, std: f64, freedom: f64) -> Self {
        let half = student_quantile(0.975, freedom) * std;
        Self { value, std, ci95: [value - half, value + half] }
    }

    /// This number in another unit, `factor` times as large.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let [low, high] = self.ci95.map(|end| factor * end);
        Self { value: factor * self.value, std: factor.abs() * self.std, ci95: [low.min(high), low.max(high)] }
    }
}
