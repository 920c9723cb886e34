//! Robots for this module's tests.

use crate::model::format::{parse_nominal, parse_robot};
use crate::model::{Limits, Robot, StandardParameters, bundled};

/// The same robot with one set of limits on every joint.
pub(crate) fn with_limits(robot: &Robot, limits: Limits) -> Robot {
    robot.clone().with_joints(|joint| joint.limits = limits).unwrap()
}

/// The CRS A460 with 12.566 rad/s² on every joint, the limits of the published comparisons.
pub(crate) fn crs_a460() -> Robot {
    let robot = parse_robot(bundled()[0].robot).unwrap();
    robot.with_joints(|joint| joint.limits.acceleration = 12.566).unwrap()
}

/// What an experimenter would guess of its parameters.
pub(crate) fn crs_a460_nominal() -> StandardParameters {
    parse_nominal(bundled()[0].nominal, &crs_a460()).unwrap().parameters
}
