//! An estimate as a model file of another tool: what is fitted, what the file predicts, and what it lacks.

use std::fmt::Write;

use armid::estimation::{BodyOrigin, Estimate, EstimatorKind, Model, ModelFit, ModelGuess};
use armid::model::{Columns, ParameterId, Robot, StandardParameters};
use armid_io::robot::ChainSource;
use armid_io::{Error, LoadedRobot, ProcessedLog};
use miette::Result;
use serde_json::{Value, json};

use super::exchange::{Exchange, Reloaded};
use super::model_prediction::{ModelPrediction, PredictionError, percent};
use super::snapping::Snapping;
use crate::terminal::{Answer, Destination, number};

/// Part of the error of a file that is left with a term which helps.
const HELPS: f64 = 0.95;

/// A model file and what is known of it.
pub(crate) struct ModelFile<'a> {
    estimate: &'a Estimate,
    format: Exchange,
    /// The file.
    pub(crate) text: String,
    fit: ModelFit,
    guess: ModelGuess,
    prediction: ModelPrediction,
    reloaded: Reloaded,
    intervals: Intervals,
    /// Terms that the estimate has and the format has not.
    left_out: Vec<&'static str>,
    lacking: Vec<Lacking>,
    snapping: Option<Snapping>,
    remarks: Vec<String>,
    joints: Vec<String>,
    name: String,
}

/// What a file lacks of the estimate, and what that is worth.
struct Lacking {
    what: &'static str,
    /// Error with it, as a share of the torque.
    error: f64,
    /// The joint (from zero) that it matters most to.
    joint: usize,
    /// Torque that the file lacks there, RMS in the joint's unit, and as a share of the measured one.
    rms: f64,
    share: f64,
}

/// Which parameters the log shows each on its own, and which in sums.
#[derive(Default)]
struct Intervals {
    alone: Vec<(ParameterId, [f64; 2])>,
    sums: Vec<Value>,
}

