//! How well does an estimate predict the torque of another log?

use armid::estimation::{Estimate, Model, TorqueResidual, Validation};
use armid::observer::{Observer, Work};
use armid_io::log::LogReport;
use armid_io::{Error, Inputs, LoadedRobot, ProcessedLog};
use serde::{Serialize, Serializer};

use crate::counter::Counter;

/// What an estimate or a model predicts of a log. It serialises to the keys of the command's answer.
#[derive(Clone, Debug, Serialize)]
pub struct ValidationVerdict {
    /// The estimator, or the file of a model.
    #[serde(rename = "estimator")]
    pub by: String,
    /// Name of the robot.
    pub robot: String,
    /// What the logs are called.
    pub recording: String,
    /// Difference of predicted and measured torque.
    #[serde(flatten)]
    pub validation: Validation,
    /// Largest difference that passes, as a share of the measured RMS.
    pub limit: f64,
    /// Torque that is not explained, below the bandwidth.
    pub residual: TorqueResidual,
    /// What was found in the logs.
    pub logs: Vec<LogReport>,
    /// What else is to be known of them.
    pub remarks: Vec<String>,
    /// The log of the fit, where it is among the logs: no validation, whatever the error.
    pub log_of_fit: Option<String>,
    /// `passed` or `failed`; `not a validation` where the error is within the limit on the log of the fit.
    pub verdict: &'static str,
}

/// The verdicts on one log: one object for one estimate, a list for several.
#[derive(Clone, Debug)]
pub struct ValidationAnswer {
    /// One for each estimate.
    pub verdicts: Vec<ValidationVerdict>,
}

impl ValidationVerdict {
    fn new(by: &str, log: &ProcessedLog, (validation, residual): (Validation, TorqueResidual), limit: f64) -> Self {
        Self {
            by: by.to_owned(),
            robot: log.robot.robot.name().to_owned(),
            recording: log.name(),
            verdict: if validation.is_within(limit) { "passed" } else { "failed" },
            validation,
            limit,
            residual,
            logs: log.reports.clone(),
            remarks: Vec::new(),
            log_of_fit: None,
        }
    }

    /// Returns this verdict as that on a log of the fit, which cannot pass.
    fn on_log_of_fit(mut self, log: Option<&str>) -> Self {
        let Some(log) = log else { return self };
        if self.verdict == "passed" {
            self.verdict = "not a validation";
        }
        self.remarks.push(format!(
            "{log} is the log of the fit (the same SHA-256): validate another log, or a part that the fit did not use"
        ));
        self.log_of_fit = Some(log.to_owned());
        self
    }
}

impl ValidationAnswer {
    /// Do all predict the log within the limit?
    pub fn passed(&self) -> bool {
        self.verdicts.iter().all(|one| one.validation.is_within(one.limit))
    }
}

impl Serialize for ValidationAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.verdicts.as_slice() {
            [one] => one.serialize(serializer),
            several => several.serialize(serializer),
        }
    }
}

/// Compares what estimates, which errors call `name`, predict with a log. Where `inputs` say what the estimates and the log were made from,
/// a log of the fit is no validation, and the robot's file is to be the same.
///
/// # Errors
/// [`Error`] where the limit is not above zero, or an estimate is of another robot or of other parameters; of
/// [`armid_io::ErrorKind::Interrupted`] where the observer ended the work.
pub fn validate(
    estimates: &[Estimate],
    name: &str,
    log: &ProcessedLog,
    inputs: [Option<&Inputs>; 2],
    limit: f64,
    observer: &dyn Observer,
) -> Result<ValidationAnswer, Error> {
    check_limit(limit)?;
    let mut log_of_fit = None;
    if let [Some(before), Some(now)] = inputs {
        log_of_fit = before.shared_file(now).map(|file| file.path.as_str());
        if before.robot.name.is_some() && before.robot.name == now.robot.name {
            before.check_robot(&log.robot, name)?;
        }
    }
    let steps = Counter::new(observer, Work::Steps, 2 * estimates.len());
    let verdict = |estimate: &Estimate| {
        steps.begin(name)?;
        let log = log.with_servo_of(estimate, name)?;
        let validation = log.validate(estimate, name)?;
        steps.begin(name)?;
        let found = (validation, log.residual(estimate, name)?.used);
        Ok::<_, Error>(ValidationVerdict::new(&estimate.estimator, &log, found, limit).on_log_of_fit(log_of_fit))
    };
    Ok(ValidationAnswer { verdicts: estimates.iter().map(verdict).collect::<Result<_, _>>()? })
}

/// Compares what a model file predicts with a log, by its own inertias, damping, friction and armature. `name` is what errors call it.
///
/// # Errors
/// [`Error`] where the limit is not above zero, the file states no inertias, or it is of another arm; of
/// [`armid_io::ErrorKind::Interrupted`] where the observer ended the work.
pub fn validate_model(
    model: &LoadedRobot,
    name: &str,
    log: &ProcessedLog,
    limit: f64,
    observer: &dyn Observer,
) -> Result<ValidationAnswer, Error> {
    check_limit(limit)?;
    let Some(parameters) = &model.own else {
        return Err(Error::new(format!("{name} states no inertias, expected a URDF or MJCF that does")));
    };
    let of = Model { robot: &model.robot, parameters };
    let steps = Counter::new(observer, Work::Steps, 2);
    steps.begin(name)?;
    let validation = log.validate_model(&of, name)?;
    steps.begin(name)?;
    let found = (validation, log.model_residual(&of, name)?.used);
    let verdict = ValidationVerdict::new(name, log, found, limit);
    Ok(ValidationAnswer { verdicts: vec![ValidationVerdict { remarks: model.remarks.clone(), ..verdict }] })
}

fn check_limit(limit: f64) -> Result<(), Error> {
    if limit.is_finite() && limit > 0.0 {
        return Ok(());
    }
    Err(Error::new(format!("the limit is {limit}, expected a number above zero")))
}
