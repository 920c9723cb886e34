//! Logs by their files: which, of which robot, and once more as an estimate was made.

use std::path::{Path, PathBuf};

use armid::model::format::ChainEnds;
use armid::provenance::sha256;
use armid::remedy::{Remedy, Setting, Task};
use armid_io::inputs::RobotSource;
use armid_io::log::{FoundLogs, find, is_joint_states, is_table, process_all};
use armid_io::{Error, Inputs, LoadedRobot, LogSettings, ProcessedLog, Text, robot};

/// Which logs are meant.
#[derive(Clone, Debug, Default)]
pub struct LogSource {
    /// The robot, where the logs do not hold it, or another one.
    pub robot: Option<String>,
    /// Its chain, of a tree.
    pub chain: ChainEnds,
    /// What the columns of tables are.
    pub mapping: Option<String>,
    /// Rows per second of a table without a column of times, Hz.
    pub rate_hz: Option<f64>,
}

/// Logs that were found, of a robot.
#[derive(Clone, Debug)]
pub struct NamedLogs {
    /// The logs.
    pub found: FoundLogs,
    paths: Vec<String>,
    robot: (LoadedRobot, RobotSource),
    mapping: Option<String>,
    rate_hz: Option<f64>,
}

impl LogSource {
    /// Finds the logs of these paths and their robot. What was not said is as `remembered` has it: what an estimate was made with.
    ///
    /// # Errors
    /// [`Error`] where a log cannot be read, or nothing names its robot.
    pub fn find(&self, paths: &[PathBuf], remembered: Option<&Inputs>) -> Result<NamedLogs, Error> {
        // What an estimate records of tables is of tables, and of joint states of joint states.
        let alike = remembered.filter(|inputs| {
            let were_states = !inputs.logs.is_empty() && inputs.logs.iter().all(|log| is_joint_states(Path::new(log)));
            // What a table of TOML says is not overruled where no other log is beside it.
            let is_alike = if were_states { is_joint_states } else { is_table };
            let is_toml = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
            paths.iter().all(|path| is_alike(path) || (!were_states && is_toml(path))) && !paths.iter().all(is_toml)
        });
        let mapping = self.mapping.clone().or_else(|| alike.and_then(|inputs| inputs.mapping.clone()));
        let rate_hz = self.rate_hz.or_else(|| alike.and_then(|inputs| inputs.rate_hz));
        let arm = self.named_robot(paths, remembered)?;
        let robot = arm.as_ref().map(|loaded| &loaded.robot);
        let found = find(paths, mapping.as_deref(), rate_hz, robot, remembered.is_some())?;
        let robot = self.robot_of(&found, remembered)?;
        let paths = paths.iter().map(|path| path.display().to_string()).collect();
        Ok(NamedLogs { found, paths, robot, mapping, rate_hz })
    }

    /// The logs that an estimate was made from, read and processed again, with what it held out; and what it was made from. `moved` is
    /// where the logs are now, if anything.
    ///
    /// # Errors
    /// [`Error`] as [`Self::find`], and where the estimate does not state its logs, or one of its files has changed.
    pub fn again(&self, estimate: &Text, moved: &[PathBuf]) -> Result<(ProcessedLog, Inputs), Error> {
        let Some(inputs) = Inputs::of_estimate(estimate)? else {
            let message = format!("{} does not state which logs it was made from", estimate.name);
            let help = Remedy::task(Task::Identify, "LOG").option(Setting::Output, "E.json");
            return Err(Error::new(message).help(help.say(" states them")));
        };
        let base = self.chain.base.clone().or_else(|| inputs.robot.base_link.clone());
        let tip = self.chain.tip.clone().or_else(|| inputs.robot.tip_link.clone());
        let source = Self { chain: ChainEnds { base, tip }, ..self.clone() };
        let read = |logs: &[PathBuf]| source.find(logs, Some(&inputs))?.process(inputs.settings.clone());
        let logs = if moved.is_empty() { inputs.logs.iter().map(PathBuf::from).collect() } else { moved.to_vec() };
        let (mut prepared, now) = read(&logs)?;
        inputs.check_files(&now.files, &estimate.name)?;
        inputs.check_robot(&prepared.robot, &estimate.name)?;
        if let Some(other) = &inputs.held_out_log {
            prepared.hold_out(&read(&[PathBuf::from(other)])?.0);
        }
        Ok((prepared, inputs))
    }

