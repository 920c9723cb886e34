//! An estimate as a model file of another tool: what is fitted, what the file predicts, and what it lacks.

use std::path::PathBuf;

use armid::estimation::{BodyOrigin, Estimate, EstimatorKind, Model, ModelFit, ModelGuess, PriorWeight, Termination};
use armid::model::term::Term;
use armid::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters, distinct};
use armid::observer::{Observer, Progress, Work};
use armid_io::robot::ChainSource;
use armid_io::{Error, ErrorKind, LoadedRobot, ProcessedLog};
use serde::Serialize;

use super::exchange::{Exchange, Reloaded};
use super::model_prediction::{ModelPrediction, PredictionError};
use super::snapping::Snapping;
use crate::numbers::number;
use crate::payload::columns_of;

/// Part of the error of a file that is left with a term which helps.
const HELPS: f64 = 0.95;

/// Which file an estimate becomes.
#[derive(Clone, Debug)]
pub struct ExportSettings {
    /// Its format.
    pub format: Exchange,
    /// A URDF or MJCF of the same arm that gets the numbers; the robot's own file where `None`.
    pub into: Option<ChainSource>,
    /// Where the text will stand; its name is in the file's comment.
    pub file: Option<PathBuf>,
}

impl ExportSettings {
    /// What the file is called in sentences.
    fn name(&self) -> String {
        let name = self.file.as_ref().and_then(|path| path.file_name());
        name.map_or_else(|| format!("the {}", self.format.name()), |name| name.to_string_lossy().into_owned())
    }
}

/// A model file, and what is known of it. It serialises to the keys of the command's answer.
#[derive(Clone, Debug, Serialize)]
pub struct ModelFile {
    /// Name of the robot.
    pub robot: String,
    /// The estimator.
    pub estimator: String,
    /// The format.
    pub to: Exchange,
    /// Where the text will stand.
    pub file: Option<PathBuf>,
    /// What it is called in sentences.
    #[serde(skip)]
    pub name: String,
    /// The file.
    #[serde(skip)]
    pub text: String,
    /// How well it predicts the log.
    pub prediction: ModelPrediction,
    /// What it lacks where it predicts badly, the term that helps most first.
    pub lacking: Vec<Lacking>,
    /// Terms that the estimate has and the format has not.
    pub left_out: Vec<&'static str>,
    /// How much the guess of the bodies counts.
    pub prior: PriorWeight,
    /// 1/σ² of the residual of each joint: how much its equations count.
    pub joint_weights: Vec<f64>,
    /// Where that guess comes from, link by link.
    pub bodies: Vec<BodyOrigin>,
    /// Whether every body can be one.
    pub consistent: bool,
    /// Every parameter that is written.
    pub parameters: Vec<WrittenParameter>,
    /// Sums of parameters that the log shows.
    pub sums: Vec<KnownSum>,
    /// How the fit ended.
    pub termination: Termination,
    /// What the file says when it is read back.
    pub reload: Reloaded,
    /// Angles of the robot's URDF that were read as right ones.
    pub snapped: Option<Snapping>,
    /// What else the reader must know.
    pub remarks: Vec<String>,
    /// Names of the joints.
    #[serde(skip)]
    pub joints: Vec<String>,
}

/// What a file lacks of the estimate, and what that is worth.
#[derive(Clone, Debug, Serialize)]
pub struct Lacking {
    /// The term.
    pub term: &'static str,
    /// Error with it, as a share of the torque.
    pub error_with_it: f64,
    /// The joint that it matters most to.
    pub joint: String,
    /// Torque that the file lacks there, RMS.
    pub torque_rms: f64,
    /// Its unit.
    #[serde(skip)]
    pub unit: String,
    /// That RMS as a share of the measured torque.
    pub torque_share: f64,
}

/// A parameter that is written.
#[derive(Clone, Debug, Serialize)]
pub struct WrittenParameter {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// 95 % interval, where the log shows it on its own.
    pub ci95: Option<[f64; 2]>,
}

/// A sum of parameters that the log shows.
#[derive(Clone, Debug, Serialize)]
pub struct KnownSum {
    /// The sum.
    pub sum: String,
    /// Its value by what is written.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Unit.
    pub unit: String,
}

/// Which parameters the log shows each on its own, and which in sums.
#[derive(Default)]
struct Intervals {
    alone: Vec<(ParameterId, [f64; 2])>,
    sums: Vec<KnownSum>,
}

