//! A motion for robots that no paper gave one.

use armid::dynamics::Dynamics;
use armid::excitation::{ExcitationError, radkhah2007_start};
use armid::model::{Robot, StandardParameters};
use armid::seed::Seed;
use armid::trajectory::FourierTrajectory;

/// Starts that are tried at one period.
const TRIES: u64 = 20;
/// Part of a joint's torque rating that may be used.
const TORQUE_USE: f64 = 0.9;
/// The shortest period, s; it is doubled where no start keeps the ratings.
const PERIOD: f64 = 10.0;
/// How often it is doubled.
const DOUBLINGS: i32 = 3;

/// A periodic motion within the limits of position, speed and acceleration, for which the torque that these parameters
/// ask for stays below nine tenths of the ratings where that can be had: `radkhah2007`'s first guess, the first that is
/// good enough, else the one that uses its ratings least.
///
/// # Errors
/// [`ExcitationError`] where the robot leaves no room for any motion.
pub fn safe_motion(
    robot: &Robot,
    parameters: &StandardParameters,
    seed: Seed,
) -> Result<FourierTrajectory, ExcitationError> {
    let mut best: Option<(f64, FourierTrajectory)> = None;
    for doubling in 0..=DOUBLINGS {
        let period = PERIOD * f64::from(1 << doubling);
        for index in 0..TRIES {
            let motion = radkhah2007_start(robot, period, 5, seed, index)?;
            let used = torque_use(robot, parameters, &motion);
            if used <= TORQUE_USE {
                return Ok(motion);
            }
            if best.as_ref().is_none_or(|(least, _)| used < *least) {
                best = Some((used, motion));
            }
        }
    }
    Ok(best.expect("at least one motion was drawn").1)
}

/// Largest part of a rating that the motion asks for.
fn torque_use(robot: &Robot, parameters: &StandardParameters, motion: &FourierTrajectory) -> f64 {
    let mut dynamics = Dynamics::new(robot, parameters);
    let states = motion.sample(200);
    let mut tau = vec![0.0; robot.dof()];
    let mut most: f64 = 0.0;
    for k in 0..states.len() {
        dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut tau);
        for (tau, joint) in tau.iter().zip(robot.joints()) {
            most = most.max(tau.abs() / joint.limits.torque);
        }
    }
    most
}
