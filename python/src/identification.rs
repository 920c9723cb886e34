//! From logs to estimates.

use armid::estimation::{Estimator, EstimatorKind, candidate_terms};
use armid::model::Columns;
use armid::model::format::parse_parameter_map;
use armid::signal::{Derivatives, Processing, TorqueFilter};
use armid_io::log::{HeldOut, process_all};
use armid_io::output::pretty;
use armid_io::{Error, Inputs, LogSettings, ProcessedLog, Text};
use armid_workflow::identification::{IdentifySettings, identify as identified};
use pyo3::prelude::*;
use serde_json::Value;

use crate::callable::Method;
use crate::estimator::PythonEstimator;
use crate::fault::{exception, unexpected};
use crate::log::{Log, effort};
use crate::robot::Robot;
use crate::watch::{Leaves, watched};

/// How logs become samples: a mapping with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    period_s: Option<f64>,
    finds_period: bool,
    from_s: Option<f64>,
    until_s: Option<f64>,
    /// Share of a log that is held out; what is usual where it is not said.
    held_out: Option<f64>,
    measured_velocity: bool,
    effort: Option<String>,
    bandwidth_hz: Option<f64>,
    derivatives: Option<String>,
    cutoff_hz: Option<f64>,
    reversal_fraction: Option<f64>,
    samples_per_period: Option<usize>,
    torque_filter: Option<String>,
}

impl Reading {
    /// The settings for these logs, whose own tables decide what is not said.
    fn settings(&self, logs: &[Log]) -> PyResult<LogSettings> {
        let usual = LogSettings::default();
        let bandwidth_hz = self.bandwidth_hz.unwrap_or(usual.bandwidth_hz);
        if !(bandwidth_hz.is_finite() && bandwidth_hz > 0.0) {
            return Err(unexpected(format!("bandwidth_hz is {bandwidth_hz}, expected a number above zero")));
        }
        let held_out = match self.held_out {
            None => HeldOut::LastFifth,
            Some(0.0) => HeldOut::Nothing,
            Some(share) if (0.0..=0.9).contains(&share) => HeldOut::Share(share),
            Some(share) => return Err(unexpected(format!("held_out is {share}, expected a share from 0 to 0.9"))),
        };
        let derivatives = self.derivatives.as_deref().map(|name| {
            let names = Derivatives::ALL.map(Derivatives::name).join(" or ");
            Derivatives::parse(name).ok_or_else(|| unexpected(format!("derivatives is \"{name}\", expected {names}")))
        });
        let filter = self.torque_filter.as_deref().map(|name| {
            let names = TorqueFilter::ALL.map(TorqueFilter::name).join(" or ");
            TorqueFilter::parse(name)
                .ok_or_else(|| unexpected(format!("torque_filter is \"{name}\", expected {names}")))
        });
        let of_logs = || logs.iter().find_map(|log| log.period_s);
        let period_s = self.period_s.or_else(|| of_logs().filter(|_| self.finds_period));
        let is_foreign = logs.iter().any(|log| log.log.recording.is_none());
        if self.samples_per_period.is_some() && is_foreign && period_s.is_none() && !self.finds_period {
            return Err(unexpected("samples is of an averaged period, found a log without a period"));
        }
        let part = |of: fn(&Log) -> Option<f64>| logs.iter().find_map(of);
        let processing = usual.processing.clone();
        Ok(LogSettings {
            period_s,
            finds_period: self.finds_period,
            from_s: self.from_s.or_else(|| part(|log| log.part_s.0)).unwrap_or(0.0),
            until_s: self.until_s.or_else(|| part(|log| log.part_s.1)),
            held_out,
            measured_velocity: self.measured_velocity,
            effort: self.effort.as_deref().map(effort).transpose()?,
            bandwidth_hz,
            processing: Processing {
                derivatives: derivatives.transpose()?.unwrap_or(processing.derivatives),
                cutoff_hz: self.cutoff_hz.or(processing.cutoff_hz),
                reversal_fraction: self.reversal_fraction.unwrap_or(processing.reversal_fraction),
                samples_per_period: self.samples_per_period.unwrap_or(processing.samples_per_period),
                torque_filter: filter.transpose()?.unwrap_or(processing.torque_filter),
                ..processing
            },
        })
    }
}

/// Logs of a robot as samples, and what they were made from.
pub(crate) fn processed(robot: &Robot, logs: &[Log], settings: &LogSettings) -> Result<(ProcessedLog, Inputs), Error> {
    let all = || logs.iter().map(|log| &log.log);
    let inputs = Inputs {
        robot: robot.source.clone(),
        logs: logs.iter().flat_map(|log| log.paths.clone()).collect(),
        held_out_log: None,
        files: all().flat_map(|log| log.origin.files.clone()).collect(),
        mapping: all().find_map(|log| log.origin.mapping.clone()),
        rate_hz: logs.iter().find_map(|log| log.rate_hz),
        settings: settings.clone(),
    };
    Ok((samples(robot, all().cloned().collect(), settings)?, inputs))
}