/// Fits the model that a file of another tool can hold to the log of an estimate, which errors call `name`, and writes the file. An
/// observer may end the fit, or the comparison with terms that the format lacks: what was compared by then is kept.
///
/// # Errors
/// [`Error`] where the estimate is of another robot, no model of these terms explains the log, or the file does not read back; of
/// [`ErrorKind::Interrupted`] where the observer ended the fit.
pub fn export(
    estimate: &Estimate,
    name: &str,
    mut log: ProcessedLog,
    settings: &ExportSettings,
    observer: &dyn Observer,
) -> Result<ModelFile, Error> {
    log.take_shape(estimate, name)?;
    let (log, format) = (&log, settings.format);
    let loaded = &log.robot;
    let estimated = columns_of(estimate, name)?;
    let named = |error| Error::mismatch(format!("{name}: {error}"));
    // With the laws of friction that the estimate found, of which a format may have a plainer one.
    let own = estimate.robot(&loaded.robot, estimated).map_err(named)?;
    let (robot, columns) = (format.robot(&own)?, format.columns(estimated));
    let guess = guess(loaded);
    let fit = log.fit_model(&robot, columns, &guess, observer)?;
    let template = settings.into.as_ref().or_else(|| format.template(loaded));
    let file_name = settings.name();
    // First without the number that the file is to say of itself.
    let (draft, _) = format.write(&robot, template, &fit.parameters, "")?;
    let (read, found) = format.read(&draft, &robot, template)?;
    let reload = Reloaded::compare(&robot, &fit.parameters, (&read, &found), columns)?;
    let model = Model { robot: &read, parameters: &found };
    let prediction = ModelPrediction::new(
        PredictionError::of(&log.model_residual(&model, &file_name)?),
        PredictionError::of(&log.residual(estimate, name)?),
    );
    let header = header(estimate, log, &fit, &prediction.sentence("this file"));
    let (text, written) = format.write(&robot, template, &fit.parameters, &header)?;
    let lacking = if prediction.good {
        Vec::new()
    } else {
        let file = Fitted { robot: &robot, columns, parameters: &fit.parameters };
        file.lacking(log, estimated, &guess, &own, observer)?
    };
    let snapped = if settings.into.is_none() { Snapping::of(loaded, &fit.parameters)? } else { None };
    let intervals = Intervals::of(log, columns, &fit.parameters);
    Ok(ModelFile {
        robot: estimate.robot.clone(),
        estimator: estimate.estimator.clone(),
        to: format,
        file: settings.file.clone(),
        name: file_name,
        text,
        prediction,
        lacking,
        left_out: left_out(columns, estimated, &loaded.robot),
        prior: fit.weight,
        joint_weights: fit.joint_weights,
        bodies: guess.origins,
        consistent: fit.parameters.links.iter().all(|link| link.check().is_ok()),
        parameters: parameters(&fit.parameters, &intervals),
        sums: intervals.sums,
        termination: fit.termination,
        reload,
        snapped,
        remarks: loaded.remarks.iter().cloned().chain(written).collect(),
        joints: log.joint_names(),
    })
}

impl ModelFile {
    /// Whether the file is what was asked for.
    pub fn is_sound(&self) -> bool {
        self.prediction.good && self.termination.was_successful() && self.reload.is_sound()
    }
}

