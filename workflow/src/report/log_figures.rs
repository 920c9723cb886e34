//! What the page of an estimate shows of its logs.

use armid::estimation::{Against, Estimate, ResidualTrends};
use armid_io::log::LogResidual;
use armid_io::{Error, ProcessedLog};
use armid_reports::{ResidualDiagnostics, ResidualTrace, TorqueTrace};
use serde::{Deserialize, Serialize};

use super::thinning::{every, picked, rounded};
use super::torque_comparison::TorqueComparison;

/// What the page of an estimate shows of its logs, thinned to what a page can show. The estimate's file holds it, so that the page needs
/// no log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogFigures {
    /// What the logs are called.
    pub(super) log: String,
    /// What was left out of them, and what was found in them, a sentence each.
    pub(super) left_out: Vec<String>,
    /// Whether the torque is of rows that are held out.
    pub(super) is_held_out: bool,
    /// Torque over time, joint by joint.
    pub(super) torque: Vec<TorqueTrace>,
    /// What the residual of the fit shows.
    pub(super) residual: ResidualDiagnostics,
}

impl LogFigures {
    /// The figures of an estimate, which errors call `name`, of the logs that it was made from, of what it leaves of them, and of what that
    /// shows.
    ///
    /// # Errors
    /// [`Error`] where the estimate is of another robot or of other parameters.
    pub(crate) fn new(
        estimate: &Estimate,
        name: &str,
        log: &ProcessedLog,
        residual: &LogResidual,
        trends: &ResidualTrends,
    ) -> Result<Self, Error> {
        let torque = TorqueComparison::with_residual(estimate, name, log, residual)?;
        Ok(Self {
            log: log.name(),
            left_out: log.reports.iter().flat_map(|report| report.origin.sentences()).collect(),
            is_held_out: torque.is_held_out,
            torque: torque.traces(),
            residual: diagnostics(trends, &log.joint_names()),
        })
    }
}

/// What the residual shows, thinned to what a page can show.
fn diagnostics(trends: &ResidualTrends, joints: &[String]) -> ResidualDiagnostics {
    let traces =
        trends.traces.iter().zip(&trends.whiteness).zip(joints).filter(|((trace, _), _)| !trace.times.is_empty());
    let traces = traces.map(|((trace, white), joint)| {
        let rows = every(trace.times.len());
        let pick = |values: &[f64]| picked(values, &rows);
        let autocorrelation = white.as_ref().map(|white| white.autocorrelation.clone()).unwrap_or_default();
        let step_s = white.as_ref().map_or(0.0, |white| white.step_s);
        ResidualTrace {
            joint: joint.clone(),
            times: pick(&trace.times),
            residual: pick(&trace.residual),
            velocity: pick(&trace.velocity),
            load: pick(&trace.load),
            position: pick(&trace.position),
            lags: (1..=autocorrelation.len()).map(|lag| rounded(lag as f64 * step_s)).collect(),
            autocorrelation: autocorrelation.into_iter().map(rounded).collect(),
            white_within: white.as_ref().map_or(0.0, |white| white.limit),
        }
    });
    ResidualDiagnostics {
        traces: traces.collect(),
        over_time: trends.sentences(Against::Time, joints),
        over_speed: trends.sentences(Against::Speed, joints),
        over_load: trends.sentences(Against::Load, joints),
        over_position: trends.sentences(Against::Position, joints),
        whiteness: trends.whiteness_sentences(joints),
    }
}
