//! The result of an estimator.

use nalgebra::{Cholesky, DMatrix, DVector};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Finding, Termination};
use crate::provenance::Provenance;
use crate::statistics::student_quantile;

/// One base parameter.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BaseEstimate {
    /// Name of the parameter that stands for the combination.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// 95 % interval, lower and upper end.
    pub ci95: [f64; 2],
    /// Unit of all of them.
    pub unit: String,
    /// The part of the standard deviation that the robot file declares, in its square: what no residual shows. Zero where it declares
    /// nothing.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub declared_std: f64,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(std: &f64) -> bool {
    *std == 0.0
}

/// One standard parameter of a completed set.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StandardEstimate {
    /// Its name.
    pub name: String,
    /// Its value, in SI units.
    pub value: f64,
}

/// The source of the noise behind the intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum IntervalBasis {
    /// The scatter over repeated periods: noise alone.
    Scatter,
    /// The residual of the fit: noise and model errors.
    Residual,
    /// The scatter over repeated periods, and beyond it what the residual shows of a torque that the model lacks.
    Discrepancy,
}

/// Base parameters with their uncertainty, and how well the model explains the torque. Serialises to the keys of the
/// `identify` command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub struct Estimate {
    /// Name of the estimator.
    pub estimator: String,
    /// Name of the robot.
    pub robot: String,
    /// Name of the columns that were estimated.
    pub columns: String,
    /// Base parameters β̂, b.
    pub base: Vec<BaseEstimate>,
    /// Covariance of β̂, b rows of b.
    pub covariance: Vec<Vec<f64>>,
    /// A full set of standard parameters φ with `K φ = β̂`, where one was asked for.
    pub standard: Option<Vec<StandardEstimate>>,
    /// Whether that set is physically consistent.
    pub consistent: Option<bool>,
    /// RMS residual of each joint, n.
    pub residual_rms: Vec<f64>,
    /// Standard deviation of the noise in the equations of each joint, after averaging and filter, n.
    pub noise_std: Vec<f64>,
    /// Unit of both, n.
    pub units: Vec<String>,
    /// Condition number of W_b as the estimator solved it.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub condition: f64,
    /// The same with columns of unit length.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub condition_scaled: f64,
    /// The source of the noise behind the intervals.
    pub interval_basis: IntervalBasis,
    /// Degrees of freedom behind the intervals.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub degrees_of_freedom: f64,
    /// Equations of each joint.
    pub samples: usize,
    /// Periods that were averaged.
    pub periods: usize,
    /// Findings about the estimate, each with advice.
    pub findings: Vec<Finding>,
    /// How the estimator ended.
    pub termination: Termination,
    /// Version, robot and seed that produced it, where the recording holds them.
    pub provenance: Option<Provenance>,
}

impl Serialize for Estimate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

/// Refuses what does not fit together.
impl<'de> Deserialize<'de> for Estimate {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Self::deserialize(deserializer)?;
        value.check().map_or_else(|fault| Err(D::Error::custom(fault)), |()| Ok(value))
    }
}

impl Estimate {
    /// Tables of the size that they say, and intervals around their values.
    fn check(&self) -> Result<(), String> {
        let (b, n) = (self.base.len(), self.units.len());
        let sizes = [("covariance", self.covariance.len(), b)]
            .into_iter()
            .chain(self.covariance.iter().map(|row| ("a row of covariance", row.len(), b)))
            .chain([("residual_rms", self.residual_rms.len(), n), ("noise_std", self.noise_std.len(), n)]);
        if let Some((what, found, expected)) = sizes.into_iter().find(|(_, found, expected)| found != expected) {
            return Err(format!("{what} has {found} entries, expected {expected} for {b} parameters and {n} joints"));
        }
        match self.base.iter().find(|p| !(p.std >= 0.0 && p.ci95[0] <= p.value && p.value <= p.ci95[1])) {
            Some(BaseEstimate { name, value, std, ci95: [low, high], .. }) => Err(format!(
                "{name} is {value} ± {std} in {low} to {high}, expected a deviation not below zero and an interval around \
                 the value"
            )),
            None => Ok(()),
        }
    }

    /// The same values with a covariance that has this much more in it, b × b.
    pub(super) fn add_covariance(&mut self, added: &DMatrix<f64>) {
        let t = student_quantile(0.975, self.degrees_of_freedom);
        for (i, (row, parameter)) in self.covariance.iter_mut().zip(&mut self.base).enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value += added[(i, j)];
            }
            parameter.std = row[i].max(0.0).sqrt();
            parameter.ci95 = [parameter.value - t * parameter.std, parameter.value + t * parameter.std];
        }
    }

    /// β̂, length b.
    #[must_use]
    pub fn beta(&self) -> DVector<f64> {
        DVector::from_iterator(self.base.len(), self.base.iter().map(|p| p.value))
    }

    /// Standard deviations, length b.
    #[must_use]
    pub fn std(&self) -> DVector<f64> {
        DVector::from_iterator(self.base.len(), self.base.iter().map(|p| p.std))
    }

    /// Half widths of the 95 % intervals, length b.
    #[must_use]
    pub fn half_width(&self) -> DVector<f64> {
        DVector::from_iterator(self.base.len(), self.base.iter().map(|p| 0.5 * (p.ci95[1] - p.ci95[0])))
    }

    /// Names of the base parameters, b.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        self.base.iter().map(|p| p.name.clone()).collect()
    }

    /// The information of the estimate on β, `C⁻¹` (b × b), as a prior for the next experiment; `None` where the covariance is
    /// not positive definite.
    #[must_use]
    pub fn information(&self) -> Option<DMatrix<f64>> {
        // Through standard deviations, so that unlike units do no harm.
        let (covariance, std) = (self.covariance_matrix(), self.std());
        let b = std.len();
        let scaled = DMatrix::from_fn(b, b, |i, j| 0.5 * (covariance[(i, j)] + covariance[(j, i)]) / (std[i] * std[j]));
        let inverse = Cholesky::new(scaled)?.inverse();
        Some(DMatrix::from_fn(b, b, |i, j| inverse[(i, j)] / (std[i] * std[j])))
    }

    /// Covariance of β̂, b × b.
    #[must_use]
    pub fn covariance_matrix(&self) -> DMatrix<f64> {
        let b = self.base.len();
        DMatrix::from_fn(b, b, |i, j| self.covariance[i][j])
    }
}
