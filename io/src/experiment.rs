//! `experiment.toml`: which robot, which motion, how often, and how fast it is sampled.
//!
//! What the file says of the arm that performs it (`arm`, `[ros2]`, `[guard]`) is left to the program that has such an arm: the
//! text comes with the experiment.

use std::path::{Path, PathBuf};

use armid::excitation::Certificate;
use armid::experiment::{Effects, ExperimentPlan, Sensing};
use armid::input::check_file_name;
use armid::model::format::ChainEnds;
use serde::Deserialize;
use serde::de::IgnoredAny;
use toml::Spanned;

use crate::bundled_experiments;
use crate::error::Error;
use crate::robot::{self, LoadedRobot};
use crate::suggestion;
use crate::text::Text;
use crate::trajectory;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<Spanned<String>>,
    /// What the experiment is for: a sentence for the reader.
    #[serde(default)]
    question: Option<String>,
    robot: Spanned<String>,
    base_link: Option<String>,
    tip_link: Option<String>,
    trajectory: Spanned<String>,
    rate_hz: Option<Spanned<f64>>,
    settle_s: Option<Spanned<f64>>,
    ramp_s: Option<Spanned<f64>>,
    discarded_periods: Option<Spanned<usize>>,
    periods: Option<Spanned<usize>>,
    seed: Option<u64>,
    run: Option<u64>,
    #[serde(rename = "arm")]
    _arm: Option<IgnoredAny>,
    sensing: Option<SensingTable>,
    #[serde(rename = "ros2")]
    _ros2: Option<IgnoredAny>,
    /// Effects of the real arm beside those of its truth.
    #[serde(default)]
    effects: Effects,
    #[serde(rename = "guard")]
    _guard: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SensingTable {
    encoders: Option<bool>,
    current_noise: Option<bool>,
    converters: Option<bool>,
    voltage: Option<bool>,
    link_step: Option<Spanned<f64>>,
    position_noise: Option<Spanned<Vec<f64>>>,
}

/// An experiment, ready to be performed by any arm.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Its name.
    pub name: String,
    /// What it is for: a sentence for the reader.
    pub question: Option<String>,
    /// The file.
    pub text: Text,
    /// The robot.
    pub robot: LoadedRobot,
    /// Which chain of a tree the robot is.
    pub chain: ChainEnds,
    /// Motion, periods, rate.
    pub plan: ExperimentPlan,
    /// What the trajectory's file certifies.
    pub certificate: Option<Certificate>,
    /// What the sensors of a simulated arm do wrong.
    pub sensing: Sensing,
    /// Effects of the real arm beside those of its truth, for a simulated arm.
    pub effects: Effects,
    /// Seed of every random number.
    pub seed: u64,
    /// Which repetition it is: the same experiment with other noise.
    pub run: u64,
}

/// Finds and reads an experiment: a bundled name, a folder, or the TOML itself.
///
/// # Errors
/// [`Error`] where there is none, or its file is not as an experiment is written.
pub fn load(name: &str) -> Result<Experiment, Error> {
    let path = PathBuf::from(name);
    let path = if path.is_dir() { path.join("experiment.toml") } else { path };
    if path.is_file() {
        return parse(Text::read(&path)?, path.parent());
    }
    if let Some(found) = bundled_experiments::find(name, "experiment.toml") {
        return parse(Text::new(format!("experiments/{}/experiment.toml", found.folder), found.text), None);
    }
    let names = bundled_experiments::names("experiment.toml");
    let list = if names.is_empty() { "there are no bundled ones".to_owned() } else { suggestion::help(name, &names) };
    Err(Error::unknown(format!(
        "experiment \"{name}\" is neither a file, nor a folder with experiment.toml, nor bundled"
    ))
    .help(list))
}

