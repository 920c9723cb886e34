//! The estimate by a log, and several logs as one.

use armid::estimation::{Estimate, EstimatorKind, Termination};
use armid::model::Columns;
use armid::observer::Observer;
use armid::signal::{NoiseModel, Samples};
use armid_io::{Error, ProcessedLog};

/// The weighted least-squares estimate; `for_difference` of one without the load.
///
/// # Errors
/// [`Error`] where the log does not show the parameters; of [`armid_io::ErrorKind::Interrupted`] where the observer ended the work.
pub(super) fn estimate(
    log: &ProcessedLog,
    columns: Columns,
    for_difference: bool,
    observer: &dyn Observer,
) -> Result<Estimate, Error> {
    let estimators = [EstimatorKind::Wls.estimator()];
    let made = if for_difference {
        // What the arm and the arm with its load have in common is in neither.
        log.identify_for_difference(columns, &estimators, observer)?
    } else {
        log.identify_watched(columns, &estimators, observer)?
    };
    let ended = |of: &Estimate| matches!(of.termination, Termination::Interrupted { .. });
    made.into_iter().next().filter(|of| !ended(of)).ok_or_else(|| Error::interrupted(&log.name()))
}

/// Whether logs can be joined.
pub(super) fn are_alike(log: &ProcessedLog, other: &ProcessedLog) -> bool {
    let (samples, of_other) = (&log.samples, &other.samples);
    samples.block == of_other.block && samples.rate_hz.to_bits() == of_other.rate_hz.to_bits()
}

/// Logs that are sampled alike as one without periods.
///
/// # Errors
/// [`Error`] where they are of unlike robots.
pub(super) fn join(alike: Vec<ProcessedLog>) -> Result<ProcessedLog, Error> {
    let parts: Vec<&Samples> = alike.iter().map(|log| &log.samples).collect();
    // Scatter over the periods of each; without it the residual says what noise is.
    let noise = parts.iter().filter(|of| !of.is_noise_free()).filter_map(|of| Some((of.noise.as_ref()?, of.blocks())));
    let noise = Some(noise.collect::<Vec<_>>()).filter(|each| each.len() == parts.len());
    let noise = noise.and_then(|each| NoiseModel::mean(&each));
    let periods = parts.iter().map(|of| of.periods).min().unwrap_or(1);
    let mut all = ProcessedLog::join(alike)?;
    (all.samples.noise, all.samples.torque_covariance, all.samples.periods) = (noise, None, periods);
    Ok(all)
}
