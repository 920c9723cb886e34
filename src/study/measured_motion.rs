//! Motions that an arm performed after its identification, and how well an estimate predicts the torque measured there.
//!
//! ```text
//! RMSE   √( ‖τ − W_b β̂‖² / rows )      all used torque rows of all motions
//! ```
//! This is what a laboratory sees: it holds everything that the arm has and the model lacks, and the noise of torque and
//! motion of a second measurement.

use nalgebra::DVector;

use crate::estimation::Observation;

/// What an arm measured on held-out motions.
#[derive(Clone, Debug)]
pub struct MeasuredMotions(Vec<Observation>);

impl MeasuredMotions {
    /// The equations of each motion.
    #[must_use]
    pub fn new(motions: Vec<Observation>) -> Self {
        Self(motions)
    }

    /// Torque prediction RMSE of an estimate β̂ (b), N·m; `None` where no row was used.
    pub fn rmse(&self, beta: &DVector<f64>) -> Option<f64> {
        let rows: usize = self.0.iter().map(Observation::equations).sum();
        // Rows that are not used are zero on both sides.
        let squares: f64 = self.0.iter().map(|motion| motion.residual(beta).norm_squared()).sum();
        (rows > 0).then(|| (squares / rows as f64).sqrt())
    }
}
