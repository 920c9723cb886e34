//! The joints of a log in the order of a robot's.

use armid::model::Robot;
use armid::remedy::{Remedy, Setting, Task};

use super::joint_log::Log;
use crate::error::Error;

/// What brings log and robot together.
pub(super) fn help() -> Remedy {
    let help = Remedy::task(Task::Robot, "ROBOT").say(" shows the joints of the robot, ").setting(Setting::Robot);
    let help = help.say(" names another; ").assign(Setting::Map, "q=…, tau=…");
    help.say(" says which columns of a table, or which joints of joint states, they are")
}

/// The log with the robot's joints in the robot's order; joints of other things, a gripper's, are left out.
pub(super) fn arranged(mut log: Log, robot: &Robot) -> Result<Log, Error> {
    let expected: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    let Some(joints) = &log.joints else {
        if log.dof == robot.dof() {
            return Ok(log);
        }
        let (found, expected) = (log.dof, robot.dof());
        let message =
            format!("{} holds {found} joints, expected the {expected} of robot \"{}\"", log.name, robot.name());
        return Err(Error::mismatch(message).help(help()));
    };
    if *joints == expected {
        return Ok(log);
    }
    let order: Option<Vec<usize>> = expected.iter().map(|name| joints.iter().position(|found| found == name)).collect();
    let Some(order) = order.filter(|_| log.recording.is_none()) else {
        let (found, expected) = (joints.join(", "), expected.join(", "));
        let message =
            format!("{} holds the joints {found}, expected {expected} of robot \"{}\"", log.name, robot.name());
        return Err(Error::mismatch(message).help(help()));
    };
    let pick = |table: &[f64]| -> Vec<f64> {
        table.chunks_exact(joints.len()).flat_map(|row| order.iter().map(|&joint| row[joint])).collect()
    };
    (log.q, log.effort) = (pick(&log.q), pick(&log.effort));
    log.qd = log.qd.as_deref().map(pick);
    log.link_q = log.link_q.as_deref().map(pick);
    if let Some(servo) = &mut log.servo {
        *servo = servo.of_joints(&order);
    }
    if !log.excluded.is_empty() {
        let rows = log.excluded.chunks_exact(joints.len());
        log.excluded = rows.flat_map(|row| order.iter().map(|&joint| row[joint]).collect::<Vec<_>>()).collect();
    }
    log.dof = robot.dof();
    log.joints = Some(expected.into_iter().map(str::to_owned).collect());
    Ok(log)
}
