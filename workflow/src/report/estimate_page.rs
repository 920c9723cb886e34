//! The page of an estimate: torque measured and predicted, residuals, parameters, and a verdict with its reason.

use std::path::{Path, PathBuf};

use armid::estimation::{Against, Estimate, ResidualTrends, TorqueResidual, TorqueSeries};
use armid::model::Robot;
use armid::observer::{Observer, Work};
use armid::signal::Samples;
use armid_io::log::LogResidual;
use armid_io::recording::TorqueView;
use armid_io::{Error, Inputs, ProcessedLog};
use armid_reports::{
    DocumentError, EstimateInput, Figure, ParameterRow, ResidualDiagnostics, ResidualShares, ResidualTrace, Sheet,
    TorqueTrace, estimate_document, torque_figure,
};

use super::page::{cannot_be_drawn, write_document};
use crate::counter::Counter;
use crate::identification::grouped;
use crate::numbers::percent;

/// Points of a line on the page, at most.
const POINTS: usize = 1500;

/// Share of the torque that a model may leave unexplained to be called good on rows that it has not seen.
const GOOD: f64 = 0.1;

/// Draws the page of an estimate, which errors call `name`, from the logs that it was made from; returns the page.
///
/// # Errors
/// [`Error`] where the estimate is of another robot or of other parameters, or the page cannot be written; of
/// [`armid_io::ErrorKind::Interrupted`] where the observer ended the work, before anything is written.
pub fn write_estimate_report(
    folder: &Path,
    estimate: &Estimate,
    name: &str,
    log: &ProcessedLog,
    inputs: &Inputs,
    sheet: Sheet,
    observer: &dyn Observer,
) -> Result<PathBuf, Error> {
    let page = Page { estimate, prepared: log, name };
    let steps = Counter::new(observer, Work::Steps, 4);
    let input = page.input(inputs, &steps)?;
    steps.begin(name)?;
    write_document(folder, estimate_document(&input), sheet)
}

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

    fn with_residual(
        estimate: &'a Estimate,
        name: &str,
        log: &'a ProcessedLog,
        LogResidual { used, held_out }: &LogResidual,
    ) -> Result<Self, Error> {
        let mut shares = vec![in_percent("rows of the fit", used, true), in_percent("all rows", used, false)];
        shares.extend(held_out.as_ref().map(|residual| in_percent("held out", residual, false)));
        let is_held_out = !log.held_out.is_empty();
        let parts = if is_held_out { &log.held_out[..1] } else { &log.parts[..1] };
        Ok(Self {
            samples: &parts[0],
            series: log.series(estimate, name, parts)?.remove(0),
            is_held_out,
            joints: log.joint_names(),
            unit: estimate.units.first().map_or("", String::as_str),
            bandwidth_hz: log.settings.bandwidth_hz.min(0.4 * parts[0].rate_hz),
            shares,
        })
    }

    fn traces(&self) -> Vec<TorqueTrace> {
        let joints = self.joints.iter().enumerate();
        joints.map(|(i, joint)| trace(joint, i, self.samples, &self.series)).collect()
    }

    /// Which rows these are.
    const fn rows(&self) -> &'static str {
        if self.is_held_out { "held out, not used for the fit" } else { "used for the fit" }
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
        let figure = torque_figure(&self.traces(), self.rows(), self.unit, self.bandwidth_hz, missed);
        figure.svg().map_err(DocumentError::from).map_err(cannot_be_drawn)
    }
}

struct Page<'a> {
    estimate: &'a Estimate,
    prepared: &'a ProcessedLog,
    name: &'a str,
}

