//! Every decoder that bytes from outside reach, one function per kind of file: what the fuzz targets call.
//!
//! A decoder may refuse anything and must never panic, hang or ask for more memory than its input explains. Where it
//! accepts, writing what it read and reading that again must give the same.

use std::path::Path;

use armid::cdr::{FloatArray, JointState, decode, encode};
use armid::model::format::{parse_nominal, parse_parameter_map, parse_parameters, parse_robot};
use armid::model::{Robot, bundled};
use armid::study::StudyPlan;
use armid::trajectory::PeriodicTrajectory;
use armid_hardware::message::{
    Float64MultiArray, FollowFeedback, FollowGoal, FollowResult, JointState as WireState, JointTrajectory, Text as Word,
};
use armid_io::log::{parse_csv, parse_mcap};
use armid_io::table::{Third, parse_states};
use armid_io::{Text, experiment};

/// CDR: the ROS 2 messages of recordings and of the wire.
///
/// # Panics
/// Where a message that was read is not the same after writing and reading: a fault that fuzzing looks for.
pub fn cdr(bytes: &[u8]) {
    let _ = FloatArray::decode(bytes);
    if let Ok(state) = JointState::decode(bytes) {
        let written = state.encode().expect("what was read has lists that can be written");
        let again = JointState::decode(&written).and_then(|state| state.encode());
        assert_eq!(again.as_deref(), Ok(written.as_slice()), "a message changes when it is written and read");
    }
    // Bytes, not messages, are compared: a number that is none equals nothing.
    macro_rules! there_and_back {
        ($($message:ty),*) => {$(
            if let Ok(message) = decode::<$message>(bytes) {
                let written = encode(&message).expect("what was read has lists that can be written");
                let again = decode::<$message>(&written).and_then(|message| encode(&message));
                assert_eq!(again, Ok(written), "a message changes when it is written and read");
            }
        )*};
    }
    there_and_back!(WireState, JointTrajectory, FollowGoal, FollowFeedback, FollowResult, Float64MultiArray, Word);
}

/// MCAP: a recording, cut off or not, and the robot that it holds.
pub fn mcap(bytes: &[u8]) {
    if let Ok(log) = parse_mcap(Path::new("fuzz.mcap.part"), bytes)
        && log.robot.is_some()
    {
        let _ = log.robot();
    }
}

/// TOML: robots, parameters, trajectories, studies, experiments.
///
/// # Panics
/// Where a trajectory that was read is not the same after writing and reading: a fault that fuzzing looks for.
pub fn toml(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let robot = robot();
    let _ = parse_robot(text);
    let _ = parse_parameters(text, &robot, true);
    let _ = parse_nominal(text, &robot);
    let _ = parse_parameter_map(text, &robot);
    let _ = StudyPlan::from_toml(text);
    let _ = experiment::parse(Text::new("fuzz.toml", text), None);
    if let Ok(trajectory) = PeriodicTrajectory::from_toml(text) {
        let again = PeriodicTrajectory::from_toml(&trajectory.to_toml());
        assert_eq!(again.ok(), Some(trajectory), "a trajectory changes when it is written and read");
    }
}

/// CSV: recordings and states.
pub fn csv(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = parse_csv(Text::new("fuzz.csv", text));
    for third in [Third::Acceleration, Third::Effort] {
        let _ = parse_states(Text::new("fuzz.csv", text), 2, third);
    }
}

/// The smallest bundled robot, for files that are about one.
fn robot() -> Robot {
    let smallest = bundled().iter().min_by_key(|entry| entry.robot.len()).expect("robots are compiled in");
    parse_robot(smallest.robot).expect("a bundled robot can be read")
}
