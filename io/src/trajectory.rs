//! Trajectories: a TOML file, or a name that is compiled in.

use std::path::Path;

use armid::excitation::Certificate;
use armid::model::Robot;
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
            let made = format!("`armid design ROBOT --criterion d-optimal -o {}` makes it", path.display());
            let near = suggestion::help(name, &NAMES);
            return Err(error.help(if name.ends_with(".toml") { made } else { near }));
        }
    };
    if trajectory.joints.len() != robot.dof() {
        let message =
            format!("trajectory \"{name}\" moves 6 joints, expected the {} of \"{}\"", robot.dof(), robot.name());
        return Err(Error::mismatch(message)
            .help("`armid design ROBOT --criterion d-optimal -o T.toml` makes one for this robot"));
    }
    for (moved, joint) in trajectory.joints.iter_mut().zip(robot.joints()) {
        moved.name.clone_from(&joint.name);
    }
    Ok(trajectory.into())
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
    Certificate::in_toml(&text.content).map_err(|fault| Error::new(format!("{}: {fault}", text.name)))
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
    let help = format!(
        "a trajectory for \"{}\" names its joints in their order from the base outwards; `armid design` makes one",
        robot.name()
    );
    Err(Error::mismatch(message).help(help))
}
