//! The files of a campaign: `campaign.toml`, and a folder for each round.

use std::path::{Path, PathBuf};

use armid::trajectory::PeriodicTrajectory;
use armid_io::output::write_text;
use armid_io::{Error, Inputs, Text, experiment};
use serde::de::DeserializeOwned;
use serde_json::Value as Json;
use toml::Value;

use super::settings::CampaignSettings;
use crate::set_points::{PointFormat, SetPoints};

/// What keeps the settings.
pub(super) const SETTINGS: &str = "campaign.toml";

/// Fewest periods that show noise.
const LEAST_PERIODS: usize = 2;

/// A round that is to be performed, or was.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Round {
    /// Its number, from one.
    pub number: usize,
    /// Its folder.
    pub folder: PathBuf,
    /// How long the arm moves, from rest to rest, s; zero as long as there is no experiment.
    pub seconds: f64,
}

impl Round {
    /// The round with this number.
    pub(super) fn of(campaign: &Path, number: usize) -> Result<Self, Error> {
        let folder = campaign.join("rounds").join(format!("{number:02}"));
        let mut round = Self { number, folder, seconds: 0.0 };
        if round.experiment().is_file() {
            let planned = experiment::load(&round.experiment().to_string_lossy())?;
            round.seconds = planned.plan.duration_s().map_err(Error::new)?;
        }
        Ok(round)
    }

    /// The designed motion.
    pub fn trajectory(&self) -> PathBuf {
        self.folder.join("trajectory.toml")
    }

    /// What is performed.
    pub fn experiment(&self) -> PathBuf {
        self.folder.join("experiment.toml")
    }

    /// Where an arm's recording of it goes.
    pub fn recording(&self) -> PathBuf {
        self.folder.join("log.mcap")
    }

    /// Its estimate: a round that has one is finished.
    pub fn estimate(&self) -> PathBuf {
        self.folder.join("E.json")
    }

    /// The estimate by the equations of all rounds so far at the same sampling.
    pub(super) fn together(&self) -> PathBuf {
        self.folder.join("together.json")
    }

    /// Writes the experiment with the designed motion, at a part of its speed. The experiment comes last: where it is, the rest is.
    pub(super) fn write_experiment(&mut self, settings: &CampaignSettings, speed: f64) -> Result<(), Error> {
        let mut table = settings.experiment.clone();
        let mut motion = "trajectory.toml";
        if speed < 1.0 {
            let text = Text::read(&self.trajectory())?;
            let designed = PeriodicTrajectory::from_toml(&text.content);
            let slow = designed.map_err(|error| Error::new(format!("{}: {error}", text.name)))?.at_speed(speed);
            motion = "slow.toml";
            write_text(&self.folder.join(motion), &slow.to_toml())?;
            // A slower period takes longer.
            let fewer = ((settings.periods() as f64 * speed).ceil() as usize).max(LEAST_PERIODS);
            table.insert("periods".to_owned(), Value::Integer(fewer as i64));
        }
        for (key, value) in [("name", format!("round-{:02}", self.number)), ("trajectory", motion.to_owned())] {
            table.insert(key.to_owned(), Value::String(value));
        }
        table.insert("seed".to_owned(), Value::Integer(settings.seed as i64));
        table.insert("run".to_owned(), Value::Integer(self.number as i64));
        let text = toml::to_string(&table).map_err(Error::new)?;
        // Before the file is there, it is read as any experiment is.
        let name = self.experiment().display().to_string();
        let planned = experiment::parse(Text::new(name, text.clone()), Some(&self.folder))?;
        planned.plan.check_limits(&planned.robot.robot).map_err(Error::new)?;
        self.seconds = planned.plan.duration_s().map_err(Error::new)?;
        write_text(&self.experiment(), &text)
    }

    /// Writes the set-points for the controller of any robot; returns their file.
    ///
    /// # Errors
    /// [`Error`] where they cannot be written.
    pub fn write_points(&self) -> Result<PathBuf, Error> {
        let planned = experiment::load(&self.experiment().to_string_lossy())?;
        let path = self.folder.join("points.csv");
        write_text(&path, &SetPoints::new(&planned.plan)?.text(PointFormat::Csv)?)?;
        Ok(path)
    }
}

/// What several logs were, as one, with what is not of the logs from the last.
pub(super) fn joined(all: Vec<Inputs>, last: Inputs) -> Inputs {
    let (logs, files): (Vec<_>, Vec<_>) = all.into_iter().map(|one| (one.logs, one.files)).unzip();
    Inputs { logs: logs.concat(), files: files.concat(), ..last }
}

/// What an estimate was made from, as it stands in a file of a folder: paths within the folder begin there, so that it can be moved.
pub(super) fn beginning_in(folder: &Path, mut inputs: Inputs) -> Inputs {
    for path in inputs.logs.iter_mut().chain(inputs.files.iter_mut().map(|file| &mut file.path)) {
        if let Ok(inside) = Path::new(path.as_str()).strip_prefix(folder) {
            *path = inside.display().to_string();
        }
    }
    inputs
}

/// What the file of an estimate says that it was made from, word for word.
pub(super) fn stated_inputs(path: &Path) -> Result<Json, Error> {
    let text = Text::read(path)?;
    let mut value: Json = serde_json::from_str(&text.content).map_err(|error| Error::of_json(&text, &error))?;
    Ok(value["inputs"].take())
}

/// What a file in TOML keeps; `None` where it is not there.
pub(super) fn read_toml<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, Error> {
    if !path.is_file() {
        return Ok(None);
    }
    let text = Text::read(path)?;
    toml::from_str(&text.content).map(Some).map_err(|error| Error::of_toml(&text, &error))
}