impl<'a> ModelFile<'a> {
    pub(crate) fn new(
        (estimate, estimate_name): (&'a Estimate, &str),
        log: &ProcessedLog,
        (format, into): (Exchange, Option<&ChainSource>),
        destination: &Destination,
    ) -> Result<Self> {
        let loaded = &log.robot;
        let estimated = columns_of(estimate, estimate_name)?;
        let named = |error| Error::mismatch(format!("{estimate_name}: {error}"));
        // With the laws of friction that the estimate found, of which a format may have a plainer one.
        let own = estimate.robot(&loaded.robot, estimated).map_err(named)?;
        let (robot, columns) = (format.robot(&own)?, format.columns(estimated));
        let guess = guess(loaded);
        let fit = log.fit_model(&robot, columns, &guess)?;
        let template = into.or_else(|| format.template(loaded));
        let name = destination
            .path()
            .and_then(|path| path.file_name())
            .map_or_else(|| format!("the {}", format.name()), |name| name.to_string_lossy().into_owned());
        // First without the number that the file is to say of itself.
        let (draft, _) = format.write(&robot, template, &fit.parameters, "")?;
        let (read, found) = format.read(&draft, &robot, template)?;
        let reloaded = Reloaded::compare(&robot, &fit.parameters, (&read, &found), columns)?;
        let model = Model { robot: &read, parameters: &found };
        let prediction = ModelPrediction {
            file: PredictionError::of(&log.model_residual(&model, &name)?),
            estimate: PredictionError::of(&log.residual(estimate, estimate_name)?),
        };
        let header = header(estimate, log, &fit, &prediction.sentence("this file"));
        let (text, written) = format.write(&robot, template, &fit.parameters, &header)?;
        let lacking = if prediction.is_good() {
            Vec::new()
        } else {
            let file = Fitted { robot: &robot, columns, parameters: &fit.parameters };
            file.lacking(log, estimated, &guess, &own)?
        };
        let snapping = if into.is_none() { Snapping::of(loaded, &fit.parameters)? } else { None };
        let left_out = left_out(columns, estimated, &loaded.robot);
        let remarks = loaded.remarks.iter().cloned().chain(written).collect();
        let intervals = Intervals::of(log, columns, &fit.parameters);
        let joints = loaded.robot.joints().iter().map(|joint| joint.name.clone()).collect();
        Ok(Self {
            estimate,
            format,
            text,
            fit,
            guess,
            prediction,
            reloaded,
            intervals,
            left_out,
            lacking,
            snapping,
            remarks,
            joints,
            name,
        })
    }

    /// Whether the file is what was asked for.
    pub(crate) fn is_sound(&self) -> bool {
        self.prediction.is_good() && self.fit.termination.was_successful() && self.reloaded.is_sound()
    }

    pub(crate) fn answer(&self, destination: &Destination) -> Answer {
        Answer { text: format!("{destination}\n{}", self.text()), json: self.json(destination) }
    }

    fn text(&self) -> String {
        let weight = &self.fit.weight;
        let mut text = format!("{}\n", self.prediction.sentence(&self.name));
        for lacking in &self.lacking {
            let unit = self.estimate.units.get(lacking.joint).map_or("", String::as_str);
            let _ = writeln!(
                text,
                "{} has no place for {}: with it the error is {}; it carries {} {unit} RMS of joint \"{}\", {} of its torque",
                self.format.name(),
                lacking.what,
                percent(lacking.error),
                number(lacking.rms),
                self.joints[lacking.joint],
                percent(lacking.share),
            );
        }
        if self.lacking.is_empty() && !self.left_out.is_empty() {
            let _ = writeln!(text, "{} has no place for {}", self.format.name(), self.left_out.join(", "));
        }
        let _ = writeln!(
            text,
            "the guess of the bodies weighs {}, the most that costs no significant error on blocks of the log (least error at {})",
            number(weight.taken),
            number(weight.least)
        );
        for (origin, what) in
            [(BodyOrigin::Shapes, "their shapes"), (BodyOrigin::Length, "the distance of their joints")]
        {
            let links: Vec<String> = (0..self.guess.origins.len())
                .filter(|&i| self.guess.origins[i] == origin)
                .map(|i| format!("\"{}\"", self.joints[i]))
                .collect();
            if !links.is_empty() {
                let _ = writeln!(
                    text,
                    "the robot file states no inertia for the links of {}: their guess is of uniform density, by {what}",
                    links.join(", ")
                );
            }
        }
        if !self.fit.termination.was_successful() {
            let _ = writeln!(text, "the fit {}", self.fit.termination);
        }
        let _ = writeln!(
            text,
            "read back, its torque is that of the regressor to {} of the largest, over {} random states",
            number(self.reloaded.difference),
            self.reloaded.states
        );
        for remark in &self.remarks {
            let _ = writeln!(text, "{remark}");
        }
        text.extend(self.snapping.iter().map(Snapping::text));
        text
    }

    fn json(&self, destination: &Destination) -> Value {
        let lacking = |lacking: &Lacking| {
            json!({
                "term": lacking.what,
                "error_with_it": lacking.error,
                "joint": self.joints[lacking.joint],
                "torque_rms": lacking.rms,
                "torque_share": lacking.share,
            })
        };
        json!({
            "robot": self.estimate.robot,
            "estimator": self.estimate.estimator,
            "to": self.format.name(),
            "file": destination.path(),
            "prediction": self.prediction.json(),
            "lacking": self.lacking.iter().map(lacking).collect::<Vec<_>>(),
            "left_out": self.left_out,
            "prior": self.fit.weight,
            "joint_weights": self.fit.joint_weights,
            "bodies": self.guess.origins,
            "consistent": self.fit.parameters.links.iter().all(|link| link.check().is_ok()),
            "parameters": self.parameters(),
            "sums": self.intervals.sums,
            "termination": self.fit.termination,
            "reload": {
                "states": self.reloaded.states,
                "largest_relative_difference": self.reloaded.difference,
                "largest_friction_difference": self.reloaded.friction,
            },
            "snapped": self.snapping.as_ref().map(Snapping::json),
            "remarks": self.remarks,
        })
    }

    /// Every parameter that is written, with its 95 % interval where the log shows it on its own.
    fn parameters(&self) -> Vec<Value> {
        let links = (0..self.fit.parameters.links.len())
            .flat_map(|index| armid::model::ParameterKind::LINK.map(|kind| ParameterId { kind, index }));
        let terms = self.fit.parameters.drives.iter().enumerate().flat_map(|(index, drive)| {
            let of = |(term, _)| ParameterId { kind: armid::model::ParameterKind::Term(term), index };
            drive.iter().map(of).collect::<Vec<_>>()
        });
        let of = |id: ParameterId| {
            let interval = self.intervals.alone.iter().find(|(own, _)| *own == id).map(|(_, interval)| interval);
            json!({ "name": id.to_string(), "value": self.fit.parameters.get(id), "ci95": interval })
        };
        links.chain(terms).map(of).collect()
    }
}

/// A fit that is compared with richer ones.
#[derive(Clone, Copy)]
struct Fitted<'a> {
    robot: &'a Robot,
    columns: Columns,
    parameters: &'a StandardParameters,
}

