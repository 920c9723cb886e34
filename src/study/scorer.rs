//! Scores an estimate against the truth: the only place, besides the simulator, where the truth is read.
//!
//! ```text
//! prediction RMSE  √( Σ_j eᵀ G_j e / (n N) )   e = β̂ − β,  G_j = Σ_k y_j(k)ᵀ y_j(k),  y_j row j of Y_b,
//!                                              n joints, N validation samples of one kind of motion
//! reference RMSE   √( Σ_i (e_i / u_i)² / b ) u_i the declared unit of parameter i
//! SI RMSE          √( Σ_i e_i² / b )         kg, kg·m, kg·m², N·m, N·m·s added as numbers: what a condition number bounds
//! ```
//! Nothing is divided by a true value, which may be zero. The [validation motions](super::ValidationMotions) were not used
//! for fitting; the prediction error is the error of the model alone, without the noise of a second measurement.

use nalgebra::{DMatrix, DVector};

use super::measured_motion::MeasuredMotions;
use super::motion_kind::MotionKind;
use super::truth::Truth;
use super::validation::ValidationMotions;
use crate::base::BaseReduction;
use crate::dynamics::States;
use crate::model::{ReferenceUnits, Robot};
use crate::regressor::JointTorqueRegressor;

/// Scores estimates against the truth, which it holds.
#[derive(Clone, Debug)]
pub struct Scorer {
    /// The true base parameters β of each truth, length b; the robot's own first.
    pub truths: Vec<DVector<f64>>,
    /// The declared unit of each base parameter, length b.
    pub units: DVector<f64>,
    ratings: Vec<f64>,
    random: PredictedTorque,
    slow: PredictedTorque,
    moves: PredictedTorque,
    /// `None` where no parameter moves torque at rest.
    poses: Option<PredictedTorque>,
}

/// How an error of the parameters moves torque on the motions of one kind.
#[derive(Clone, Debug)]
struct PredictedTorque {
    /// G of each joint, b × b.
    grams: Vec<DMatrix<f64>>,
    samples: usize,
}

/// Part of the mean square of the regressor on random motions below which that at rest is rounding.
const NOTHING: f64 = 1e-24;

/// The errors of one estimate against the truth.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Score {
    /// Torque prediction RMSE over all joints and samples of the random motions, N·m.
    pub prediction_rmse_nm: f64,
    /// RMS error of the predicted torque with every joint's torque divided by its rating, so that the wrist counts as much as the shoulder.
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
    /// Torque prediction RMSE on the random motions at 30 % of their speed, N·m.
    pub slow_rmse_nm: f64,
    /// Torque prediction RMSE on moves from point to point, N·m.
    pub point_to_point_rmse_nm: f64,
    /// Torque prediction RMSE on poses at rest, where gravity alone is predicted, N·m; `None` where no parameter moves
    /// torque at rest.
    pub static_rmse_nm: Option<f64>,
}

impl Scorer {
    /// A scorer for the base parameters `base` of `robot`, predicting on `validation`.
    pub fn new(
        robot: &Robot,
        truths: &[Truth],
        regressor: &JointTorqueRegressor,
        base: &BaseReduction,
        validation: &ValidationMotions,
        units: &ReferenceUnits,
    ) -> Self {
        let b = base.rank();
        let on = |kind| PredictedTorque::new(&validation.states(kind), robot.dof(), regressor, base);
        let (random, poses) = (on(MotionKind::Random), on(MotionKind::Static));
        let moves_torque = poses.mean_square() > NOTHING * random.mean_square();
        Self {
            truths: truths.iter().map(|truth| base.beta(&truth.vector(robot, regressor.columns()))).collect(),
            units: DVector::from_iterator(b, base.kept.iter().map(|&c| units.unit(base.parameters[c].kind))),
            ratings: robot.joints().iter().map(|joint| joint.limits.torque).collect(),
            random,
            slow: on(MotionKind::Slow),
            moves: on(MotionKind::PointToPoint),
            poses: moves_torque.then_some(poses),
        }
    }

    /// The score of an estimate β̂ (b) of the arm with one of the truths, and of what that arm measured afterwards.
    pub fn score(&self, estimate: &DVector<f64>, truth: usize, measured: Option<&MeasuredMotions>) -> Score {
        let error = estimate - &self.truths[truth];
        let joint_rmse_nm = self.random.rmse(&error);
        let over_all = |kind: &PredictedTorque| pooled(&kind.rmse(&error), |_| 1.0);
        Score {
            prediction_rmse_nm: pooled(&joint_rmse_nm, |_| 1.0),
            prediction_rmse_of_rating: pooled(&joint_rmse_nm, |j| 1.0 / self.ratings[j]),
            reference_rmse: error.component_div(&self.units).norm() / (error.len() as f64).sqrt(),
            si_rmse: error.norm() / (error.len() as f64).sqrt(),
            measured_rmse_nm: measured.and_then(|motions| motions.rmse(estimate)),
            slow_rmse_nm: over_all(&self.slow),
            point_to_point_rmse_nm: over_all(&self.moves),
            static_rmse_nm: self.poses.as_ref().map(over_all),
            joint_rmse_nm,
        }
    }
}

impl PredictedTorque {
    fn new(motions: &[States], n: usize, regressor: &JointTorqueRegressor, base: &BaseReduction) -> Self {
        let b = base.rank();
        let mut grams = vec![DMatrix::zeros(b, b); n];
        let mut samples = 0;
        for states in motions {
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
        Self { grams, samples }
    }

    /// RMSE of each joint by an error of the parameters (b), n, N·m.
    fn rmse(&self, error: &DVector<f64>) -> Vec<f64> {
        let of = |gram: &DMatrix<f64>| (error.dot(&(gram * error)).max(0.0) / self.samples as f64).sqrt();
        self.grams.iter().map(of).collect()
    }

    /// Mean square of the regressor, row by row.
    fn mean_square(&self) -> f64 {
        self.grams.iter().map(DMatrix::trace).sum::<f64>() / self.samples as f64
    }
}

/// RMSE over all joints, each with its weight.
fn pooled(joints: &[f64], weight: impl Fn(usize) -> f64) -> f64 {
    let squares: f64 = joints.iter().enumerate().map(|(j, rmse)| (rmse * weight(j)).powi(2)).sum();
    (squares / joints.len() as f64).sqrt()
}