/// Every parameter that is written, with its 95 % interval where the log shows it on its own.
fn parameters(written: &StandardParameters, intervals: &Intervals) -> Vec<WrittenParameter> {
    let links = (0..written.links.len()).flat_map(|index| ParameterKind::LINK.map(|kind| ParameterId { kind, index }));
    let terms = written.drives.iter().enumerate().flat_map(|(index, drive)| {
        drive.iter().map(move |(term, _)| ParameterId { kind: ParameterKind::Term(term), index })
    });
    let of = |id: ParameterId| {
        let ci95 = intervals.alone.iter().find(|(own, _)| *own == id).map(|(_, interval)| *interval);
        WrittenParameter { name: id.to_string(), value: written.get(id), ci95 }
    };
    links.chain(terms).map(of).collect()
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
    fn lacking(
        &self,
        log: &ProcessedLog,
        estimated: Columns,
        guess: &ModelGuess,
        own: &Robot,
        observer: &dyn Observer,
    ) -> Result<Vec<Lacking>, Error> {
        let of = |columns: Columns| columns.parameters(self.robot).len();
        let terms = estimated.terms().filter(|term| !self.columns.has(*term));
        let with = terms.map(|term| (term.entry().meaning, self.columns.with_term(term), self.robot));
        let mut candidates: Vec<(&'static str, Columns, &Robot)> =
            with.filter(|(_, columns, _)| of(*columns) > of(self.columns)).collect();
        let onset = |robot: &Robot| robot.joints().iter().any(|joint| joint.drive.coulomb_velocity > 0.0);
        if onset(own) && !onset(self.robot) {
            candidates.push(("Coulomb friction that sets in softly", self.columns, own));
        }
        let mut found = Vec::new();
        let total = candidates.len();
        for (done, (what, columns, robot)) in candidates.into_iter().enumerate() {
            if observer.observe(Progress { work: Work::Steps, done, total }).is_break() {
                break;
            }
            let fit = match log.fit_model(robot, columns, guess, observer) {
                Err(error) if error.kind() == ErrorKind::Interrupted => break,
                fit => fit?,
            };
            found.push(self.compared(log, what, &Model { robot, parameters: &fit.parameters })?);
        }
        found.sort_by(|a, b| a.error_with_it.total_cmp(&b.error_with_it));
        // The best in any case; others where they help.
        let own = PredictionError::of(
            &log.model_residual(&Model { robot: self.robot, parameters: self.parameters }, "the file")?,
        );
        let helps = |(place, lacking): &(usize, Lacking)| *place == 0 || lacking.error_with_it < HELPS * own.fit;
        Ok(found.into_iter().enumerate().filter(helps).map(|(_, lacking)| lacking).collect())
    }

    fn compared(&self, log: &ProcessedLog, what: &'static str, richer: &Model<'_>) -> Result<Lacking, Error> {
        let error = PredictionError::of(&log.model_residual(richer, what)?).fit;
        let states = &log.samples.states;
        let own = Model { robot: self.robot, parameters: self.parameters }.predict(states).map_err(Error::new)?;
        let other = richer.predict(states).map_err(Error::new)?;
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
        Ok(Lacking {
            term: what,
            error_with_it: error,
            joint: log.robot.robot.joints()[joint].name.clone(),
            torque_rms: lack[joint].0,
            unit: log.samples.units[joint].clone(),
            torque_share: lack[joint].1,
        })
    }
}

impl Intervals {
    /// By weighted least squares with the terms of the file; none where the motion does not separate them. An interval is wide enough
    /// to hold what is written.
    fn of(log: &ProcessedLog, columns: Columns, parameters: &StandardParameters) -> Self {
        let estimated = log.identify(columns, EstimatorKind::Wls);
        let (Ok(estimate), Ok(observation)) = (estimated, log.observation(columns)) else {
            return Self::default();
        };
        let Ok(expressions) = log.expressions(&estimate, "the fit") else { return Self::default() };
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
                _ => intervals.sums.push(KnownSum { sum: expression, value, ci95, unit: base.unit.clone() }),
            }
        }
        intervals
    }
}

/// The error with which a URDF or an MJCF of a log would predict it, by its model before it is written.
///
/// # Errors
/// [`Error`] where no model of the format's terms explains the log, or the observer ended the fit.
pub fn prediction_of(format: Exchange, log: &ProcessedLog, observer: &dyn Observer) -> Result<PredictionError, Error> {
    let loaded = &log.robot;
    let robot = format.robot(&loaded.robot)?;
    let fit = log.fit_model(&robot, format.columns(Columns::RIGID), &guess(loaded), observer)?;
    let model = Model { robot: &robot, parameters: &fit.parameters };
    Ok(PredictionError::of(&log.model_residual(&model, format.name())?))
}

/// What is known of the bodies before the log.
fn guess(loaded: &LoadedRobot) -> ModelGuess {
    let shapes: Vec<_> =
        loaded.collisions.iter().filter_map(|shape| Some((shape.link.checked_sub(1)?, shape.solid(&[])?))).collect();
    ModelGuess::new(&loaded.robot, loaded.guess(), &shapes)
}

/// What the terms are called that the estimate has and the format has not.
fn left_out(columns: Columns, estimated: Columns, robot: &Robot) -> Vec<&'static str> {
    let acts = |term: &Term| (0..robot.dof()).any(|index| term.is_at(robot, index));
    let missing = estimated.terms().filter(|term| !columns.has(*term) && acts(term));
    distinct(missing.map(|term| term.entry().meaning))
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
