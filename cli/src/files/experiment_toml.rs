//! `experiment.toml`: which robot, which motion, how often, how fast it is sampled, and which arm performs it.

use std::path::{Path, PathBuf};

use armid::excitation::Certificate;
use armid::experiment::{Effects, ExperimentPlan, Sensing};
use armid_hardware::guard::{Confirmation, GuardSettings};
use armid_hardware::link::LinkSettings;
use armid_sim::Engine;
use miette::Result;
use serde::Deserialize;
use toml::Spanned;

use super::trajectory;
use crate::arms::ArmKind;
use crate::atomic_file::read_text;
use crate::bundled_experiments;
use crate::fault::{Fault, Text};
use crate::robot_source::{self, ChainArguments, LoadedRobot};
use crate::suggestion;

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
    arm: Option<Spanned<String>>,
    sensing: Option<SensingTable>,
    ros2: Option<Spanned<LinkSettings>>,
    /// Effects of the real arm beside those of its truth.
    #[serde(default)]
    effects: Effects,
    /// Where the guard draws its lines.
    guard: Option<Spanned<GuardSettings>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SensingTable {
    encoders: Option<bool>,
    current_noise: Option<bool>,
    converters: Option<bool>,
    voltage: Option<bool>,
    position_noise: Option<Spanned<Vec<f64>>>,
}

/// An experiment, ready to be performed.
#[derive(Clone, Debug)]
pub(crate) struct Experiment {
    /// Its name: the folder under `reports/`.
    pub(crate) name: String,
    pub(crate) question: Option<String>,
    /// The file.
    pub(crate) text: Text,
    pub(crate) robot: LoadedRobot,
    pub(crate) chain: ChainArguments,
    pub(crate) plan: ExperimentPlan,
    /// What the trajectory's file certifies.
    pub(crate) certificate: Option<Certificate>,
    pub(crate) sensing: Sensing,
    pub(crate) effects: Effects,
    pub(crate) seed: u64,
    pub(crate) run: u64,
    pub(crate) arm: ArmKind,
    /// How the robot of `arm = "ros2"` is reached.
    pub(crate) ros2: LinkSettings,
    /// Where the guard draws its lines.
    pub(crate) guard: GuardSettings,
    /// Whether a simulated arm is watched too.
    pub(crate) guarded: bool,
    /// A person's word that a real arm may move.
    pub(crate) confirmation: Option<Confirmation>,
}

/// Finds and reads an experiment: a bundled name, a folder, or the TOML itself.
pub(crate) fn load(name: &str) -> Result<Experiment> {
    let path = PathBuf::from(name);
    let path = if path.is_dir() { path.join("experiment.toml") } else { path };
    if path.is_file() {
        return parse(read_text(&path)?, path.parent());
    }
    if let Some(found) = bundled_experiments::find(name, "experiment.toml") {
        return parse(Text::new(format!("experiments/{}/experiment.toml", found.folder), found.text), None);
    }
    let names = bundled_experiments::names("experiment.toml");
    let list = if names.is_empty() { "there are no bundled ones".to_owned() } else { suggestion::help(name, &names) };
    Err(Fault::new(format!("experiment \"{name}\" is neither a file, nor a folder with experiment.toml, nor bundled"))
        .help(list)
        .into())
}

/// Reads an experiment from its text; files that it names lie beside it.
pub(crate) fn parse(text: Text, folder: Option<&Path>) -> Result<Experiment> {
    let file: File = toml::from_str(&text.content).map_err(|error| {
        let message = error.message().trim_end().to_owned();
        let help = suggestion::from_list_in(&message);
        Fault::new(message).at(&text, error.span().unwrap_or(0..0), "here").maybe_help(help)
    })?;
    let chain = ChainArguments { base_link: file.base_link, tip_link: file.tip_link };
    let robot = robot_source::load(file.robot.get_ref(), &chain, folder)?;
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
            Some(span) => Fault::new(message).at(&text, span, "here"),
            None => Fault::new(format!("{}: {message}", text.name)),
        }
    })?;

    let arm = match &file.arm {
        None => ArmKind::Simulated(Engine::Analytic),
        Some(name) => ArmKind::parse(name.get_ref()).ok_or_else(|| {
            let names = ArmKind::ALL.map(ArmKind::name);
            Fault::new(format!("arm is \"{}\", expected one of {}", name.get_ref(), names.join(", ")))
                .at(&text, name.span(), "here")
                .maybe_help(suggestion::nearest(name.get_ref(), names).map(|near| format!("did you mean \"{near}\"?")))
        })?,
    };
    let sensing = sensing(file.sensing, &text, robot.robot.dof())?;
    let ros2 = match file.ros2 {
        None => LinkSettings::default(),
        Some(table) => {
            let span = table.span();
            let settings = table.into_inner();
            settings.check().map_err(|error| Fault::new(error.to_string()).at(&text, span, "here"))?;
            settings
        }
    };
    let effects = file.effects;
    let name = match (file.name, folder.and_then(Path::file_name)) {
        (Some(name), _) => name.into_inner(),
        (None, Some(folder)) => folder.to_string_lossy().into_owned(),
        (None, None) => robot.robot.name().to_owned(),
    };
    let (seed, run) = (file.seed.unwrap_or(0), file.run.unwrap_or(0));
    let guard = guard(file.guard, &text)?;
    let (guarded, confirmation) = (false, None);
    let question = file.question;
    Ok(Experiment {
        name,
        question,
        text,
        robot,
        chain,
        plan,
        certificate,
        sensing,
        effects,
        seed,
        run,
        arm,
        ros2,
        guard,
        guarded,
        confirmation,
    })
}

fn guard(table: Option<Spanned<GuardSettings>>, text: &Text) -> Result<GuardSettings> {
    let Some(table) = table else { return Ok(GuardSettings::default()) };
    table.get_ref().check().map_err(|error| Fault::new(error.to_string()).at(text, table.span(), "in this table"))?;
    Ok(table.into_inner())
}

fn sensing(table: Option<SensingTable>, text: &Text, dof: usize) -> Result<Sensing> {
    let mut sensing = Sensing::default();
    let Some(table) = table else { return Ok(sensing) };
    sensing.encoders = table.encoders.unwrap_or(sensing.encoders);
    sensing.current_noise = table.current_noise.unwrap_or(sensing.current_noise);
    sensing.converters = table.converters.unwrap_or(sensing.converters);
    sensing.voltage = table.voltage.unwrap_or(sensing.voltage);
    if let Some(noise) = table.position_noise {
        let values = noise.get_ref();
        if values.len() != dof || values.iter().any(|&value| !(value.is_finite() && value >= 0.0)) {
            let message = format!("position_noise is {values:?}, expected {dof} numbers not below zero, rad (m)");
            return Err(Fault::new(message).at(text, noise.span(), "here").into());
        }
        sensing.position_noise = noise.into_inner();
    }
    Ok(sensing)
}