/// Reads an experiment from its text; files that it names lie beside it.
///
/// # Errors
/// [`Error`] with line and column where it is not as an experiment is written, or names what does not exist.
pub fn parse(text: Text, folder: Option<&Path>) -> Result<Experiment, Error> {
    let file: File = toml::from_str(&text.content).map_err(|error| Error::of_toml(&text, &error))?;
    let chain = ChainEnds { base: file.base_link, tip: file.tip_link };
    let robot = robot::load(file.robot.get_ref(), &chain, folder)?;
    let certificate = trajectory::certificate(file.trajectory.get_ref(), folder)?;
    let trajectory = trajectory::load(file.trajectory.get_ref(), folder, &robot.robot)?;

    let mut plan = ExperimentPlan::new(trajectory);
    let spans = [
        ("rate_hz", file.rate_hz.as_ref().map(Spanned::span)),
        ("settle_s", file.settle_s.as_ref().map(Spanned::span)),
        ("ramp_s", file.ramp_s.as_ref().map(Spanned::span)),
        ("periods", file.periods.as_ref().map(Spanned::span)),
    ];
    plan.rate_hz = file.rate_hz.map_or(plan.rate_hz, Spanned::into_inner);
    plan.settle_s = file.settle_s.map_or(plan.settle_s, Spanned::into_inner);
    plan.ramp_s = file.ramp_s.map_or(plan.ramp_s, Spanned::into_inner);
    plan.discarded_periods = file.discarded_periods.map_or(plan.discarded_periods, Spanned::into_inner);
    plan.periods = file.periods.map_or(plan.periods, Spanned::into_inner);
    plan.layout().map_err(|error| {
        let message = error.to_string();
        // The plan names the key that is at fault first.
        let place = spans.iter().find(|(key, span)| message.starts_with(key) && span.is_some());
        let place = place.or_else(|| spans[..1].iter().find(|(_, span)| span.is_some()));
        match place.and_then(|(_, span)| span.clone()) {
            Some(span) => Error::new(message).at_span(&text, span, "here"),
            None => Error::new(format!("{}: {message}", text.name)),
        }
    })?;

    if let Some(name) = &file.name {
        check_file_name("name", name.get_ref())
            .map_err(|error| Error::new(error).at_span(&text, name.span(), "here"))?;
    }
    let sensing = sensing(file.sensing, &text, robot.robot.dof())?;
    let effects = file.effects;
    let name = match (file.name, folder.and_then(Path::file_name)) {
        (Some(name), _) => name.into_inner(),
        (None, Some(folder)) => folder.to_string_lossy().into_owned(),
        (None, None) => robot.robot.name().to_owned(),
    };
    let (seed, run) = (file.seed.unwrap_or(0), file.run.unwrap_or(0));
    let question = file.question;
    Ok(Experiment { name, question, text, robot, chain, plan, certificate, sensing, effects, seed, run })
}

fn sensing(table: Option<SensingTable>, text: &Text, dof: usize) -> Result<Sensing, Error> {
    let mut sensing = Sensing::default();
    let Some(table) = table else { return Ok(sensing) };
    sensing.encoders = table.encoders.unwrap_or(sensing.encoders);
    sensing.current_noise = table.current_noise.unwrap_or(sensing.current_noise);
    sensing.converters = table.converters.unwrap_or(sensing.converters);
    sensing.voltage = table.voltage.unwrap_or(sensing.voltage);
    if let Some(step) = table.link_step {
        let value = *step.get_ref();
        if !(value.is_finite() && value >= 0.0) {
            let message = format!("link_step is {value}, expected a number not below zero, rad (m)");
            return Err(Error::new(message).at_span(text, step.span(), "here"));
        }
        sensing.link_step = Some(value);
    }
    if let Some(noise) = table.position_noise {
        let values = noise.get_ref();
        if values.len() != dof || values.iter().any(|&value| !(value.is_finite() && value >= 0.0)) {
            let message = format!("position_noise is {values:?}, expected {dof} numbers not below zero, rad (m)");
            return Err(Error::new(message).at_span(text, noise.span(), "here"));
        }
        sensing.position_noise = noise.into_inner();
    }
    Ok(sensing)
}
