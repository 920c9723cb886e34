//! Which logs, of which robot, and how they become samples: what `identify` and `validate` share.

use std::path::{Path, PathBuf};

use armid::estimation::DEFAULT_BANDWIDTH_HZ;
use armid::model::EffortInterface;
use armid::provenance::sha256;
use armid::signal::{Derivatives, Processing};
use armid_io::inputs::RobotSource;
use armid_io::log::{FoundLogs, HeldOut, find, is_joint_states, is_table, process_all};
use armid_io::{Error, Inputs, LoadedRobot, LogSettings, ProcessedLog, Text};

use super::{ChainArguments, one_of};

/// What helps where an estimate names a robot file that is not there.
const WHERE_IT_IS: &str = "--robot ROBOT of `armid identify`, `validate`, `report` and `export` says where it is now";

/// The period of a motion, as it is stated.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Period {
    /// None: the motion does not repeat.
    None,
    /// Of so many seconds.
    Seconds(f64),
}

/// Reads the period of a motion.
fn period(text: &str) -> Result<Period, String> {
    match text.parse() {
        _ if text == "none" => Ok(Period::None),
        Ok(seconds) => Ok(Period::Seconds(seconds)),
        Err(_) => Err("expected seconds, or none".to_owned()),
    }
}

/// Which logs, of which robot, and how they become samples.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct LogArguments {
    /// The robot, where the recording does not contain it, or another one
    #[arg(long)]
    robot: Option<String>,
    #[command(flatten)]
    chain: ChainArguments,
    /// What the columns of a table are: "t=time_ms ms, q=joint_[1-6] deg, current=i_[1-6] mA". Keys t, q, qd, tau, current;
    /// headings with [1-6] or [01-06] for the joints, or #2 for the second column, several with / between them (#1/#3/#2),
    /// - for a torque that is left out, `file:heading` for files side by side, with * for what those of one log share; then unit, motor, gear=, sign=, offset_deg=, constant= (N·m/A), rated= (of %),
    /// values of each joint with / between them. Of joint states of ROS 2 the names of joints take the place of headings,
    /// without t, and topic=/arm/joint_states, alone or in front, says which are meant
    #[arg(long, value_name = "COLUMNS", help_heading = "Logs")]
    map: Option<String>,
    /// Rows per second of a table without a column of times
    #[arg(long, value_name = "HZ", help_heading = "Logs")]
    rate: Option<f64>,
    /// Kind of efforts, where the log does not state it; otherwise as in the robot file
    #[arg(long, value_parser = one_of(&EffortInterface::ALL, EffortInterface::name), help_heading = "Logs")]
    effort: Option<EffortInterface>,
    /// Time from which a log is used, s; with periods, found in the log by default
    #[arg(long, visible_alias = "skip", value_name = "S", help_heading = "Logs")]
    from: Option<f64>,
    /// Time up to which a log is used, s
    #[arg(long, value_name = "S", help_heading = "Logs")]
    until: Option<f64>,
    /// Take velocities as measured (qd) instead of from the positions
    #[arg(long, help_heading = "Processing")]
    measured_velocity: bool,
    /// Period of the motion, s, or none for an aperiodic log; found in the log by default
    #[arg(long, value_name = "S|none", value_parser = period, help_heading = "Processing")]
    period: Option<Period>,
    /// Velocities and accelerations: through Fourier coefficients (the default), or filtered differences
    #[arg(long, value_parser = one_of(&Derivatives::ALL, Derivatives::name), help_heading = "Processing")]
    derivatives: Option<Derivatives>,
    /// Highest frequency kept of the positions; found in the log by default
    #[arg(long, value_name = "HZ", help_heading = "Processing")]
    cutoff_hz: Option<f64>,
    /// Leave out equations of a joint slower than this share of its top speed, 0.02 by default; 0 keeps all
    #[arg(long, value_name = "SHARE", help_heading = "Processing")]
    reversal_fraction: Option<f64>,
    /// Samples of the averaged period that are kept, 250 by default
    #[arg(long, value_name = "N", help_heading = "Processing")]
    samples: Option<usize>,
    /// Cut-off of the low pass through which measured and predicted torque are compared, 20 by default
    #[arg(long, value_name = "HZ", help_heading = "Processing")]
    bandwidth_hz: Option<f64>,
}

impl LogArguments {
    /// Nothing but the robot, where it is another than what is remembered.
    pub(crate) fn of_robot(robot: Option<String>, chain: ChainArguments) -> Self {
        Self { robot, chain, ..Self::default() }
    }

