//! What identification reads: a log of positions and efforts from any recorder.

use std::collections::BTreeMap;

use armid::estimation::PositionServo;
use armid::experiment::Recording;
use armid::model::EffortInterface;
use armid::model::format::ChainEnds;
use armid::remedy::{Remedy, Setting, Task};

use super::conversion::Conversion;
use super::origin::Origin;
use crate::error::Error;
use crate::robot::LoadedRobot;

/// Samples of a log without a break.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Time of the first, since the beginning of the log, s.
    pub start_s: f64,
    /// How many there are.
    pub samples: usize,
}

/// Positions and efforts of some joints at a constant rate.
#[derive(Clone, Debug)]
pub struct Log {
    /// The file.
    pub name: String,
    /// Names of the joints, where the file has them.
    pub joints: Option<Vec<String>>,
    /// Number of joints n.
    pub dof: usize,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// What the efforts are; `None` where the file does not say and the robot decides.
    pub effort_unit: Option<EffortInterface>,
    /// Joint coordinates, rad (m); N × n.
    pub q: Vec<f64>,
    /// Measured velocities, rad/s (m/s); N × n, where the file has them.
    pub qd: Option<Vec<f64>>,
    /// Measured positions behind the transmissions, rad (m); N × n, where the file has them beside those of the motors.
    pub link_q: Option<Vec<f64>>,
    /// Efforts, A or N·m (N); N × n.
    pub effort: Vec<f64>,
    /// Which samples give no equation of which joint, N × n; empty where all do.
    pub excluded: Vec<bool>,
    /// The segments without a break that the samples come in, one after the other.
    pub segments: Vec<Segment>,
    /// The robot that was recorded, where the file holds it.
    pub robot: Option<RecordedRobot>,
    /// The experiment, where armid performed it.
    pub recording: Option<Recording>,
    /// The servos that made the efforts of commanded positions.
    pub servo: Option<PositionServo>,
    /// Further notes of an armid recording, as texts.
    pub notes: BTreeMap<String, String>,
    /// Whether the file is whole.
    pub complete: bool,
    /// What is to be done to the values once the robot is known.
    pub(crate) conversion: Conversion,
    /// Where it came from, and what was found in it.
    pub origin: Origin,
}

/// The robot as a recording holds it: texts.
#[derive(Clone, Debug, Default)]
pub struct RecordedRobot {
    /// Its file.
    pub text: String,
    /// What an experimenter would guess, where there was such a file.
    pub nominal: Option<String>,
    /// The chain that was chosen in a tree.
    pub chain: ChainEnds,
}

impl Log {
    /// The robot that the recording holds.
    ///
    /// # Errors
    /// [`Error`] where it holds none, or one that cannot be read.
    pub fn robot(&self) -> Result<LoadedRobot, Error> {
        match &self.robot {
            Some(RecordedRobot { text, nominal, chain }) => {
                LoadedRobot::recorded(&self.name, text, nominal.as_deref(), chain)
            }
            None => {
                let help = Remedy::default().setting(Setting::Robot).say(" names it; ").perform(Task::Robot, "");
                let help =
                    help.say(" lists the bundled ones, ").perform(Task::Init, "arm.urdf").say(" begins one's own");
                Err(Error::unknown(format!("{} does not name its robot", self.name)).help(help))
            }
        }
    }

    /// The experiment with its plan.
    ///
    /// # Errors
    /// [`Error`] where something else than armid recorded it.
    pub fn into_recording(self) -> Result<Recording, Error> {
        let name = self.name;
        self.recording.ok_or_else(|| {
            Error::new(format!("{name} was not recorded by armid, expected a recording with its plan"))
                .help(Remedy::task(Task::Run, "EXPERIMENT").option(Setting::Output, "R.mcap").say(" makes one"))
        })
    }
}