impl Page<'_> {
    fn input(&self, inputs: &Inputs, steps: &Counter<'_>) -> Result<EstimateInput, Error> {
        steps.begin(self.name)?;
        let residual = self.prepared.residual(self.estimate, self.name)?;
        let expressions = self.prepared.expressions(self.estimate, self.name)?;
        let joints = self.prepared.joint_names();
        steps.begin(self.name)?;
        let torque = TorqueComparison::with_residual(self.estimate, self.name, self.prepared, &residual)?;
        let parameters = self.estimate.base.iter().zip(expressions).map(|(parameter, expression)| ParameterRow {
            name: parameter.name.clone(),
            expression,
            value: parameter.value,
            std: parameter.std,
            interval: parameter.ci95,
            unit: parameter.unit.clone(),
        });
        let mut provenance = vec![("robot file, SHA-256".to_owned(), inputs.robot.sha256.clone())];
        provenance.extend(inputs.files.iter().map(|file| (file.path.clone(), file.sha256.clone())));
        provenance.extend(inputs.mapping.clone().map(|mapping| ("mapping".to_owned(), mapping)));
        steps.begin(self.name)?;
        let trends = self.prepared.residual_trends(self.estimate, self.name)?;
        let diagnostics = diagnostics(&trends, &joints);
        Ok(EstimateInput {
            robot: self.estimate.robot.clone(),
            subtitle: format!(
                "{} base parameters ({}) by {} from {}",
                self.estimate.base.len(),
                self.estimate.columns,
                self.estimate.estimator,
                self.prepared.name()
            ),
            verdict: self.verdict(&residual),
            joints,
            unit: torque.unit.to_owned(),
            bandwidth_hz: residual.used.bandwidth_hz,
            shares: torque.shares.clone(),
            traces: torque.traces(),
            traces_of: torque.rows().to_owned(),
            diagnostics,
            parameters: parameters.collect(),
            left_out: self.prepared.reports.iter().flat_map(|report| report.origin.sentences()).collect(),
            findings: grouped(&self.estimate.findings)
                .into_iter()
                .flat_map(|(sentences, advice)| {
                    sentences.into_iter().map(move |sentence| format!("{sentence} → {advice}"))
                })
                .collect(),
            provenance,
        })
    }

    /// The verdict with its reason.
    fn verdict(&self, LogResidual { used, held_out }: &LogResidual) -> Vec<String> {
        let bandwidth = used.bandwidth_hz;
        let poor = self.estimate.base.iter().filter(|p| 3.0 * p.std > p.value.abs()).count();
        let first = match held_out.as_ref().and_then(|residual| residual.all.total) {
            Some(total) if total <= GOOD => format!(
                "The model **predicts** held-out torque: {} of it is left unexplained below {bandwidth} Hz, {} on \
                 the rows of the fit.",
                percent(Some(total)),
                percent(used.all.total)
            ),
            Some(total) => format!(
                "The model does **not predict** held-out torque well: {} of it is left unexplained below \
                 {bandwidth} Hz, more than {:.0} %; {} on the rows of the fit.",
                percent(Some(total)),
                100.0 * GOOD,
                percent(used.all.total)
            ),
            None => format!(
                "Nothing was held out, so **its prediction is not validated**; {} of the torque of the fit is left \
                 unexplained below {bandwidth} Hz.",
                percent(used.all.total)
            ),
        };
        let second = format!(
            "{poor} of {} parameters have a standard deviation of more than a third of their value; the condition number with \
             columns of unit length is {:.0}.",
            self.estimate.base.len(),
            self.estimate.condition_scaled
        );
        vec![first, second]
    }
}

fn in_percent(label: &str, residual: &TorqueResidual, used: bool) -> ResidualShares {
    let rows = if used { &residual.used } else { &residual.all };
    ResidualShares {
        label: label.to_owned(),
        joints: rows.share.iter().map(|share| share.map(|share| 100.0 * share)).collect(),
        total: rows.total.map(|share| 100.0 * share),
    }
}

/// The lines of a joint, thinned to what a page can show.
fn trace(joint: &str, i: usize, samples: &Samples, series: &TorqueSeries) -> TorqueTrace {
    let n = samples.dof();
    let step = samples.len().div_ceil(POINTS).max(1);
    let rows: Vec<usize> = (0..samples.len()).step_by(step).collect();
    let pick = |table: &[f64]| -> Vec<f64> { rows.iter().map(|&k| table[k * n + i]).collect() };
    let (measured, predicted) = (pick(&series.measured), pick(&series.predicted));
    TorqueTrace {
        joint: joint.to_owned(),
        times: rows.iter().map(|&k| k as f64 / samples.rate_hz).collect(),
        measured,
        predicted,
    }
}

/// What the residual shows, thinned to what a page can show.
fn diagnostics(trends: &ResidualTrends, joints: &[String]) -> ResidualDiagnostics {
    let traces =
        trends.traces.iter().zip(&trends.whiteness).zip(joints).filter(|((trace, _), _)| !trace.times.is_empty());
    let traces = traces.map(|((trace, white), joint)| {
        let step = trace.times.len().div_ceil(POINTS).max(1);
        let pick = |values: &[f64]| -> Vec<f64> { values.iter().step_by(step).copied().collect() };
        let autocorrelation = white.as_ref().map(|white| white.autocorrelation.clone()).unwrap_or_default();
        let step_s = white.as_ref().map_or(0.0, |white| white.step_s);
        ResidualTrace {
            joint: joint.clone(),
            times: pick(&trace.times),
            residual: pick(&trace.residual),
            velocity: pick(&trace.velocity),
            load: pick(&trace.load),
            position: pick(&trace.position),
            lags: (1..=autocorrelation.len()).map(|lag| lag as f64 * step_s).collect(),
            autocorrelation,
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
