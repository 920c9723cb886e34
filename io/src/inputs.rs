//! What an estimate was made from, as its file records it: robot, logs, mapping, processing.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use armid::model::bundled;
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
    /// What the file of an estimate says; `None` where an older version wrote it. A relative path that leads nowhere from the
    /// current folder, and somewhere from the folder of the estimate, is taken from there.
    ///
    /// # Errors
    /// [`Error`] where it says something else.
    pub fn of_estimate(text: &Text) -> Result<Option<Self>, Error> {
        let value: Value = serde_json::from_str(&text.content).map_err(|error| Error::of_json(text, &error))?;
        let one = value.get(0).unwrap_or(&value);
        match one.get("inputs") {
            None | Some(Value::Null) => Ok(None),
            Some(inputs) => {
                let mut inputs: Self = serde_json::from_value(inputs.clone())
                    .map_err(|error| Error::new(format!("{}: inputs: {error}", text.name)))?;
                inputs.look_beside(Path::new(&text.name).parent().unwrap_or(Path::new("")));
                Ok(Some(inputs))
            }
        }
    }

    /// Paths that lead nowhere from the current folder are taken from another one, where they lead somewhere from there.
    fn look_beside(&mut self, folder: &Path) {
        let robot = self.robot.name.as_mut().filter(|name| bundled().iter().all(|entry| entry.name != name.as_str()));
        let files = self.files.iter_mut().map(|file| &mut file.path);
        for path in robot.into_iter().chain(&mut self.logs).chain(&mut self.held_out_log).chain(files) {
            let beside = folder.join(path.as_str());
            if !Path::new(path.as_str()).exists() && beside.exists() {
                *path = beside.display().to_string();
            }
        }
    }

    /// A file that both were made from, the same bytes in times that both use; none where there is no such file.
    pub fn shared_file<'a>(&self, other: &'a Self) -> Option<&'a FileHash> {
        let span = |inputs: &Self| (inputs.settings.from_s, inputs.settings.until_s.unwrap_or(f64::INFINITY));
        let ((a_from, a_until), (b_from, b_until)) = (span(self), span(other));
        let found = other.files.iter().find(|file| self.files.iter().any(|of_self| of_self.sha256 == file.sha256));
        found.filter(|_| a_from < b_until && b_from < a_until)
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::{Inputs, RobotSource};
    use crate::log::{FileHash, LogSettings};
    use crate::text::Text;

    fn inputs(robot: &str, log: &str, sha256: &str, span: (f64, Option<f64>)) -> Inputs {
        Inputs {
            robot: RobotSource { name: Some(robot.to_owned()), sha256: String::new(), base_link: None, tip_link: None },
            logs: vec![log.to_owned()],
            held_out_log: None,
            files: vec![FileHash { path: log.to_owned(), sha256: sha256.to_owned() }],
            mapping: None,
            rate_hz: None,
            settings: LogSettings { from_s: span.0, until_s: span.1, ..LogSettings::default() },
        }
    }

    #[test]
    fn paths_are_looked_for_beside_the_estimate_as_well() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("x.urdf"), "").unwrap();
        // A folder that is called as a bundled robot is not that robot.
        std::fs::create_dir(folder.path().join("crs-a460")).unwrap();
        let of = |robot: &str, log: &str| {
            let content = json!({ "inputs": inputs(robot, log, "a", (0.0, None)) }).to_string();
            let name = folder.path().join("E.json").display().to_string();
            Inputs::of_estimate(&Text::new(name, content)).unwrap().unwrap()
        };
        let beside = folder.path().join("x.urdf").display().to_string();
        let found = of("x.urdf", "nowhere.csv");
        assert_eq!((found.robot.name, &found.logs[0][..]), (Some(beside.clone()), "nowhere.csv"));
        let found = of("crs-a460", "x.urdf");
        assert_eq!((found.robot.name.as_deref(), &found.logs[0]), (Some("crs-a460"), &beside));
    }

    #[test]
    fn a_file_is_shared_where_its_bytes_and_the_times_of_both_are() {
        let fit = inputs("r", "a.csv", "a", (0.0, Some(10.0)));
        let shared = |sha256: &str, from: f64| fit.shared_file(&inputs("r", "b.csv", sha256, (from, None))).is_some();
        assert!(shared("a", 0.0) && shared("a", 9.0));
        assert!(!shared("b", 0.0) && !shared("a", 10.0));
    }
}
