//! May this trajectory move this robot, as the plan performs it? The last look before anything moves.
//!
//! [`verify_certificate`] asks whether a certificate is true and that of this trajectory and robot,
//! [`verify_performance`] whether the motion holds all limits at the speed and on the ramps at which it is performed.

use super::certificate::Certificate;
use super::clearance::WorstClearance;
use super::effort::EffortModel;
use super::limit_kind::LimitKind;
use super::limit_survey::{LimitSurvey, WorstCases, WorstLimitUse};
use crate::model::Robot;
use crate::provenance::sha256;
use crate::trajectory::{PeriodicTrajectory, Timeline};

/// What rounding may add to the use of a limit.
const ROUNDING: f64 = 1e-9;

/// How far a use that is computed anew may be from the one that the certificate states, of the limit.
const AGREEMENT: f64 = 1e-6;

/// Ramps that differ by no more than this are the same, s: below any sample.
const SAME_RAMP: f64 = 1e-9;

/// Samples of a period, at least and at most, for any certificate.
const SAMPLES: (usize, usize) = (500, 100_000);

/// Why a trajectory must not move a robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum VerificationError {
    /// The trajectory moves another number of joints.
    #[error("the trajectory moves {found} joints, expected the robot's {expected}")]
    Joints { found: usize, expected: usize },
    /// The certificate was made for another robot file.
    #[error(
        "the certificate is for the robot \"{certified}\" as of file {certified_sha256:.12}…, expected \"{robot}\" as of \
         file {robot_sha256:.12}…"
    )]
    OtherRobot { certified: String, certified_sha256: String, robot: String, robot_sha256: String },
    /// The certificate was made for another trajectory.
    #[error("the certificate is for trajectory {certified:.12}…, expected this one, {found:.12}…")]
    OtherTrajectory { certified: String, found: String },
    /// The certificate is not as it was when it was made.
    #[error("the certificate has been changed since it was made")]
    Changed,
    /// The certificate was made with other nominal parameters.
    #[error("the certificate is for nominal parameters {certified:.12}…, expected those at hand, {found:.12}…")]
    OtherParameters { certified: String, found: String },
    /// The certificate states another use of a limit than is found with the limits and parameters at hand.
    #[error(
        "the certificate states {stated:.6} as the use of the {} limit, expected {found:.6} by the nominal parameters \
         at hand", limit.name()
    )]
    Stale { limit: LimitKind, stated: f64, found: f64 },
    /// The motion is not performed as it was certified, and the torques that it asks for are unknown.
    #[error(
        "the certificate holds torque for {}, expected nominal parameters, by which it can be held for a period of \
         {period_s} s and {}", shown(*certified_ramp_s), shown(*ramp_s)
    )]
    EffortsUnknown { ramp_s: Option<f64>, period_s: f64, certified_ramp_s: Option<f64> },
    /// A limit is exceeded.
    #[error(
        "joint \"{joint}\": {} {found:.4} {unit} exceeds its limit {permitted:.4} {unit}{}", limit.name(),
        if limit.has_time() { format!(" at t = {t:.3} s") } else { String::new() }
    )]
    Limit { joint: String, limit: LimitKind, found: f64, permitted: f64, unit: &'static str, t: f64 },
    /// Two bodies would touch.
    #[error("\"{}\" and \"{}\" come within {:.4} m at t = {:.3} s, expected a distance above zero", .0.pair[0], .0.pair[1], .0.distance_m, .0.t)]
    Contact(WorstClearance),
}

/// Ramps in words.
fn shown(ramp_s: Option<f64>) -> String {
    ramp_s.map_or_else(|| "no ramps".to_owned(), |ramp| format!("ramps of {ramp} s"))
}

/// Checks that a certificate is that of this trajectory and of this robot's file, that it is unchanged, and that
/// no limit is exceeded: all of them are computed anew. Torque and current are by the parameters in `efforts`, with the
/// certificate's own number of standard deviations as their multiple; without `efforts` they are read off the
/// certificate.
///
/// # Errors
/// [`VerificationError`] with the first thing that does not fit.
pub fn verify_certificate(
    robot: &Robot,
    trajectory: &PeriodicTrajectory,
    certificate: &Certificate,
    efforts: Option<&mut EffortModel>,
) -> Result<(), VerificationError> {
    if trajectory.dof() != robot.dof() {
        return Err(VerificationError::Joints { found: trajectory.dof(), expected: robot.dof() });
    }
    if certificate.robot != robot.name() || certificate.robot_sha256 != robot.source_sha256() {
        return Err(VerificationError::OtherRobot {
            certified: certificate.robot.clone(),
            certified_sha256: certificate.robot_sha256.clone(),
            robot: robot.name().to_owned(),
            robot_sha256: robot.source_sha256().to_owned(),
        });
    }
    let found = sha256(&trajectory.to_toml());
    if certificate.trajectory_sha256 != found {
        let certified = certificate.trajectory_sha256.clone();
        return Err(VerificationError::OtherTrajectory { certified, found });
    }
    if !certificate.is_unchanged() {
        return Err(VerificationError::Changed);
    }
    // Where the certificate has no torque, the design was not to hold it.
    let efforts = efforts.filter(|_| certificate.nominal_sha256.is_some());
    let are_read = efforts.is_none();
    let parameters = efforts.as_ref().map(|model| model.parameters_sha256());
    let timeline = Timeline { period_s: trajectory.period_s(), ramp_s: certificate.ramp_s };
    let samples = certificate.samples.clamp(SAMPLES.0, SAMPLES.1);
    let LimitSurvey { mut used, mut worst } = LimitSurvey::of(robot, trajectory, timeline, samples, efforts);
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
        return Err(VerificationError::OtherParameters { certified: certified.clone(), found });
    }
    same(&certificate.worst_limit_use, &used)
}

