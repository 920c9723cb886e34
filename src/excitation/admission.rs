//! May this trajectory move this robot? The last look at a certificate before anything moves.

use super::basis::Quantity;
use super::clearance::{Scene, WorstClearance, smallest_clearance};
use super::limits::{WorstUse, worst_jerk, worst_use};
use super::{Certificate, PeriodicTrajectory};
use crate::model::{JointKind, Robot};
use crate::provenance::sha256;

/// What rounding may add to the use of a limit.
const ROUNDING: f64 = 1e-9;

/// Samples of one period on which the search for the smallest clearance begins.
const CLEARANCE_SAMPLES: usize = 1000;

/// Why a trajectory must not move a robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AdmissionFault {
    /// The trajectory moves another number of joints.
    #[error("the trajectory moves {found} joints, expected the robot's {expected}")]
    Joints {
        /// Joints of the trajectory.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// The certificate was made for another robot file.
    #[error(
        "the certificate is for the robot \"{certified}\" as of file {certified_sha256:.12}…, expected \"{robot}\" as of \
         file {robot_sha256:.12}…"
    )]
    OtherRobot {
        /// Robot of the certificate.
        certified: String,
        /// Hash of its file.
        certified_sha256: String,
        /// The robot at hand.
        robot: String,
        /// Hash of its file.
        robot_sha256: String,
    },
    /// The certificate was made for another trajectory.
    #[error("the certificate is for trajectory {certified:.12}…, expected this one, {found:.12}…")]
    OtherTrajectory {
        /// Hash in the certificate.
        certified: String,
        /// Hash of the trajectory at hand.
        found: String,
    },
    /// A limit is exceeded.
    #[error("joint \"{joint}\": {quantity} {found:.4} {unit} exceeds its limit {limit:.4} {unit} at t = {t:.3} s")]
    Limit {
        /// Name of the joint.
        joint: String,
        /// Which limit.
        quantity: &'static str,
        /// What is asked.
        found: f64,
        /// What is allowed.
        limit: f64,
        /// Unit of both.
        unit: String,
        /// When, s.
        t: f64,
    },
    /// Two bodies would touch.
    #[error("\"{}\" and \"{}\" come within {:.4} m at t = {:.3} s, expected a distance above zero", .0.pair[0], .0.pair[1], .0.distance_m, .0.t)]
    Contact(WorstClearance),
}

/// Checks that a certificate is that of this trajectory and of this robot's file, and that nothing is exceeded:
/// position, velocity, acceleration, jerk and clearance are computed anew from the robot at hand, torque and current
/// are read off the certificate, since they rest on parameters that the robot file does not hold.
///
/// # Errors
/// [`AdmissionFault`] with the first thing that does not fit.
pub fn check(robot: &Robot, trajectory: &PeriodicTrajectory, certificate: &Certificate) -> Result<(), AdmissionFault> {
    if trajectory.dof() != robot.dof() {
        return Err(AdmissionFault::Joints { found: trajectory.dof(), expected: robot.dof() });
    }
    if certificate.robot != robot.name() || certificate.robot_sha256 != robot.source_sha256() {
        return Err(AdmissionFault::OtherRobot {
            certified: certificate.robot.clone(),
            certified_sha256: certificate.robot_sha256.clone(),
            robot: robot.name().to_owned(),
            robot_sha256: robot.source_sha256().to_owned(),
        });
    }
    let found = sha256(&trajectory.to_toml());
    if certificate.trajectory_sha256 != found {
        let certified = certificate.trajectory_sha256.clone();
        return Err(AdmissionFault::OtherTrajectory { certified, found });
    }
    let [position, velocity, acceleration] = Quantity::ALL.map(|quantity| worst_use(robot, trajectory, quantity));
    let worst = &certificate.worst;
    let uses: [(&'static str, &str, Option<WorstUse>); 8] = [
        ("position", "", Some(position)),
        ("velocity", "/s", Some(velocity)),
        ("acceleration", "/s²", Some(acceleration)),
        ("jerk", "/s³", worst_jerk(robot, trajectory)),
        ("torque", "", worst.torque),
        ("RMS torque", "", worst.torque_rms),
        ("current", "A", worst.current),
        ("RMS current", "A", worst.current_rms),
    ];
    for (quantity, suffix, worst) in uses {
        let Some(WorstUse { joint, value: found, limit, t, .. }) = worst.filter(|worst| worst.ratio > 1.0 + ROUNDING)
        else {
            continue;
        };
        let kind = robot.joints().get(joint).map_or(JointKind::Revolute, |joint| joint.kind);
        let unit = match quantity {
            "torque" | "RMS torque" => kind.effort_unit().to_owned(),
            "current" | "RMS current" => suffix.to_owned(),
            _ => format!("{}{suffix}", kind.unit()),
        };
        let joint = robot.joints().get(joint).map_or_else(String::new, |joint| joint.name.clone());
        return Err(AdmissionFault::Limit { joint, quantity, found, limit, unit, t });
    }
    let accelerations: Vec<f64> = (0..robot.dof())
        .map(|j| {
            let curve = trajectory.curve(j, Quantity::Acceleration);
            curve.maximum().value.max(-curve.minimum().value)
        })
        .collect();
    match smallest_clearance(&mut Scene::new(robot), trajectory, &accelerations, CLEARANCE_SAMPLES) {
        Some(nearest) if nearest.distance_m < 0.0 => Err(AdmissionFault::Contact(nearest)),
        _ => Ok(()),
    }
}
