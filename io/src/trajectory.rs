//! Trajectories: a TOML file, or a name that is compiled in.

use std::path::Path;

use armid::excitation::Certificate;
use armid::model::Robot;
use armid::remedy::{Remedy, Setting, Task};
use armid::study::radkhah2007::table_one;
use armid::trajectory::{PeriodicTrajectory, TrajectoryError};

use crate::error::Error;
use crate::suggestion;
use crate::text::Text;

/// The trajectories that are compiled in: `radkhah2007` Table I, with its misprints corrected and as printed.
const NAMES: [&str; 2] = ["table-one", "table-one-printed"];

/// Reads a trajectory for a robot: a file, or a name that is compiled in. Relative paths begin at `beside`, the folder of
/// the file that names it.
///
/// # Errors
/// [`Error`] where there is no such trajectory, it cannot be read, or it moves other joints than the robot has.
pub fn load(name: &str, beside: Option<&Path>, robot: &Robot) -> Result<PeriodicTrajectory, Error> {
    let path = beside.map_or_else(|| name.into(), |folder| folder.join(name));
    if path.is_file() {
        return parse(&Text::read(&path)?, robot);
    }
    let mut trajectory = match name {
        "table-one" => table_one::corrected(),
        "table-one-printed" => table_one::printed(),
        _ => {
            let error = Error::unknown(format!("trajectory file not found: {}", path.display()));
            let is_file = name.ends_with(".toml");
            let made = || a_design().option(Setting::Output, &path.display().to_string()).say(" makes it");
            return Err(error.help(if is_file { made() } else { suggestion::help(name, &NAMES).into() }));
        }
    };
    if trajectory.joints.len() != robot.dof() {
        let message =
            format!("trajectory \"{name}\" moves 6 joints, expected the {} of \"{}\"", robot.dof(), robot.name());
        let help = a_design().option(Setting::Output, "T.toml").say(" makes one for this robot");
        return Err(Error::mismatch(message).help(help));
    }
    for (moved, joint) in trajectory.joints.iter_mut().zip(robot.joints()) {
        moved.name.clone_from(&joint.name);
    }
    Ok(trajectory.into())
}

fn a_design() -> Remedy {
    Remedy::task(Task::Design, "ROBOT").option(Setting::Criterion, "d-optimal")
}

/// The certificate in a trajectory file; `None` where it has none, or the trajectory is compiled in.
///
/// # Errors
/// [`Error`] where the file or its certificate cannot be read.
pub fn certificate(name: &str, beside: Option<&Path>) -> Result<Option<Certificate>, Error> {
    let path = beside.map_or_else(|| name.into(), |folder| folder.join(name));
    if !path.is_file() {
        return Ok(None);
    }
    let text = Text::read(&path)?;
    Certificate::from_toml(&text.content).map_err(|fault| Error::new(format!("{}: {fault}", text.name)))
}

/// Reads a trajectory from its text; its joints must be the robot's, in the robot's order.
///
/// # Errors
/// [`Error`] with line and column where the text is no trajectory, or it moves other joints.
pub fn parse(text: &Text, robot: &Robot) -> Result<PeriodicTrajectory, Error> {
    let trajectory = PeriodicTrajectory::from_toml(&text.content).map_err(|fault| match fault {
        TrajectoryError::File { line, column, message } => {
            let help = suggestion::from_list_in(&message);
            Error::new(message).at_line(text, line, column).maybe_help(help)
        }
        other => Error::new(format!("{}: {other}", text.name)),
    })?;
    let found = trajectory.names();
    let expected: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    if found == expected {
        return Ok(trajectory);
    }
    let message = format!("{}: found the joints {}, expected {}", text.name, found.join(", "), expected.join(", "));
    let words =
        format!("a trajectory for \"{}\" names its joints in their order from the base outwards; ", robot.name());
    Err(Error::mismatch(message).help(Remedy::from(words).perform(Task::Design, "").say(" makes one")))
}
