//! The result of an estimator.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::consistent_set::definite_inverse;
use super::effect_size::EffectSize;
use super::error::EstimationError;
use super::factorisation::FactorisedBy;
use super::finding::Finding;
use super::load_friction;
use super::position_servo::ServoEstimate;
use super::termination::Termination;
use crate::base::BaseReduction;
use crate::model::term::Sign;
use crate::model::{Columns, ParameterId, Robot};
use crate::provenance::Provenance;
use crate::regressor::JointTorqueRegressor;
use crate::statistics::student_quantile;

/// Standard deviations below zero beyond which a coefficient that cannot be negative is an error of the model.
const IMPOSSIBLE: f64 = 3.0;

/// One base parameter.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BaseEstimate {
    /// Name of the parameter that stands for the combination.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// 95 % interval, lower and upper end; infinite (`null`) where it is withheld ([`Finding::Impossible`]).
    #[serde(deserialize_with = "crate::plain::infinite::interval")]
    pub ci95: [f64; 2],
    /// Unit of all of them.
    pub unit: String,
    /// The part of the standard deviation that the robot file declares, in its square: what no residual shows. Zero where it declares
    /// nothing.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub declared_std: f64,
}

/// A matrix row by row, as a file has it.
pub(super) fn rows_of(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// The rows of a symmetric matrix by its lower triangle: a file, which has no other, reads back to the same bits.
pub(super) fn symmetric_rows_of(mut matrix: DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.fill_upper_triangle_with_lower_triangle();
    rows_of(&matrix)
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
    /// Shape parameters of the friction laws of each joint that the estimate was made with, where they are not their defaults, by their keys in
    /// the robot file, n; empty where it is not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shape: Vec<BTreeMap<String, f64>>,
    /// Base parameters β̂, b.
    pub base: Vec<BaseEstimate>,
    /// Covariance of β̂, b rows of b.
    pub covariance: Vec<Vec<f64>>,
    /// The part of it that is of noise, b rows of b: what more motion averages out. Empty where all of it is, and of estimators that do not
    /// tell them apart. A file has its rows up to the diagonal.
    #[serde(default, skip_serializing_if = "Vec::is_empty", with = "super::lower_triangle")]
    pub noise_covariance: Vec<Vec<f64>>,
    /// What one standard deviation of each declared quantity of the motors adds to β̂, b rows: torque constant and lag, motor by motor. It
    /// is part of the covariance, and the same error in every log of the arm. Empty where none is declared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motor_errors: Vec<Vec<f64>>,
    /// What was estimated of position servos, in the order in which it was asked for; empty where nothing was.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub servo: Vec<ServoEstimate>,
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
    /// Condition number of the equations with columns of unit length.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub condition_scaled: f64,
    /// The method that condensed the equations of a long recording.
    #[serde(default)]
    pub factorised_by: FactorisedBy,
    /// The source of the noise behind the intervals.
    pub interval_basis: IntervalBasis,
    /// Degrees of freedom behind the intervals.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub degrees_of_freedom: f64,
    /// Equations of each joint.
    pub samples: usize,
    /// Periods that were averaged.
    pub periods: usize,
    /// Effects that the model omits and the log was tested for; empty where none was.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<EffectSize>,
    /// Findings about the estimate, each with advice.
    pub findings: Vec<Finding>,
    /// How the estimator ended.
    pub termination: Termination,
    /// Version, robot and seed that produced it, where the recording holds them.
    pub provenance: Option<Provenance>,
}

crate::plain::checked_when_read!(Estimate, |value| value.check().map(|()| value));

impl Estimate {
    /// Tables of the size that they say, and intervals around their values.
    fn check(&self) -> Result<(), String> {
        let (b, n) = (self.base.len(), self.units.len());
        let sizes = [("covariance", self.covariance.len(), b)]
            .into_iter()
            .chain(self.covariance.iter().map(|row| ("a row of covariance", row.len(), b)))
            .chain((!self.noise_covariance.is_empty()).then_some(("noise_covariance", self.noise_covariance.len(), b)))
            .chain(self.noise_covariance.iter().map(|row| ("a row of noise_covariance", row.len(), b)))
            .chain((!self.motor_errors.is_empty()).then_some(("motor_errors", self.motor_errors.len(), b)))
            .chain(self.motor_errors.iter().map(|row| ("a row of motor_errors", row.len(), self.motor_errors[0].len())))
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

    /// The robot with the shape parameters that the estimate, which is one of these columns, was made with.
    ///
    /// # Errors
    /// [`EstimationError::Count`] where the robot has other joints.
    pub fn robot(&self, robot: &Robot, columns: Columns) -> Result<Robot, EstimationError> {
        if self.shape.is_empty() {
            return Ok(robot.clone());
        }
        EstimationError::unless_equal("joints of the robot", robot.dof(), self.shape.len())?;
        let mut drives: Vec<_> = robot.joints().iter().map(|joint| joint.drive.clone()).collect();
        for (drive, stated) in drives.iter_mut().zip(&self.shape) {
            for shape in columns.shapes() {
                drive.set_shape(&shape, stated.get(shape.key).copied().unwrap_or(shape.default));
            }
        }
        Ok(robot.clone().with_drives(drives))
    }

    /// The regressor of its columns by which it predicts torque: with its shape parameters, the torque of the links being that of its own
    /// parameters.
    ///
    /// # Errors
    /// As [`Self::robot`]; [`EstimationError::Columns`] where a column depends on what no recording has.
    pub fn regressor(&self, robot: &Robot, columns: Columns) -> Result<JointTorqueRegressor, EstimationError> {
        let regressor = load_friction::regressor_of(&self.robot(robot, columns)?, columns)?;
        let value = |id: &ParameterId| {
            let name = id.to_string();
            self.base.iter().find(|of| of.name == name).map_or(0.0, |of| of.value)
        };
        let count = if regressor.needs_load() { 10 * robot.dof() } else { 0 };
        let links: Vec<f64> = regressor.parameters()[..count].iter().map(value).collect();
        Ok(regressor.with_links(&links))
    }

    /// Adds to the covariance, b × b, and widens the intervals around the same values.
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

    /// Withholds the intervals of coefficients that no arm has, and says so in one finding: those below zero by more than three standard
    /// deviations that cannot be negative, and are a base parameter alone.
    pub(super) fn withhold_impossible(&mut self, base: &BaseReduction) {
        let is_positive = |id: ParameterId| id.kind.term().is_some_and(|term| term.entry().sign == Sign::NotNegative);
        let mut parameters = Vec::new();
        for ((row, &kept), parameter) in base.kept.iter().enumerate().zip(&mut self.base) {
            let is_alone = base.k.row(row).iter().filter(|entry| **entry != 0.0).count() == 1;
            if is_alone && is_positive(base.parameters[kept]) && parameter.value < -IMPOSSIBLE * parameter.std {
                parameter.ci95 = [f64::NEG_INFINITY, f64::INFINITY];
                parameters.push(parameter.name.clone());
            }
        }
        if !parameters.is_empty() {
            let said = |finding: &Finding| {
                let Finding::NegativeDrive { parameter, .. } = finding else { return false };
                parameters.contains(parameter)
            };
            self.findings.retain(|finding| !said(finding));
            self.findings.push(Finding::Impossible { parameters });
        }
    }

    /// β̂, length b.
    pub fn beta(&self) -> DVector<f64> {
        DVector::from_iterator(self.base.len(), self.base.iter().map(|p| p.value))
    }

    /// Standard deviations, length b.
    pub fn std(&self) -> DVector<f64> {
        DVector::from_iterator(self.base.len(), self.base.iter().map(|p| p.std))
    }

    /// Half widths of the 95 % intervals, length b.
    pub fn half_width(&self) -> DVector<f64> {
        DVector::from_iterator(self.base.len(), self.base.iter().map(|p| 0.5 * (p.ci95[1] - p.ci95[0])))
    }

    /// Names of the base parameters, b.
    pub fn names(&self) -> Vec<String> {
        self.base.iter().map(|p| p.name.clone()).collect()
    }

    /// The information of the estimate on β, `C⁻¹` (b × b), as a prior for the next experiment; `None` where the covariance is
    /// not positive definite.
    pub fn information(&self) -> Option<DMatrix<f64>> {
        definite_inverse(&self.covariance_matrix())
    }

    /// [`Self::motor_errors`] as a matrix, b × as many; without columns where none is declared.
    pub fn motor_errors_matrix(&self) -> DMatrix<f64> {
        let columns = self.motor_errors.first().map_or(0, Vec::len);
        DMatrix::from_fn(self.base.len(), columns, |i, j| self.motor_errors[i][j])
    }

    /// Covariance of β̂, b × b.
    pub fn covariance_matrix(&self) -> DMatrix<f64> {
        self.square(&self.covariance)
    }

    /// Covariance of β̂ by noise alone, b × b.
    pub fn noise_covariance_matrix(&self) -> DMatrix<f64> {
        self.square(if self.noise_covariance.is_empty() { &self.covariance } else { &self.noise_covariance })
    }

    fn square(&self, rows: &[Vec<f64>]) -> DMatrix<f64> {
        let b = self.base.len();
        DMatrix::from_fn(b, b, |i, j| rows[i][j])
    }
}
