//! What a campaign is asked for, as its folder keeps it.

use std::path::{Path, PathBuf};

use armid::input::size::{DESIGNS, HARMONICS, PERIOD_S};
use armid::model::Columns;
use armid::model::format::ChainEnds;
use armid::signal::TorqueFilter;
use armid_io::{Error, Text, bundled_experiments, robot};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::target::Target;
use crate::design::HeaviestLoad;

/// Rate that an experiment is sampled at, at most, where nothing states it, Hz.
const MOST_RATE_HZ: f64 = 500.0;

/// Recorded periods of a round, where nothing states them.
const PERIODS: i64 = 4;

/// Ramps of an experiment, where nothing states them, s.
const RAMP_S: f64 = 2.0;

/// Rounds, at most.
const MOST_ROUNDS: usize = 100;

/// Of which robot, until when, and how: `campaign.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CampaignSettings {
    /// What must be reached.
    pub until: Vec<Target>,
    /// The most rounds; every round is a look, for which intervals are wider.
    pub most_rounds: usize,
    /// Whether the first motion is repeated instead of designed again, for comparison: until the targets are met, or the last round.
    pub repeats: bool,
    /// Whether somebody performs the rounds, and brings their logs.
    pub by_hand: bool,
    /// Share of the designed speed in the first round.
    pub first_speed: f64,
    /// Which parameters are estimated, at least.
    pub columns: String,
    /// Whether terms that the logs show are added to them before a target counts as out of reach.
    #[serde(default)]
    pub adds_terms: bool,
    /// Low pass of torques that logs of rounds are to be processed with. Where encoder counts make the band of positions narrow, torque of any
    /// other band looks like that of another arm.
    #[serde(default)]
    pub torque_filter: TorqueFilter,
    /// Period of the motions, s.
    pub period_s: f64,
    /// Harmonics of the motions.
    pub harmonics: usize,
    /// First guesses at which a search of a motion starts.
    pub starts: u64,
    /// Evaluations of each start.
    pub evaluations: usize,
    /// Seed of every random number.
    pub seed: u64,
    /// Estimate of the arm without the load, for targets of the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without: Option<PathBuf>,
    /// The heaviest load that motions are designed for, for targets of the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<HeaviestLoad>,
    /// Every round's experiment but for its name, motion and noise, as `experiment.toml` has it.
    pub experiment: Table,
}

impl CampaignSettings {
    /// With the defaults of the command.
    pub fn new(experiment: Table, until: Vec<Target>) -> Self {
        Self {
            until,
            most_rounds: 8,
            repeats: false,
            by_hand: false,
            first_speed: 0.5,
            columns: Columns::RIGID_ROTOR_FRICTION.to_string(),
            adds_terms: true,
            torque_filter: TorqueFilter::None,
            period_s: 10.0,
            harmonics: 5,
            starts: 3,
            evaluations: 150,
            seed: 1,
            without: None,
            load: None,
            experiment,
        }
    }

    /// Recorded periods of a round at full speed.
    pub(super) fn periods(&self) -> usize {
        let stated = self.experiment.get("periods").and_then(Value::as_integer);
        stated.and_then(|periods| usize::try_from(periods).ok()).unwrap_or(10)
    }

    /// Length of the ramps of every round's experiment, on which its motion keeps the limits too, s.
    pub(super) fn ramp_s(&self) -> f64 {
        let stated = self.experiment.get("ramp_s");
        let stated = stated.and_then(|value| value.as_float().or(value.as_integer().map(|whole| whole as f64)));
        stated.unwrap_or(RAMP_S)
    }

    /// Everything is possible.
    pub(super) fn check(&self) -> Result<(), Error> {
        let refused = |what: &str, found: &dyn std::fmt::Display, expected: &str| {
            Err(Error::new(format!("{what} is {found}, expected {expected}")))
        };
        HARMONICS.check_count("number of harmonics", self.harmonics)?;
        PERIOD_S.check("period", self.period_s)?;
        DESIGNS.check("number of starts", self.starts as f64)?;
        if self.until.is_empty() {
            return Err(Error::new("no target is named, expected one at least, such as \"torque <= 3 %\""));
        }
        if !(1..=MOST_ROUNDS).contains(&self.most_rounds) {
            return refused("the number of rounds", &self.most_rounds, &format!("1 to {MOST_ROUNDS}"));
        }
        if !(self.first_speed > 0.0 && self.first_speed <= 1.0) {
            return refused("the speed of the first round", &self.first_speed, "more than 0 and at most 1");
        }
        let of_load = self.until.iter().filter(|target| target.is_of_load()).count();
        match (&self.without, &self.load) {
            (None, None) if of_load == 0 => Ok(()),
            (Some(_), Some(load)) if of_load == self.until.len() => load.body().map(|_| ()),
            (Some(_), Some(_)) => Err(Error::new(
                "targets of the load and of the arm in one campaign, expected one for the arm, and then one for its load",
            )),
            _ => Err(Error::new(
                "a target of the load needs an estimate of the arm without it and the heaviest load, found not both",
            )),
        }
    }
}

/// The experiment of a campaign on something with this name: an experiment, of which all but the motion stays, or a robot.
///
/// # Errors
/// [`Error`] where it is neither.
pub fn experiment_table(name: &str, ends: &ChainEnds) -> Result<Table, Error> {
    if let Some((text, mut table)) = experiment_of(name)? {
        table.remove("trajectory");
        if let Some(Value::String(robot)) = table.get_mut("robot") {
            *robot = lasting_name(robot, Path::new(&text.name).parent())?;
        }
        return Ok(table);
    }
    let servo_hz = robot::load(name, ends, None)?.robot.servo().rate_hz;
    let mut table = Table::new();
    table.insert("robot".to_owned(), Value::String(lasting_name(name, None)?));
    for (key, link) in [("base_link", &ends.base), ("tip_link", &ends.tip)] {
        if let Some(link) = link {
            table.insert(key.to_owned(), Value::String(link.clone()));
        }
    }
    table.insert("rate_hz".to_owned(), Value::Float(servo_hz / (servo_hz / MOST_RATE_HZ).ceil()));
    table.insert("periods".to_owned(), Value::Integer(PERIODS));
    Ok(table)
}

/// The experiment with this name, which names its robot; `None` where it is that of something else.
fn experiment_of(name: &str) -> Result<Option<(Text, Table)>, Error> {
    let path = PathBuf::from(name);
    let path = if path.is_dir() { path.join("experiment.toml") } else { path };
    let text = if path.is_file() {
        Text::read(&path)?
    } else {
        let Some(found) = bundled_experiments::find(name, "experiment.toml") else { return Ok(None) };
        Text::new(format!("experiments/{}/experiment.toml", found.folder), found.text)
    };
    if Path::new(&text.name).extension().is_none_or(|ending| ending != "toml") {
        return Ok(None);
    }
    let table: Table = toml::from_str(&text.content).map_err(|error| Error::of_toml(&text, &error))?;
    Ok(table.contains_key("robot").then_some((text, table)))
}

/// What a robot is called from any folder.
fn lasting_name(name: &str, beside: Option<&Path>) -> Result<String, Error> {
    if robot::find(name).is_ok() {
        return Ok(name.to_owned());
    }
    let path = beside.map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
    let whole = std::path::absolute(&path).map_err(|error| Error::unreadable(&path, &error))?;
    Ok(whole.display().to_string())
}
