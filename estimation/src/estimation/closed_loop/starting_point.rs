//! Where a search on simulated motions begins.

use nalgebra::DVector;

use super::descent::is_rejected;
use super::trial::Trial;
use crate::estimation::error::EstimationError;

/// A point that can be simulated.
pub(super) struct StartingPoint<T> {
    pub(super) beta: DVector<f64>,
    /// What is simulated there.
    pub(super) found: T,
    /// Whether combinations that nothing shows have nominal values there.
    pub(super) is_nominal: bool,
}

/// The first of these that can be simulated: the start that the problem holds, or weighted least squares, and the nominal set.
///
/// # Errors
/// That of the last point, where none can.
pub(super) fn starting_point<T>(
    trial: &Trial<'_>,
    by_torque: &DVector<f64>,
    simulate: impl Fn(&DVector<f64>) -> Result<T, EstimationError>,
) -> Result<StartingPoint<T>, EstimationError> {
    let mut last = EstimationError::NotDefinite;
    for (is_nominal, beta) in [false, true].into_iter().zip(trial.beginnings(by_torque.clone())) {
        match simulate(&beta) {
            Ok(found) => return Ok(StartingPoint { beta, found, is_nominal }),
            Err(error) if is_rejected(&error) => last = error,
            Err(error) => return Err(error),
        }
    }
    Err(last)
}
