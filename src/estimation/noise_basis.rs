//! Which noise an estimator believes.

use nalgebra::DVector;

use super::Observation;
use super::residual::residual_noise;
use crate::linalg::BlockWhitening;
use crate::signal::NoiseModel;

/// The noise that scattered over periods; `None` where nothing was repeated or some joint did not scatter at all.
pub(super) fn scatter_noise(observation: &Observation) -> Option<NoiseModel> {
    observation.noise.clone().filter(|noise| BlockWhitening::new(noise.covariance()).is_ok())
}

/// The noise that the residual of `beta` shows.
pub(super) fn noise_of_fit(observation: &Observation, beta: &DVector<f64>) -> NoiseModel {
    residual_noise(observation, &observation.residual(beta))
}