    /// A model file, whose chain is the one that is asked for.
    pub(crate) fn model(&self, name: &str) -> Result<LoadedRobot, Error> {
        self.chain.load(name)
    }

    /// The same logs of this robot, unless another is named.
    pub(crate) fn with_robot(mut self, robot: &str) -> Self {
        self.robot.get_or_insert_with(|| robot.to_owned());
        self
    }

    /// Reads logs and processes them. What was not said is as `remembered` has it: what an estimate was made with; `exactly`
    /// are settings that hold in any case.
    pub(crate) fn process(
        &self,
        paths: &[PathBuf],
        remembered: Option<&Inputs>,
        held_out: HeldOut,
        exactly: Option<&LogSettings>,
    ) -> Result<(ProcessedLog, Inputs), Error> {
        // What an estimate records of tables is of tables, and of joint states of joint states.
        let alike = remembered.filter(|inputs| {
            let were_states = !inputs.logs.is_empty() && inputs.logs.iter().all(|log| is_joint_states(Path::new(log)));
            // What a table of TOML says is not overruled where no other log is beside it.
            let is_alike = if were_states { is_joint_states } else { is_table };
            let is_toml = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
            paths.iter().all(|path| is_alike(path) || (!were_states && is_toml(path))) && !paths.iter().all(is_toml)
        });
        let mapping = self.map.clone().or_else(|| alike.and_then(|inputs| inputs.mapping.clone()));
        let rate_hz = self.rate.or_else(|| alike.and_then(|inputs| inputs.rate_hz));
        let arm = self.named_robot(paths, remembered)?;
        let robot = arm.as_ref().map(|loaded| &loaded.robot);
        let found = find(paths, mapping.as_deref(), rate_hz, robot, remembered.is_some())?;
        self.refuse_mapping_of_recordings(&found)?;
        let (robot, source) = self.robot(&found, remembered)?;
        let settings = match exactly {
            Some(settings) => settings.clone(),
            None => self.settings(&found, remembered, held_out)?,
        };
        let names_itself = found.logs.iter().any(|log| log.recording.is_none());
        let files = found.logs.iter().flat_map(|log| log.origin.files.clone()).collect();
        let mapping =
            mapping.filter(|_| names_itself).or_else(|| found.logs.iter().find_map(|log| log.origin.mapping.clone()));
        let mut prepared = process_all(found.logs, &robot, &settings)?;
        prepared.closed_loops = Some(armid_sim::closed_loop);
        let rate_hz = rate_hz.filter(|_| names_itself);
        let logs = paths.iter().map(|path| path.display().to_string()).collect();
        Ok((prepared, Inputs { robot: source, logs, held_out_log: None, files, mapping, rate_hz, settings }))
    }

