//! May this trajectory move this robot? The last look at a certificate before anything moves.

use super::clearance::WorstClearance;
use super::course::Course;
use super::effort::EffortModel;
use super::limit_survey::{LimitSurvey, WorstCases, WorstLimitUse};
use super::limits::WorstUse;
use super::{Certificate, PeriodicTrajectory};
use crate::model::{JointKind, Robot};
use crate::provenance::sha256;

/// What rounding may add to the use of a limit.
const ROUNDING: f64 = 1e-9;

/// How far a use that is computed anew may be from the one that the certificate states, of the limit.
const AGREEMENT: f64 = 1e-6;

/// Samples of a period, at least and at most, whatever a certificate asks for.
const SAMPLES: (usize, usize) = (500, 100_000);

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
    /// The certificate is not as it was when it was made.
    #[error("the certificate has been changed since it was made")]
    Changed,
    /// The certificate was made with other nominal parameters.
    #[error("the certificate is for nominal parameters {certified:.12}…, expected those at hand, {found:.12}…")]
    OtherParameters {
        /// Hash in the certificate.
        certified: String,
        /// Hash of the parameters at hand.
        found: String,
    },
    /// The certificate states another use of a limit than is found with the limits and parameters at hand.
    #[error(
        "the certificate states {stated:.6} as the use of the {quantity} limit, expected {found:.6} by the nominal parameters at hand"
    )]
    Stale {
        /// Which limit.
        quantity: &'static str,
        /// What the certificate states, 1 at the limit.
        stated: f64,
        /// What is found.
        found: f64,
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

/// Checks that a certificate is that of this trajectory and of this robot's file, that nobody has changed it, and that
/// no limit is exceeded: all of them are computed anew. Torque and current are by the parameters in `efforts`, with the
/// certificate's own number of standard deviations as their multiple; without `efforts` they are read off the
/// certificate.
///
/// # Errors
/// [`AdmissionFault`] with the first thing that does not fit.
pub fn check(
    robot: &Robot,
    trajectory: &PeriodicTrajectory,
    certificate: &Certificate,
    efforts: Option<&mut EffortModel>,
) -> Result<(), AdmissionFault> {
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
    if !certificate.is_unchanged() {
        return Err(AdmissionFault::Changed);
    }
    // Where the certificate has no torque, the design was not to hold it.
    let efforts = efforts.filter(|_| certificate.nominal_sha256.is_some());
    let are_read = efforts.is_none();
    let parameters = efforts.as_ref().map(|model| model.parameters_sha256());
    let course = Course { period_s: trajectory.period_s(), ramp_s: certificate.ramp_s };
    let samples = certificate.samples.clamp(SAMPLES.0, SAMPLES.1);
    let LimitSurvey { mut used, mut worst } = LimitSurvey::of(robot, trajectory, course, samples, efforts);
    if are_read {
        let (stated, certified) = (&certificate.worst_limit_use, &certificate.worst);
        (used.torque, worst.torque) = (stated.torque, certified.torque);
        (used.torque_rms, worst.torque_rms) = (stated.torque_rms, certified.torque_rms);
        (used.current, worst.current) = (stated.current, certified.current);
        (used.current_rms, worst.current_rms) = (stated.current_rms, certified.current_rms);
    }
    exceeded(robot, &worst)?;
    if let (Some(certified), Some(found)) = (&certificate.nominal_sha256, parameters)
        && *certified != found
    {
        return Err(AdmissionFault::OtherParameters { certified: certified.clone(), found });
    }
    same(&certificate.worst_limit_use, &used)
}

/// Nothing may be beyond its limit.
fn exceeded(robot: &Robot, worst: &WorstCases) -> Result<(), AdmissionFault> {
    let uses: [(&'static str, &str, Option<WorstUse>); 8] = [
        ("position", "", Some(worst.position)),
        ("velocity", "/s", Some(worst.velocity)),
        ("acceleration", "/s²", Some(worst.acceleration)),
        ("jerk", "/s³", worst.jerk),
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
    match &worst.clearance {
        Some(nearest) if nearest.distance_m < 0.0 => Err(AdmissionFault::Contact(nearest.clone())),
        _ => Ok(()),
    }
}

/// The use of torque and current that the certificate states must be what is found: else it is of other parameters. The
/// limits of motion may be others than those it was designed for, as long as they hold.
fn same(stated: &WorstLimitUse, found: &WorstLimitUse) -> Result<(), AdmissionFault> {
    let uses = [
        ("torque", stated.torque, found.torque),
        ("RMS torque", stated.torque_rms, found.torque_rms),
        ("current", stated.current, found.current),
        ("RMS current", stated.current_rms, found.current_rms),
    ];
    for (quantity, stated, found) in uses {
        let agree = match (stated, found) {
            (Some(stated), Some(found)) => (stated - found).abs() <= AGREEMENT * found.abs().max(1.0),
            (stated, found) => stated == found,
        };
        if !agree {
            let [stated, found] = [stated, found].map(|used| used.unwrap_or(0.0));
            return Err(AdmissionFault::Stale { quantity, stated, found });
        }
    }
    Ok(())
}
