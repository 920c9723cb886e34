//! Which log, of which robot, and how it becomes samples: what `identify` and `validate` share.

use std::path::Path;

use armid::signal::{Derivatives, Processing};
use armid_io::{Error, Log, LogSettings, ProcessedLog};

use super::{ChainArguments, one_of};

/// Which log, of which robot, and how it becomes samples.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LogArguments {
    /// The robot, where the recording does not contain it, or another one
    #[arg(long)]
    robot: Option<String>,
    #[command(flatten)]
    chain: ChainArguments,
    /// Period of a log that does not state it, s; without one the log is processed as aperiodic
    #[arg(long, value_name = "S", help_heading = "Processing")]
    period: Option<f64>,
    /// Seconds to skip at the beginning of a log without phases
    #[arg(long, value_name = "S", default_value_t = 0.0, help_heading = "Processing")]
    skip: f64,
    /// Velocities and accelerations: through Fourier coefficients, or filtered differences
    #[arg(long, default_value = "fourier", value_parser = one_of(&Derivatives::ALL, Derivatives::name), help_heading = "Processing")]
    derivatives: Derivatives,
    /// Cut-off of the low pass ahead of differences; 5 times the highest commanded frequency, at least 10
    #[arg(long, value_name = "HZ", help_heading = "Processing")]
    cutoff_hz: Option<f64>,
    /// Samples of the averaged period that are kept
    #[arg(long, value_name = "N", default_value_t = 250, help_heading = "Processing")]
    samples: usize,
}

impl LogArguments {
    /// Reads a log and processes it.
    pub(crate) fn process(&self, path: &Path) -> Result<ProcessedLog, Error> {
        let log = Log::read(path)?;
        let robot = match &self.robot {
            Some(name) => self.chain.load(name)?,
            None if log.robot.is_none() => {
                let message = format!("{} does not say which robot it is of, expected --robot ROBOT", log.name);
                return Err(Error::new(message));
            }
            None => log.robot()?,
        };
        log.process(robot, &self.settings())
    }

    fn settings(&self) -> LogSettings {
        let (derivatives, cutoff_hz, samples_per_period) = (self.derivatives, self.cutoff_hz, self.samples);
        let processing = Processing { derivatives, cutoff_hz, samples_per_period, ..Processing::default() };
        LogSettings { period_s: self.period, skip_s: self.skip, processing }
    }
}