    /// The logs that an estimate was made from, read and processed again, with what it held out; and what it was made from. `moved` is
    /// where the logs are now, if anything.
    pub(crate) fn again(&self, estimate: &Text, moved: &[PathBuf]) -> Result<(ProcessedLog, Inputs), Error> {
        let Some(inputs) = Inputs::of_estimate(estimate)? else {
            let message = format!("{} does not state which logs it was made from", estimate.name);
            return Err(Error::new(message).help("identify again, with -o"));
        };
        let base_link = self.chain.base_link.clone().or_else(|| inputs.robot.base_link.clone());
        let tip_link = self.chain.tip_link.clone().or_else(|| inputs.robot.tip_link.clone());
        let arguments = Self::of_robot(self.robot.clone(), ChainArguments { base_link, tip_link });
        let settings = &inputs.settings;
        let read = |logs: &[PathBuf]| arguments.process(logs, Some(&inputs), settings.held_out, Some(settings));
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
            return self.chain.load(name).map(Some);
        }
        // A recording may hold its robot: that of the estimate need not be there.
        Ok(remembered.and_then(|inputs| {
            let RobotSource { name, base_link, tip_link, .. } = &inputs.robot;
            let chain = ChainArguments { base_link: base_link.clone(), tip_link: tip_link.clone() };
            chain.load(name.as_deref()?).ok()
        }))
    }

    /// A recording of armid's own says itself what it holds.
    fn refuse_mapping_of_recordings(&self, found: &FoundLogs) -> Result<(), Error> {
        let Some(log) = found.logs.iter().find(|log| log.recording.is_some()) else { return Ok(()) };
        let (option, states) = match (&self.map, self.rate) {
            (Some(_), _) => ("--map", "what its columns are"),
            (None, Some(_)) => ("--rate", "its rate"),
            (None, None) => return Ok(()),
        };
        let message = format!("{} is a recording of `armid run`, which states {states}, found {option}", log.name);
        Err(Error::mismatch(message).help(format!("leave out {option}: it is of logs of other tools")))
    }

    /// The robot, and what it was called.
    fn robot(&self, found: &FoundLogs, remembered: Option<&Inputs>) -> Result<(LoadedRobot, RobotSource), Error> {
        let said = self.robot.clone().or_else(|| found.robot.clone());
        let of = |name: Option<String>, loaded: &LoadedRobot, chain: &ChainArguments| RobotSource {
            name,
            sha256: sha256(&loaded.text.content),
            base_link: chain.base_link.clone(),
            tip_link: chain.tip_link.clone(),
        };
        if let Some(name) = said {
            let loaded = self.chain.load(&name)?;
            let source = of(Some(name), &loaded, &self.chain);
            return Ok((loaded, source));
        }
        if let Some(log) = found.logs.iter().find(|log| log.robot.is_some()) {
            let loaded = log.robot()?;
            let source = of(None, &loaded, &self.chain);
            return Ok((loaded, source));
        }
        match remembered.map(|inputs| &inputs.robot) {
            Some(RobotSource { name: Some(name), base_link, tip_link, .. }) => {
                let chain = ChainArguments { base_link: base_link.clone(), tip_link: tip_link.clone() };
                let loaded = chain.load(name).map_err(|error| error.of_an_estimate("the estimate", WHERE_IT_IS))?;
                let source = of(Some(name.clone()), &loaded, &chain);
                Ok((loaded, source))
            }
            _ => {
                let name = found.logs.first().map_or("the log", |log| log.name.as_str());
                let message = format!("{name} does not name its robot, expected --robot ROBOT");
                Err(Error::new(message).help(
                    "`armid robot` lists the bundled ones; `armid init arm.urdf` makes a robot file of one's own",
                ))
            }
        }
    }

    fn settings(
        &self,
        found: &FoundLogs,
        remembered: Option<&Inputs>,
        held_out: HeldOut,
    ) -> Result<LogSettings, Error> {
        let before = remembered.map(|inputs| inputs.settings.clone()).unwrap_or_default();
        let processing = Processing {
            derivatives: self.derivatives.unwrap_or(before.processing.derivatives),
            cutoff_hz: self.cutoff_hz.or(before.processing.cutoff_hz),
            reversal_fraction: self.reversal_fraction.unwrap_or(before.processing.reversal_fraction),
            samples_per_period: self.samples.unwrap_or(before.processing.samples_per_period),
            ..before.processing
        };
        let bandwidth_hz = self.bandwidth_hz.unwrap_or(before.bandwidth_hz);
        if !(bandwidth_hz.is_finite() && bandwidth_hz > 0.0) {
            return Err(Error::new(format!("--bandwidth-hz is {bandwidth_hz}, expected a number above zero")));
        }
        // A recording of armid's own states its period, which takes precedence over that of an estimate.
        let foreign = found.logs.iter().any(|log| log.recording.is_none());
        let stated = match self.period {
            Some(Period::Seconds(seconds)) => Some(seconds),
            Some(Period::None) => None,
            None => found.period_s,
        };
        let is_remembered = self.period.is_none() && found.period_s.is_none() && foreign && before.period_s.is_some();
        let period_s = if is_remembered { before.period_s } else { stated };
        // An estimate that was made without a search is tested without one.
        let finds_period = match self.period {
            Some(Period::None) => false,
            Some(Period::Seconds(_)) => true,
            None => remembered.is_none() || before.finds_period,
        };
        if self.samples.is_some() && foreign && period_s.is_none() && !finds_period {
            let message = "--samples is of an averaged period, found a log without a period";
            return Err(Error::new(message).help("--cutoff-hz F gives a log without periods 4 F equations a second"));
        }
        Ok(LogSettings {
            period_s,
            finds_period,
            // A period is remembered with the time from which it repeats.
            from_s: self.from.or(found.part_s.0).unwrap_or(if is_remembered { before.from_s } else { 0.0 }),
            until_s: self.until.or(found.part_s.1),
            held_out,
            measured_velocity: self.measured_velocity || (foreign && before.measured_velocity),
            effort: self.effort.or(before.effort),
            bandwidth_hz,
            processing,
        })
    }
}

const _: () = assert!(DEFAULT_BANDWIDTH_HZ == 20.0, "the help text of --bandwidth-hz says it");
