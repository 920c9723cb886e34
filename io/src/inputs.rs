//! What an estimate was made from, as its file records it: robot, logs, mapping, processing.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use armid::provenance::sha256;

use crate::error::Error;
use crate::log::{FileHash, LogSettings};
use crate::robot::LoadedRobot;
use crate::text::Text;

/// The robot of an estimate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RobotSource {
    /// What it was called: a bundled name or a path; `None` where the recording held it.
    pub name: Option<String>,
    /// SHA-256 of its file.
    pub sha256: String,
    /// Link at which the chain begins, where it was chosen.
    pub base_link: Option<String>,
    /// Link at which it ends.
    pub tip_link: Option<String>,
}

/// What an estimate was made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    /// The robot.
    pub robot: RobotSource,
    /// The logs, as they were named.
    pub logs: Vec<String>,
    /// The log that was held out, where it was one of its own.
    pub held_out_log: Option<String>,
    /// Their files.
    pub files: Vec<FileHash>,
    /// What the columns were, as `--map` says it.
    pub mapping: Option<String>,
    /// Rows per second of logs without stamps.
    pub rate_hz: Option<f64>,
    /// How the logs were processed.
    pub settings: LogSettings,
}

impl Inputs {
    /// What the file of an estimate says; `None` where an older version wrote it.
    ///
    /// # Errors
    /// [`Error`] where it says something else.
    pub fn of_estimate(text: &Text) -> Result<Option<Self>, Error> {
        let value: Value = serde_json::from_str(&text.content).map_err(|error| Error::of_json(text, &error))?;
        let one = value.get(0).unwrap_or(&value);
        match one.get("inputs") {
            None | Some(Value::Null) => Ok(None),
            Some(inputs) => serde_json::from_value(inputs.clone())
                .map(Some)
                .map_err(|error| Error::new(format!("{}: inputs: {error}", text.name))),
        }
    }

    /// The files of logs are those that the estimate was made from. `name` is what errors call the estimate.
    ///
    /// # Errors
    /// [`Error`] where one has changed.
    pub fn check_files(&self, found: &[FileHash], name: &str) -> Result<(), Error> {
        match self.files.iter().zip(found).find(|(before, now)| before.sha256 != now.sha256) {
            None => Ok(()),
            Some((before, now)) => {
                let message = format!(
                    "{name} was made from {} with the SHA-256 {}, found {} there",
                    before.path, before.sha256, now.sha256
                );
                Err(Error::mismatch(message).help("the log has changed: identify again"))
            }
        }
    }

    /// The robot's file is the one that the estimate was made with. `name` is what errors call the estimate.
    ///
    /// # Errors
    /// [`Error`] where it is another.
    pub fn check_robot(&self, loaded: &LoadedRobot, name: &str) -> Result<(), Error> {
        let found = sha256(&loaded.text.content);
        if found == self.robot.sha256 {
            return Ok(());
        }
        let message = format!(
            "{name} was made with a robot file whose SHA-256 is {}, found {} in {}",
            self.robot.sha256, found, loaded.text.name
        );
        Err(Error::mismatch(message).help("the robot file has changed: identify again"))
    }
}
