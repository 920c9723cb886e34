//! Measured and predicted torque of an estimate.

use std::path::Path;

use armid::estimation::{Estimate, TorqueResidual, TorqueSeries};
use armid::model::Robot;
use armid::signal::Samples;
use armid_io::log::LogResidual;
use armid_io::recording::TorqueView;
use armid_io::{Error, ProcessedLog};
use armid_reports::{DocumentError, Figure, ResidualShares, TorqueTrace, torque_figure};

use super::page::cannot_be_drawn;
use super::thinning::{extremes, picked};

/// Measured and predicted torque of an estimate, which errors call `name`: on what is held out where anything is, else on the first
/// log of the fit.
#[derive(Clone, Debug)]
pub struct TorqueComparison<'a> {
    /// The rows.
    pub samples: &'a Samples,
    /// Both torques of every row, below the bandwidth.
    pub series: TorqueSeries,
    /// Whether these rows are held out.
    pub is_held_out: bool,
    joints: Vec<String>,
    unit: &'a str,
    bandwidth_hz: f64,
    shares: Vec<ResidualShares>,
}

impl<'a> TorqueComparison<'a> {
    /// The torques of an estimate and of the logs that it was made from.
    ///
    /// # Errors
    /// [`Error`] where the estimate is of another robot or of other parameters.
    pub fn new(estimate: &'a Estimate, name: &str, log: &'a ProcessedLog) -> Result<Self, Error> {
        Self::with_residual(estimate, name, log, &log.residual(estimate, name)?)
    }

    pub(super) fn with_residual(
        estimate: &'a Estimate,
        name: &str,
        log: &'a ProcessedLog,
        LogResidual { used, held_out }: &LogResidual,
    ) -> Result<Self, Error> {
        let is_held_out = !log.held_out.is_empty();
        let parts = if is_held_out { &log.held_out[..1] } else { &log.parts[..1] };
        Ok(Self {
            samples: &parts[0],
            series: log.series(estimate, name, parts)?.remove(0),
            is_held_out,
            joints: log.joint_names(),
            unit: estimate.units.first().map_or("", String::as_str),
            bandwidth_hz: log.settings.bandwidth_hz.min(0.4 * parts[0].rate_hz),
            shares: shares(used, held_out.as_ref()),
        })
    }

    /// The lines of each joint, thinned to what a page can show.
    pub(super) fn traces(&self) -> Vec<TorqueTrace> {
        let n = self.samples.dof();
        let of = |(i, joint): (usize, &String)| {
            let column = |table: &[f64]| -> Vec<f64> { table.iter().skip(i).step_by(n).copied().collect() };
            let (measured, predicted) = (column(&self.series.measured), column(&self.series.predicted));
            let rows = extremes(&measured);
            let times: Vec<f64> = (0..measured.len()).map(|k| k as f64 / self.samples.rate_hz).collect();
            let [times, measured, predicted] = [&times, &measured, &predicted].map(|values| picked(values, &rows));
            TorqueTrace { joint: joint.clone(), times, measured, predicted }
        };
        self.joints.iter().enumerate().map(of).collect()
    }

    /// Writes a motion of the arm with both torques as MCAP, with description and poses of the arm for a viewer.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub fn write_mcap(&self, path: &Path, robot: &Robot) -> Result<(), Error> {
        let (q, rate_hz) = (&self.samples.states.q, self.samples.rate_hz);
        let TorqueSeries { measured, predicted } = &self.series;
        TorqueView { robot, rate_hz, q, measured, predicted }.write(path)
    }

    /// The figure of the page as one SVG element.
    ///
    /// # Errors
    /// [`Error`] where it cannot be drawn.
    pub fn svg(&self) -> Result<String, Error> {
        let missed = self.shares.last();
        let figure = torque_figure(&self.traces(), rows(self.is_held_out), self.unit, self.bandwidth_hz, missed);
        figure.svg().map_err(DocumentError::from).map_err(cannot_be_drawn)
    }
}

/// Which rows are shown.
pub(super) const fn rows(are_held_out: bool) -> &'static str {
    if are_held_out { "held out, not used for the fit" } else { "used for the fit" }
}

/// What is not explained of the rows of the fit, of all, and of those that are held out.
pub(super) fn shares(used: &TorqueResidual, held_out: Option<&TorqueResidual>) -> Vec<ResidualShares> {
    let mut shares = vec![in_percent("rows of the fit", used, true), in_percent("all rows", used, false)];
    shares.extend(held_out.map(|residual| in_percent("held out", residual, false)));
    shares
}

fn in_percent(label: &str, residual: &TorqueResidual, used: bool) -> ResidualShares {
    let rows = if used { &residual.used } else { &residual.all };
    ResidualShares {
        label: label.to_owned(),
        joints: rows.share.iter().map(|share| share.map(|share| 100.0 * share)).collect(),
        total: rows.total.map(|share| 100.0 * share),
    }
}
