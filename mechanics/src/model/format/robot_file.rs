//! `robot.toml`: kinematics by a Denavit–Hartenberg table or by a URDF, and what the arm has beside them.

use super::dh_robot::read_dh_robot;
use super::embedded_urdf::named_urdf;
use super::error::FormatError;
use super::robot_model::RobotModel;
use super::urdf_robot::read_urdf_robot;
use crate::model::robot::Robot;

/// Reads a `robot.toml`.
///
/// Angles and speeds are in the units that their keys name, and SI inside. A limit that is not given is infinite, a
/// joint without a `drive` has [`Drive::ideal`](crate::model::Drive::ideal). Where the effort interface is `torque`, the
/// torque constant may be left out; it is then 1 / gear, so that the effort passes through the drive unchanged.
///
/// # Errors
/// [`FormatError`] with line and column: an unknown or missing key, a list of the wrong length, a number that is not
/// finite, a gear that is not positive, limits that are reversed, a link that does not exist, a singular coupling.
pub fn parse_robot(text: &str) -> Result<Robot, FormatError> {
    parse_robot_model(text).map(|model| model.robot)
}

/// Reads a `robot.toml` with the parameters that it states.
///
/// A file that says `urdf = "arm.urdf"` takes kinematics, limits, inertias, damping and friction from there; its own keys
/// add to them, or take their place. The text must hold that file: [`embed_urdf`](super::embed_urdf) puts it there.
///
/// # Errors
/// As [`parse_robot`]; a URDF that the text does not hold, or that cannot be read.
pub fn parse_robot_model(text: &str) -> Result<RobotModel, FormatError> {
    if named_urdf(text)?.is_some() {
        return read_urdf_robot(text);
    }
    let robot = read_dh_robot(text)?;
    Ok(RobotModel { robot, parameters: None, locked: Vec::new(), collisions: Vec::new(), remarks: Vec::new() })
}
