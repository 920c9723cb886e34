//! Where a search on simulated motions begins.

use nalgebra::DVector;

use super::descent::{Linearise, Linearised, Rest, is_rejected};
use super::shooting::{Output, shoot};
use super::trial::Trial;
use crate::estimation::error::EstimationError;
use crate::estimation::finding::Finding;
use crate::estimation::termination::Termination;

/// A point that can be simulated.
pub(super) struct StartingPoint<T> {
    pub(super) beta: DVector<f64>,
    /// What is simulated there.
    pub(super) found: T,
    /// Whether combinations that nothing shows have nominal values there.
    pub(super) is_nominal: bool,
    /// What is to be said of how it was found.
    pub(super) finding: Option<Finding>,
}

/// Where a search ended.
pub(super) struct Descended<W> {
    pub(super) rest: Rest,
    /// What else is known there.
    pub(super) beside: W,
    /// As in [`StartingPoint`].
    pub(super) is_nominal: bool,
    pub(super) finding: Option<Finding>,
}

/// The first of these that can be simulated: the start that the problem holds, or weighted least squares; what multiple shooting by `output` makes of it, the nominal
/// set, and what it makes of that. No multiple shooting without `output`.
///
/// # Errors
/// That of the last point, where none can.
pub(super) fn starting_point<T>(
    trial: &Trial<'_>,
    by_torque: &DVector<f64>,
    output: Option<Output>,
    simulate: impl Fn(&DVector<f64>) -> Result<T, EstimationError>,
) -> Result<StartingPoint<T>, EstimationError> {
    let mut last = EstimationError::NotDefinite;
    for (is_nominal, from) in [false, true].into_iter().zip(trial.beginnings(by_torque.clone())) {
        let mut at = |beta: &DVector<f64>, finding: Option<Finding>| match simulate(beta) {
            Ok(found) => Ok(Some(StartingPoint { beta: beta.clone(), found, is_nominal, finding })),
            Err(error) if is_rejected(&error) => {
                last = error;
                Ok(None)
            }
            Err(error) => Err(error),
        };
        if let Some(start) = at(&from, None)? {
            return Ok(start);
        }
        if let Some(output) = output
            && let Some((beta, finding)) = shoot(trial, &from, output)?
            && let Some(start) = at(&beta, Some(finding))?
        {
            return Ok(start);
        }
    }
    Err(last)
}

/// Follows steps from a starting point; where they end because the motion of every further one runs away, from what multiple shooting makes of weighted least squares
/// too, if they do from there. `follow` gives the rest and what else is known there.
pub(super) fn descend<W>(
    trial: &Trial<'_>,
    by_torque: &DVector<f64>,
    output: Option<Output>,
    linearise: &Linearise<'_>,
    follow: impl Fn((DVector<f64>, Linearised)) -> Result<(Rest, W), EstimationError>,
) -> Result<Descended<W>, EstimationError> {
    let StartingPoint { beta, found, is_nominal, finding } = starting_point(trial, by_torque, output, linearise)?;
    let (rest, beside) = follow((beta, found))?;
    let mut first = Descended { rest, beside, is_nominal, finding };
    let Some(output) = output else { return Ok(first) };
    let Termination::Unsimulable { iterations } = first.rest.termination else { return Ok(first) };
    if first.finding.is_some() {
        return Ok(first);
    }
    let [from, _] = trial.beginnings(by_torque.clone());
    let again = shoot(trial, &from, output).and_then(|found| {
        let linearised = |(beta, finding)| linearise(&beta).map(|at| (beta, at, finding));
        found.map(linearised).transpose()
    });
    let (beta, linearised, finding) = match again {
        Ok(Some(again)) => again,
        Ok(None) => return Ok(first),
        Err(error) if is_rejected(&error) => return Ok(first),
        Err(EstimationError::Interrupted) => {
            first.rest.termination = Termination::Interrupted { iterations };
            return Ok(first);
        }
        Err(error) => return Err(error),
    };
    let (rest, beside) = follow((beta, linearised))?;
    let second = Descended { rest, beside, is_nominal: false, finding: Some(finding) };
    Ok(if second.rest.termination.was_successful() { second } else { first })
}