impl Fitted<'_> {
    /// What of the estimate would make the file better, the best first.
    fn lacking(&self, log: &ProcessedLog, estimated: Columns, guess: &ModelGuess, own: &Robot) -> Result<Vec<Lacking>> {
        let mut candidates: Vec<(&'static str, Columns, &Robot)> = estimated
            .terms()
            .filter(|term| !self.columns.has(*term))
            .map(|term| (term.entry().meaning, self.columns.with(term), self.robot))
            .filter(|(_, columns, robot)| columns.parameters(robot).len() > self.columns.parameters(robot).len())
            .collect();
        let onset = |robot: &Robot| robot.joints().iter().any(|joint| joint.drive.coulomb_velocity > 0.0);
        if onset(own) && !onset(self.robot) {
            candidates.push(("Coulomb friction that sets in softly", self.columns, own));
        }
        let mut found = Vec::new();
        for (what, columns, robot) in candidates {
            let fit = log.fit_model(robot, columns, guess)?;
            found.push(self.compared(log, what, &Model { robot, parameters: &fit.parameters })?);
        }
        found.sort_by(|a, b| a.error.total_cmp(&b.error));
        // The best in any case; others where they help.
        let own = PredictionError::of(
            &log.model_residual(&Model { robot: self.robot, parameters: self.parameters }, "the file")?,
        );
        let helps = |(place, lacking): &(usize, Lacking)| *place == 0 || lacking.error < HELPS * own.fit();
        Ok(found.into_iter().enumerate().filter(helps).map(|(_, lacking)| lacking).collect())
    }

    fn compared(&self, log: &ProcessedLog, what: &'static str, richer: &Model<'_>) -> Result<Lacking> {
        let error = PredictionError::of(&log.model_residual(richer, what)?).fit();
        let named = |error: armid::estimation::EstimationError| Error::new(error.to_string());
        let states = &log.samples.states;
        let own = Model { robot: self.robot, parameters: self.parameters }.predict(states).map_err(named)?;
        let other = richer.predict(states).map_err(named)?;
        let (n, count) = (log.samples.dof(), log.samples.len().max(1) as f64);
        let rms = |i: usize, of: &dyn Fn(usize) -> f64| -> f64 {
            ((0..log.samples.len()).map(|k| of(k * n + i).powi(2)).sum::<f64>() / count).sqrt()
        };
        let lack: Vec<(f64, f64)> = (0..n)
            .map(|i| {
                let lack = rms(i, &|at| other[at] - own[at]);
                (lack, lack / rms(i, &|at| log.samples.tau[at]).max(f64::MIN_POSITIVE))
            })
            .collect();
        let joint = (0..n).fold(0, |most, i| if lack[i].1 > lack[most].1 { i } else { most });
        Ok(Lacking { what, error, joint, rms: lack[joint].0, share: lack[joint].1 })
    }
}

