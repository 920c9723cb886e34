//! Motions that an arm performed after its identification, and how well an estimate predicts the torque measured there.
//!
//! ```text
//! RMSE   √( ‖τ − W_b β̂‖² / rows )      all used torque rows of all motions
//! ```
//! This is what a laboratory sees: it holds everything that the arm has and the model lacks, and the noise of torque and
//! motion of a second measurement.

use nalgebra::DVector;

use crate::base::BaseReduction;
use crate::estimation::Observation;
use crate::model::Robot;
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;

/// What an arm measured on held-out motions.
#[derive(Clone, Debug)]
pub struct MeasuredMotions(Vec<(Observation, Samples)>);

impl MeasuredMotions {
    /// The equations of each motion, and the samples that they were made from.
    pub fn new(motions: Vec<(Observation, Samples)>) -> Self {
        Self(motions)
    }

    /// Torque prediction RMSE of an estimate β̂ (b), N·m; `None` where no row was used.
    pub fn rmse(&self, beta: &DVector<f64>) -> Option<f64> {
        rmse(self.0.iter().map(|(equations, _)| equations), beta)
    }

    /// The same of an estimate of other columns, whose equations this regressor and base make; `None` also where they cannot be made.
    pub fn rmse_of(
        &self,
        robot: &Robot,
        regressor: &JointTorqueRegressor,
        base: &BaseReduction,
        beta: &DVector<f64>,
    ) -> Option<f64> {
        let equations = self.0.iter().map(|(_, samples)| Observation::new(robot, regressor, base, samples).ok());
        rmse(equations.collect::<Option<Vec<_>>>()?.iter(), beta)
    }
}

fn rmse<'a>(motions: impl Iterator<Item = &'a Observation> + Clone, beta: &DVector<f64>) -> Option<f64> {
    let rows: usize = motions.clone().map(Observation::equations).sum();
    // Rows that are not used are zero on both sides.
    let squares: f64 = motions.map(|motion| motion.residual(beta).norm_squared()).sum();
    (rows > 0).then(|| (squares / rows as f64).sqrt())
}