    /// The robot whose joints are looked for in joint states, where it is named outside of them.
    fn named_robot(&self, paths: &[PathBuf], remembered: Option<&Inputs>) -> Result<Option<LoadedRobot>, Error> {
        if !paths.iter().any(|path| is_joint_states(path)) {
            return Ok(None);
        }
        if let Some(name) = &self.robot {
            return robot::load(name, &self.chain, None).map(Some);
        }
        // A recording may hold its robot: that of the estimate need not be there.
        Ok(remembered.and_then(|inputs| {
            let RobotSource { name, base_link, tip_link, .. } = &inputs.robot;
            robot::load(name.as_deref()?, &ChainEnds { base: base_link.clone(), tip: tip_link.clone() }, None).ok()
        }))
    }

    /// The robot, and what it was called.
    fn robot_of(&self, found: &FoundLogs, remembered: Option<&Inputs>) -> Result<(LoadedRobot, RobotSource), Error> {
        let with_source = |name: Option<String>, loaded: LoadedRobot, chain: &ChainEnds| {
            let sha256 = sha256(&loaded.text.content);
            let (base_link, tip_link) = (chain.base.clone(), chain.tip.clone());
            (loaded, RobotSource { name, sha256, base_link, tip_link })
        };
        if let Some(name) = self.robot.clone().or_else(|| found.robot.clone()) {
            let loaded = robot::load(&name, &self.chain, None)?;
            return Ok(with_source(Some(name), loaded, &self.chain));
        }
        if let Some(log) = found.logs.iter().find(|log| log.robot.is_some()) {
            return Ok(with_source(None, log.robot()?, &self.chain));
        }
        let asked = Remedy::set(Setting::Robot, "ROBOT");
        if let Some(RobotSource { name: Some(name), base_link, tip_link, .. }) = remembered.map(|inputs| &inputs.robot)
        {
            let chain = ChainEnds { base: base_link.clone(), tip: tip_link.clone() };
            let loaded = robot::load(name, &chain, None);
            let loaded =
                loaded.map_err(|error| error.of_an_estimate("the estimate", asked.say(" says where it is now")))?;
            return Ok(with_source(Some(name.clone()), loaded, &chain));
        }
        let name = found.logs.first().map_or("the log", |log| log.name.as_str());
        let help = Remedy::task(Task::Robot, "").say(" lists the bundled ones; ").perform(Task::Init, "arm.urdf");
        let message = format!("{name} does not name its robot, expected {asked}");
        Err(Error::new(message).help(help.say(" makes a robot file of one's own")))
    }
}

impl NamedLogs {
    /// Processes them; and what they are made from.
    ///
    /// # Errors
    /// As [`process_all`].
    pub fn process(self, settings: LogSettings) -> Result<(ProcessedLog, Inputs), Error> {
        let Self { found, paths: logs, robot: (loaded, robot), mapping, rate_hz } = self;
        let names_itself = found.logs.iter().any(|log| log.recording.is_none());
        let files = found.logs.iter().flat_map(|log| log.origin.files.clone()).collect();
        let mapping =
            mapping.filter(|_| names_itself).or_else(|| found.logs.iter().find_map(|log| log.origin.mapping.clone()));
        let mut processed = process_all(found.logs, &loaded, &settings)?;
        processed.closed_loops = Some(armid_sim::closed_loop);
        let rate_hz = rate_hz.filter(|_| names_itself);
        Ok((processed, Inputs { robot, logs, held_out_log: None, files, mapping, rate_hz, settings }))
    }
}
