//! An estimate with other error bars than those of its equations.

use nalgebra::DMatrix;

use super::estimate::Estimate;
use super::finding::Finding;
use super::poorly_determined::poorly_determined;
use crate::statistics::student_quantile;

impl Estimate {
    /// With another covariance (b × b), and intervals of its standard deviations around the values.
    pub(super) fn with_covariance(mut self, covariance: &DMatrix<f64>) -> Self {
        let t = student_quantile(0.975, self.degrees_of_freedom);
        for (j, p) in self.base.iter_mut().enumerate() {
            p.std = covariance[(j, j)].max(0.0).sqrt();
            p.ci95 = [p.value - t * p.std, p.value + t * p.std];
        }
        let b = self.base.len();
        self.covariance =
            (0..b).map(|i| (0..b).map(|j| 0.5 * (covariance[(i, j)] + covariance[(j, i)])).collect()).collect();
        self.noise_covariance = Vec::new();
        self.findings.retain(|finding| !matches!(finding, Finding::PoorlyDetermined { .. }));
        let mut findings = poorly_determined(&self.base);
        findings.append(&mut self.findings);
        Self { findings, ..self }
    }
}
