//! Which logs, of which robot, and how they become samples: what `identify` and `validate` share.

use std::path::PathBuf;

use armid::estimation::DEFAULT_BANDWIDTH_HZ;
use armid::model::EffortInterface;
use armid::signal::{Derivatives, Processing, TorqueFilter};
use armid_io::log::{FoundLogs, HeldOut};
use armid_io::{Error, Inputs, LoadedRobot, LogSettings, ProcessedLog};
use armid_workflow::LogSource;

use super::{ChainArguments, one_of};

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
    pub(crate) chain: ChainArguments,
    /// Whether terms are chosen from what the logs show.
    #[arg(skip)]
    selects: bool,
    /// Columns and units: "t=time ms, q=q_[1-6] deg"; see `armid help map`
    #[arg(long, value_name = "COLUMNS", help_heading = "Logs")]
    map: Option<String>,
    /// Rows per second of a table without a column of times
    #[arg(long, value_name = "HZ", help_heading = "Logs")]
    rate: Option<f64>,
    /// Kind of efforts, if the log does not state it
    #[arg(long, value_parser = one_of(&EffortInterface::ALL, EffortInterface::name), help_heading = "Logs")]
    effort: Option<EffortInterface>,
    /// Start of the part that is used, s
    #[arg(long, visible_alias = "skip", value_name = "S", help_heading = "Logs")]
    from: Option<f64>,
    /// End of the part that is used, s
    #[arg(long, value_name = "S", help_heading = "Logs")]
    until: Option<f64>,
    /// Take velocities as measured (qd) instead of from the positions
    #[arg(long, help_heading = "Processing")]
    measured_velocity: bool,
    /// Period of the motion, s, or none [default: found in the log]
    #[arg(long, value_name = "S|none", value_parser = period, help_heading = "Processing")]
    period: Option<Period>,
    /// How velocities and accelerations are computed [default: fourier]
    #[arg(long, value_parser = one_of(&Derivatives::ALL, Derivatives::name), help_heading = "Processing")]
    derivatives: Option<Derivatives>,
    /// Highest frequency kept of positions [default: found in the log]
    #[arg(long, value_name = "HZ", help_heading = "Processing")]
    cutoff_hz: Option<f64>,
    /// Leave out rows slower than this share of top speed [default: 0.02]
    #[arg(long, value_name = "SHARE", help_heading = "Processing")]
    reversal_fraction: Option<f64>,
    /// Samples kept of the averaged period [default: 250]
    #[arg(long, value_name = "N", help_heading = "Processing")]
    samples: Option<usize>,
    /// Low pass on both sides of the equations [default: none]
    #[arg(long, value_parser = one_of(&TorqueFilter::ALL, TorqueFilter::name), help_heading = "Processing")]
    torque_filter: Option<TorqueFilter>,
    /// Cut-off of the low pass on torques [default: 20]
    #[arg(long, value_name = "HZ", help_heading = "Processing")]
    bandwidth_hz: Option<f64>,
}

impl LogArguments {
    /// A model file, whose chain is the one that is asked for.
    pub(crate) fn model(&self, name: &str) -> Result<LoadedRobot, Error> {
        self.chain.load(name)
    }

    /// Logs of this robot, with what their columns are and how many rows they have per second.
    pub(crate) fn of_table(robot: String, map: Option<String>, rate: Option<f64>) -> Self {
        Self { robot: Some(robot), map, rate, ..Self::default() }
    }

    /// These logs of this robot, unless another is named.
    pub(crate) fn with_robot(mut self, robot: &str) -> Self {
        self.robot.get_or_insert_with(|| robot.to_owned());
        self
    }

    /// These logs, with this low pass on torques.
    pub(crate) fn with_torque_filter(self, filter: TorqueFilter) -> Self {
        Self { torque_filter: Some(filter), ..self }
    }

    /// These logs, to choose terms from them.
    pub(crate) fn for_selection(&self) -> Self {
        Self { selects: true, ..self.clone() }
    }

    /// Reads logs and processes them. What was not said is as `remembered` has it: what an estimate was made with.
    pub(crate) fn process(
        &self,
        paths: &[PathBuf],
        remembered: Option<&Inputs>,
        held_out: HeldOut,
    ) -> Result<(ProcessedLog, Inputs), Error> {
        let (robot, mapping) = (self.robot.clone(), self.map.clone());
        let source = LogSource { robot, chain: self.chain.ends(), mapping, rate_hz: self.rate };
        let named = source.find(paths, remembered)?;
        self.refuse_mapping_of_recordings(&named.found)?;
        let settings = self.settings(&named.found, remembered, held_out)?;
        named.process(if self.selects { settings.for_selection() } else { settings })
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
            torque_filter: self.torque_filter.unwrap_or(before.processing.torque_filter),
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