/// Logs of a robot as samples.
pub(crate) fn samples(robot: &Robot, logs: Vec<armid_io::Log>, settings: &LogSettings) -> Result<ProcessedLog, Error> {
    let mut processed = process_all(logs, &robot.loaded, settings)?;
    processed.closed_loops = Some(armid_sim::closed_loop);
    Ok(processed)
}

/// The columns that terms are selected from.
fn candidates(text: &str) -> PyResult<Columns> {
    if text == "all" {
        return Ok(candidate_terms().into_iter().fold(Columns::RIGID, Columns::with_term));
    }
    match Columns::parse_among(text, &candidate_terms()) {
        Some(columns) => Ok(columns),
        None => Columns::parse_estimable(text).map_err(unexpected),
    }
}

/// What is estimated, and by what: a mapping with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Wanted {
    columns: String,
    estimators: Vec<Method>,
    select: Option<String>,
    onset_speed: Option<bool>,
    stribeck_speed: bool,
    /// Parameters by their names, as JSON.
    initial: Option<String>,
}

/// An estimate as the command's file holds it, and how its search ended where it did not end as it should.
type Estimated = (String, Option<String>);

/// One estimate for each estimator.
#[pyfunction]
pub(crate) fn identify(
    py: Python<'_>,
    robot: &Robot,
    logs: Vec<PyRef<'_, Log>>,
    others: Vec<PyRef<'_, Log>>,
    reading: Reading,
    wanted: Wanted,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Estimated>> {
    let cloned = |logs: Vec<PyRef<'_, Log>>| logs.iter().map(|log| Log::clone(log)).collect::<Vec<_>>();
    let (robot, logs, others) = (robot.clone(), cloned(logs), cloned(others));
    let settings = reading.settings(&logs)?;
    let settings = if wanted.select.is_some() { settings.for_selection() } else { settings };
    let (mut estimators, mut own) = (Vec::new(), Vec::new());
    for asked in wanted.estimators {
        match asked {
            Method::Listed(name) => {
                let names = || EstimatorKind::ALL.iter().map(Estimator::name).collect::<Vec<_>>().join(", ");
                let kind = EstimatorKind::parse(&name);
                estimators.push(kind.ok_or_else(|| {
                    unexpected(format!("estimator is \"{name}\", expected a callable, or one of {}", names()))
                })?);
            }
            Method::Own(name, function) => own.push(PythonEstimator::new(name, function)),
        }
    }
    let settings_of = IdentifySettings {
        columns: robot.columns(&wanted.columns)?,
        estimators,
        others: own.iter().map(PythonEstimator::shared).collect(),
        select: wanted.select.as_deref().map(candidates).transpose()?,
        onset_speed: wanted.onset_speed,
        stribeck_speed: wanted.stribeck_speed,
    };
    let start = wanted.initial.map(|text| Text::new("initial", text));
    let answer = watched(py, progress, Leaves::Nothing, move |observer| {
        let (mut log, mut inputs) = processed(&robot, &logs, &settings)?;
        if !others.is_empty() {
            let whole = LogSettings { held_out: HeldOut::Nothing, ..settings };
            let (held_out, of) = processed(&robot, &others, &whole)?;
            inputs.held_out_log = of.logs.first().cloned();
            log.hold_out(&held_out);
        }
        if let Some(text) = start {
            let start = parse_parameter_map(&text.content, &robot.loaded.robot);
            log.start = Some(start.map_err(|fault| Error::of_format(&text, &fault))?.0);
        }
        let answer = identified(log, Some(inputs), &settings_of, observer)?;
        let unfinished = answer.estimates.iter().map(|one| {
            let termination = &one.estimate.termination;
            (!termination.was_successful()).then(|| termination.to_string())
        });
        let unfinished: Vec<_> = unfinished.collect();
        Ok((serde_json::to_value(&answer).map_err(Error::new)?, unfinished))
    })?;
    // What a callable raised says more than where it was called.
    let (answer, unfinished) =
        answer.map_err(|fault| own.iter().find_map(PythonEstimator::raised).unwrap_or_else(|| exception(fault)))?;
    let texts = match answer {
        Value::Array(several) => several.iter().map(pretty).collect(),
        one => vec![pretty(&one)],
    };
    Ok(texts.into_iter().zip(unfinished).collect())
}