impl Intervals {
    /// By weighted least squares with the terms of the file; none where the motion does not separate them. An interval is wide enough
    /// to hold what is written.
    fn of(prepared: &ProcessedLog, columns: Columns, parameters: &StandardParameters) -> Self {
        let estimated = prepared.identify(columns, EstimatorKind::Wls);
        let (Ok(estimate), Ok(observation)) = (estimated, prepared.observation(columns)) else {
            return Self::default();
        };
        let Ok(expressions) = prepared.expressions(&estimate, "the fit") else { return Self::default() };
        let mut intervals = Self::default();
        for (row, (base, expression)) in estimate.base.iter().zip(expressions).enumerate() {
            let terms = observation.base.terms(row);
            let value: f64 = terms.iter().map(|&(id, coefficient)| coefficient * parameters.get(id)).sum();
            let ci95 = [base.ci95[0].min(value), base.ci95[1].max(value)];
            // One that the estimate withholds.
            if !ci95.iter().all(|end| end.is_finite()) {
                continue;
            }
            match terms.as_slice() {
                [(id, _)] => intervals.alone.push((*id, ci95)),
                _ => intervals.sums.push(json!({ "sum": expression, "value": value, "ci95": ci95, "unit": base.unit })),
            }
        }
        intervals
    }
}

/// The error with which a URDF or an MJCF of a log would predict it, by its model before it is written.
pub(crate) fn prediction_of(format: Exchange, log: &ProcessedLog) -> Result<PredictionError> {
    let loaded = &log.robot;
    let robot = format.robot(&loaded.robot)?;
    let fit = log.fit_model(&robot, format.columns(Columns::RIGID), &guess(loaded))?;
    let model = Model { robot: &robot, parameters: &fit.parameters };
    Ok(PredictionError::of(&log.model_residual(&model, format.name())?))
}

/// Which columns an estimate has.
pub(crate) fn columns_of(estimate: &Estimate, name: &str) -> Result<Columns, Error> {
    Columns::parse(&estimate.columns).ok_or_else(|| {
        let expected = Columns::ALL.map(|columns| columns.to_string()).join(", ");
        Error::new(format!("{name}: the set of columns is \"{}\", expected one such as {expected}", estimate.columns))
    })
}

/// What is known of the bodies before the log.
fn guess(loaded: &LoadedRobot) -> ModelGuess {
    let shapes: Vec<_> =
        loaded.collisions.iter().filter_map(|shape| Some((shape.link.checked_sub(1)?, shape.solid(&[])?))).collect();
    ModelGuess::new(&loaded.robot, loaded.guess(), &shapes)
}

/// What the terms are called that the estimate has and the format has not.
fn left_out(columns: Columns, estimated: Columns, robot: &Robot) -> Vec<&'static str> {
    let mut meanings: Vec<&'static str> = Vec::new();
    for term in estimated.terms().filter(|&term| !columns.has(term)) {
        let acts = (0..robot.dof()).any(|index| term.is_at(robot, index));
        if acts && !meanings.contains(&term.entry().meaning) {
            meanings.push(term.entry().meaning);
        }
    }
    meanings
}

/// The comment at the top of the file.
fn header(estimate: &Estimate, log: &ProcessedLog, fit: &ModelFit, sentence: &str) -> String {
    format!(
        "{} identified from {} by armid {}.\n{sentence}.\nThe guess of the bodies weighs {}.",
        estimate.robot,
        log.name(),
        env!("CARGO_PKG_VERSION"),
        number(fit.weight.taken),
    )
}