/// Checks that a motion exceeds no limit as it is performed: along `trajectory`, which may be a certified one at less
/// than its speed, and on the ramps of `timeline`. Slower is not safer: acceleration that relieves gravity is missing
/// then, and a longer ramp passes other places of the path.
///
/// Torque and current are computed by `efforts` where the certificate holds them. Without `efforts` only the motion that
/// was certified, at its own speed and on its own ramps, is known to hold them.
///
/// # Errors
/// [`VerificationError`] with the first thing that does not fit.
pub fn verify_performance(
    robot: &Robot,
    trajectory: &PeriodicTrajectory,
    timeline: Timeline,
    certificate: &Certificate,
    efforts: Option<&mut EffortModel>,
) -> Result<(), VerificationError> {
    if trajectory.dof() != robot.dof() {
        return Err(VerificationError::Joints { found: trajectory.dof(), expected: robot.dof() });
    }
    let holds_efforts = certificate.nominal_sha256.is_some();
    if holds_efforts && efforts.is_none() && !is_certified(trajectory, timeline, certificate) {
        return Err(VerificationError::EffortsUnknown {
            ramp_s: timeline.ramp_s,
            period_s: timeline.period_s,
            certified_ramp_s: certificate.ramp_s,
        });
    }
    let samples = certificate.samples.clamp(SAMPLES.0, SAMPLES.1);
    let efforts = efforts.filter(|_| holds_efforts);
    exceeded(robot, &LimitSurvey::of(robot, trajectory, timeline, samples, efforts).worst)
}

/// Whether a motion is the certified one, at its own speed and on its own ramps.
fn is_certified(trajectory: &PeriodicTrajectory, timeline: Timeline, certificate: &Certificate) -> bool {
    let same_ramp = match (timeline.ramp_s, certificate.ramp_s) {
        (Some(found), Some(certified)) => (found - certified).abs() <= SAME_RAMP,
        (found, certified) => found.is_none() && certified.is_none(),
    };
    same_ramp && certificate.trajectory_sha256 == sha256(&trajectory.to_toml())
}

/// Nothing may be beyond its limit.
fn exceeded(robot: &Robot, worst: &WorstCases) -> Result<(), VerificationError> {
    for limit in LimitKind::ALL {
        let Some(case) = worst.for_limit(limit).filter(|worst| worst.ratio > 1.0 + ROUNDING) else { continue };
        // Uses that are read off a certificate may name a joint that the robot does not have.
        let joint = robot.joints().get(case.joint).ok_or(VerificationError::Changed)?;
        return Err(VerificationError::Limit {
            joint: joint.name.clone(),
            limit,
            found: case.value,
            permitted: case.limit,
            unit: limit.unit(joint.kind),
            t: case.t,
        });
    }
    let touching = worst.clearance.as_ref().filter(|nearest| nearest.distance_m < 0.0);
    touching.map_or(Ok(()), |nearest| Err(VerificationError::Contact(nearest.clone())))
}

