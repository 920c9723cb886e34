//! Scores an estimate against the truth: the only place, besides the simulator, where the truth is read.
//!
//! ```text
//! prediction RMSE  √( Σ_j eᵀ G_j e / (n N) )   e = β̂ − β,  G_j = Σ_k y_j(k)ᵀ y_j(k),  y_j row j of Y_b,
//!                                              n joints, N validation samples
//! reference RMSE   √( Σ_i (e_i / u_i)² / b ) u_i the declared unit of parameter i
//! SI RMSE          √( Σ_i e_i² / b )         kg, kg·m, kg·m², N·m, N·m·s added as numbers: what a condition number bounds
//! ```
//! Nothing is divided by a true value, which may be zero. The validation trajectories are random and were not used for
//! fitting; the prediction error is the error of the model alone, without the noise of a second measurement.

use nalgebra::{DMatrix, DVector};

use super::Truth;
use super::measured_motion::MeasuredMotions;
use super::units::ReferenceUnits;
use crate::base::BaseReduction;
use crate::dynamics::States;
use crate::model::Robot;
use crate::regressor::JointTorqueRegressor;

/// Scores estimates against the truth, which it holds.
#[derive(Clone, Debug)]
pub struct Scorer {
    truths: Vec<DVector<f64>>,
    units: DVector<f64>,
    ratings: Vec<f64>,
    grams: Vec<DMatrix<f64>>,
    samples: usize,
}

/// The errors of one estimate against the truth.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Score {
    /// Torque prediction RMSE over all joints and validation samples, N·m.
    pub prediction_rmse_nm: f64,
    /// The same with every joint's torque divided by its rating, so that the wrist counts as much as the shoulder.
    pub prediction_rmse_of_rating: f64,
    /// Torque prediction RMSE of each joint, N·m.
    pub joint_rmse_nm: Vec<f64>,
    /// RMS parameter error in the declared reference units.
    pub reference_rmse: f64,
    /// RMS parameter error in SI units, numbers of unlike units added.
    pub si_rmse: f64,
    /// Torque prediction RMSE against the torque measured on fresh motions of the same arm, N·m; `None` where it performs
    /// none.
    pub measured_rmse_nm: Option<f64>,
}

impl Scorer {
    /// A scorer for the base parameters `base` of `robot`, predicting on `validation`.
    #[must_use]
    pub fn new(
        robot: &Robot,
        truths: &[Truth],
        regressor: &JointTorqueRegressor,
        base: &BaseReduction,
        validation: &[States],
        units: &ReferenceUnits,
    ) -> Self {
        let (n, b) = (robot.dof(), base.rank());
        let mut grams = vec![DMatrix::zeros(b, b); n];
        let mut samples = 0;
        for states in validation {
            samples += states.len();
            let w = base.select_columns(&regressor.stack(states));
            for (joint, gram) in grams.iter_mut().enumerate() {
                let mut rows = DMatrix::zeros(states.len(), b);
                for k in 0..states.len() {
                    rows.row_mut(k).copy_from(&w.row(k * n + joint));
                }
                *gram += rows.tr_mul(&rows);
            }
        }
        Self {
            truths: truths.iter().map(|truth| base.beta(&truth.vector(robot, regressor.columns()))).collect(),
            units: DVector::from_iterator(b, base.kept.iter().map(|&c| units.of(base.parameters[c].kind))),
            ratings: robot.joints().iter().map(|joint| joint.limits.torque).collect(),
            grams,
            samples,
        }
    }

    /// The true base parameters β of each truth, length b; the robot's own first.
    #[must_use]
    pub fn truths(&self) -> &[DVector<f64>] {
        &self.truths
    }

    /// The declared unit of each base parameter, length b.
    #[must_use]
    pub const fn units(&self) -> &DVector<f64> {
        &self.units
    }

    /// The score of an estimate β̂ (b) of the arm with one of the truths, and of what that arm measured afterwards.
    #[must_use]
    pub fn score(&self, estimate: &DVector<f64>, truth: usize, measured: Option<&MeasuredMotions>) -> Score {
        let error = estimate - &self.truths[truth];
        let joint_rmse_nm: Vec<f64> =
            self.grams.iter().map(|g| (error.dot(&(g * &error)).max(0.0) / self.samples as f64).sqrt()).collect();
        let n = joint_rmse_nm.len() as f64;
        let pooled = |weights: &dyn Fn(usize) -> f64| {
            (joint_rmse_nm.iter().enumerate().map(|(j, r)| (r * weights(j)).powi(2)).sum::<f64>() / n).sqrt()
        };
        Score {
            prediction_rmse_nm: pooled(&|_| 1.0),
            prediction_rmse_of_rating: pooled(&|j| 1.0 / self.ratings[j]),
            reference_rmse: error.component_div(&self.units).norm() / (error.len() as f64).sqrt(),
            si_rmse: error.norm() / (error.len() as f64).sqrt(),
            measured_rmse_nm: measured.and_then(|motions| motions.rmse(estimate)),
            joint_rmse_nm,
        }
    }
}