/// The use of torque and current that the certificate states must be what is found: else it is of other parameters. The
/// limits of motion may be others than those it was designed for, as long as they hold.
fn same(stated: &WorstLimitUse, found: &WorstLimitUse) -> Result<(), VerificationError> {
    for limit in LimitKind::EFFORTS {
        let (stated, found) = (stated.for_limit(limit), found.for_limit(limit));
        let agree = match (stated, found) {
            (Some(stated), Some(found)) => (stated - found).abs() <= AGREEMENT * found.abs().max(1.0),
            (stated, found) => stated == found,
        };
        if !agree {
            let [stated, found] = [stated, found].map(|used| used.unwrap_or(0.0));
            return Err(VerificationError::Stale { limit, stated, found });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::planar_2r;
    use crate::excitation::{CriterionKind, DesignBudget, DesignLimits, DesignProblem, DesignSpace};
    use crate::model::{Columns, StandardParameters};
    use crate::spatial::Inertia;
    use crate::trajectory::{Family, FourierJoint, FourierTrajectory};

    /// Torque that holds 1 kg at 0.4 m, level, N·m.
    const LEVEL: f64 = 9.81 * 0.4;

    /// An upper arm with 1 kg at its end swings from level, where it turns round, 1 rad down and back:
    ///
    /// ```text
    /// q = −½ − ½ cos ωt     τ = m g l cos q + m l² q̈     m l² ½ ω² = 0.3 m g l
    /// ```
    /// At full speed the acceleration takes three tenths of its weight away where it is level, and τ stays below 0.9 of
    /// the level torque; standing there takes all of it. The rating is 0.94 of that torque.
    fn swing() -> (DesignProblem, PeriodicTrajectory, Certificate) {
        let robot = planar_2r().with_joints(|joint| joint.limits.torque = 0.94 * LEVEL).unwrap();
        let mut problem =
            DesignProblem::new(robot, Columns::RIGID, CriterionKind::DOptimal, DesignLimits::motion()).unwrap();
        let mut nominal = StandardParameters::zero(2);
        nominal.links[0] = Inertia::from_array(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let omega = (0.3 * LEVEL / (0.16 * 0.5_f64)).sqrt();
        let period_s = std::f64::consts::TAU / omega;
        problem.set_space(DesignSpace::new(Family::Fourier, period_s, vec![5; 2])).unwrap();
        let (nominal, ramp_s) = (Some(nominal), Some(0.2 * period_s));
        problem.set_limits(DesignLimits { nominal, ramp_s, ..DesignLimits::motion() }).unwrap();
        problem.set_budget(DesignBudget { certificate_samples: 500, ..DesignBudget::default() }).unwrap();
        let joint = |name: &str, b: f64, q0: f64| FourierJoint { name: name.into(), a: vec![0.0], b: vec![b], q0 };
        let joints = vec![joint("shoulder", 0.5 * omega, -0.5), joint("elbow", 0.0, 0.0)];
        let motion = FourierTrajectory::new(period_s, joints).unwrap().into();
        let certificate = Certificate::new(&problem, &motion).unwrap();
        (problem, motion, certificate)
    }

    #[test]
    fn analytic_longer_ramps_and_less_speed_ask_for_more_torque_where_acceleration_relieves_gravity() {
        let (problem, motion, certificate) = swing();
        let mut model = problem.efforts().unwrap();
        assert_eq!(verify_certificate(problem.robot(), &motion, &certificate, Some(&mut model)), Ok(()));
        let used = certificate.worst_limit_use.torque.unwrap();
        assert!((0.9..0.96).contains(&used), "{used}");
        let mut verify = |motion: &PeriodicTrajectory, ramp_periods: f64| {
            let timeline =
                Timeline { period_s: motion.period_s(), ramp_s: Some(ramp_periods * problem.space().period_s) };
            verify_performance(problem.robot(), motion, timeline, &certificate, Some(&mut model))
        };
        assert_eq!(verify(&motion, 0.2), Ok(()));
        // A ramp of 1.2 periods begins where the arm is nearly level, at rest; one of half a period does not get there.
        assert_eq!(verify(&motion, 0.5), Ok(()));
        for (motion, ramp_periods) in [(motion.clone(), 1.2), (motion.at_speed(0.25), 0.2), (motion.at_speed(0.1), 0.2)]
        {
            let error = verify(&motion, ramp_periods).unwrap_err();
            let VerificationError::Limit { joint, limit: LimitKind::Torque, found, .. } = &error else {
                panic!("{error}")
            };
            // The long ramp sets out upwards from nearly level, which takes a little more than standing there.
            assert!(joint == "shoulder" && (0.94 * LEVEL..1.05 * LEVEL).contains(found), "{error}");
        }
    }

    #[test]
    fn without_parameters_only_the_certified_motion_is_known_to_hold_torque() {
        let (problem, motion, certificate) = swing();
        let verify = |motion: &PeriodicTrajectory, ramp_s: f64| {
            let timeline = Timeline { period_s: motion.period_s(), ramp_s: Some(ramp_s) };
            verify_performance(problem.robot(), motion, timeline, &certificate, None)
        };
        let certified = certificate.ramp_s.unwrap();
        assert_eq!(verify(&motion, certified), Ok(()));
        for error in
            [verify(&motion, 2.0 * certified).unwrap_err(), verify(&motion.at_speed(0.5), certified).unwrap_err()]
        {
            assert!(matches!(error, VerificationError::EffortsUnknown { .. }), "{error}");
            assert!(error.to_string().contains("expected nominal parameters"), "{error}");
        }
    }
}
