//! Where a design starts: `radkhah2007`'s first guess, and the random draws it is compared with.
//!
//! `radkhah2007` (III.A) draws 100 random velocities and fits the series to them by least squares (its eq. 8). Its eq. 7
//! has a slip that is corrected here: the matrix A it prints is the *position* basis, and a fit of velocities needs the
//! velocity basis, in which the column of q0 is zero:
//!
//! ```text
//! A δ = q̇,     A = ( cos ωt_m, sin ωt_m, …, cos Hωt_m, sin Hωt_m ),     δ = (a_1, b_1, …, a_H, b_H)
//! ```
//! So q0 is not determined by velocities; it is drawn from what the joint's limits leave to the fitted motion. The
//! amplitudes are scaled so that the joint just uses its tightest limit.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;

use super::error::{ExcitationError, above_zero, at_least_one};
use super::limits::{interval, room_used};
use crate::linalg::{solve_upper, triangular_factor};
use crate::model::Robot;
use crate::seed::Seed;
use crate::trajectory::{FourierJoint, FourierTrajectory, PeriodicMotion, Quantity};

/// How many random velocities `radkhah2007` fits.
pub const START_VELOCITIES: usize = 100;

/// Part of its tightest limit that a joint of a start uses.
const START_USE: f64 = 0.999;

/// `radkhah2007`'s first guess for a design: a start of its own for every `index`, inside all limits of position, velocity
/// and acceleration.
///
/// # Errors
/// [`ExcitationError`] if the period is not positive or there is no harmonic.
pub fn radkhah2007_start(
    robot: &Robot,
    period_s: f64,
    harmonics: usize,
    seed: Seed,
    index: u64,
) -> Result<FourierTrajectory, ExcitationError> {
    series_start(robot, period_s, &vec![harmonics; robot.dof()], seed, index)
}

/// `radkhah2007`'s first guess with a number of harmonics for each joint; joints that lack the highest have zeros there.
pub(super) fn series_start(
    robot: &Robot,
    period_s: f64,
    harmonics: &[usize],
    seed: Seed,
    index: u64,
) -> Result<FourierTrajectory, ExcitationError> {
    above_zero("period", period_s, "s")?;
    let highest = harmonics.iter().copied().max().unwrap_or(0);
    at_least_one("harmonics", highest)?;
    let mut rng = seed.stream("paper start", index);
    let count = START_VELOCITIES.max(4 * highest);
    let mut joints = Vec::with_capacity(robot.dof());
    for (joint, &harmonics) in robot.joints().iter().zip(harmonics) {
        // `radkhah2007`'s random velocities; where a joint states no speed limit, its shape alone counts.
        let speed = if joint.limits.velocity.is_finite() { joint.limits.velocity } else { 1.0 };
        let velocities: Vec<f64> = (0..count).map(|_| rng.random_range(-speed..speed)).collect();
        let (mut a, mut b) = fit_velocities(&velocities, harmonics);
        a.resize(highest, 0.0);
        b.resize(highest, 0.0);
        joints.push(FourierJoint { name: joint.name.clone(), a, b, q0: 0.0 });
    }
    let mut trajectory = FourierTrajectory { period_s, joints };
    for (j, joint) in robot.joints().iter().enumerate() {
        scale_to_limits(robot, &mut trajectory, j);
        let position = trajectory.position(j);
        let (under, over) = (position.minimum().value, position.maximum().value);
        let (low, high) = joint.limits.position;
        let place: f64 = rng.random();
        let (low, high) = match (low.is_finite(), high.is_finite()) {
            (true, true) => {
                let slack = 0.5 * (1.0 - START_USE) * (high - low);
                (low + slack - under, high - slack - over)
            }
            (true, false) => (low - under, low - under + std::f64::consts::PI),
            (false, true) => (high - over - std::f64::consts::PI, high - over),
            (false, false) => (-std::f64::consts::PI, std::f64::consts::PI),
        };
        trajectory.joints[j].q0 = low + place * (high - low).max(0.0);
    }
    Ok(trajectory)
}

/// Least squares of the velocity basis on velocities at `t_m = m T / M`: `(a, b)`.
fn fit_velocities(velocities: &[f64], harmonics: usize) -> (Vec<f64>, Vec<f64>) {
    if harmonics == 0 {
        return (Vec::new(), Vec::new());
    }
    let count = velocities.len();
    let columns = 2 * harmonics;
    let system = DMatrix::from_fn(count, columns + 1, |m, c| {
        if c == columns {
            return velocities[m];
        }
        let (s, cos) = libm::sincos(std::f64::consts::TAU * ((m * (c / 2 + 1)) % count) as f64 / count as f64);
        if c % 2 == 0 { cos } else { s }
    });
    // The last column of the factor of [A | q̇] is Qᵀ q̇.
    let factor = triangular_factor(&system);
    let r = factor.view((0, 0), (columns, columns)).into_owned();
    let projected = DVector::from_iterator(columns, factor.view((0, columns), (columns, 1)).iter().copied());
    let delta = solve_upper(&r, &projected);
    (delta.iter().step_by(2).copied().collect(), delta.iter().skip(1).step_by(2).copied().collect())
}

/// Scales the amplitudes of one joint until it uses its share of the tightest limit.
fn scale_to_limits(robot: &Robot, trajectory: &mut FourierTrajectory, joint: usize) {
    let limits = &robot.joints()[joint].limits;
    let mut largest = 0.0_f64;
    for quantity in Quantity::ALL {
        let curve = trajectory.curve(joint, quantity as usize);
        largest = largest.max(room_used(&curve, quantity, interval(limits, quantity)));
    }
    if largest > 0.0 {
        trajectory.adjust(joint, START_USE / largest, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::limits::worst_use;

    #[test]
    fn analytic_fit_recovers_a_series_and_projects_the_rest() {
        let trajectory = crate::trajectory::table_one::corrected();
        let velocity = trajectory.curve(3, 1);
        let sample = |m: usize| velocity.value(std::f64::consts::TAU * m as f64 / 100.0);
        let exact: Vec<f64> = (0..100).map(sample).collect();
        let (a, b) = fit_velocities(&exact, 5);
        for l in 0..5 {
            assert!((a[l] - trajectory.joints[3].a[l]).abs() < 1e-14);
            assert!((b[l] - trajectory.joints[3].b[l]).abs() < 1e-14);
        }
        // On equidistant samples least squares is the discrete Fourier sum.
        let rough: Vec<f64> = (0..100).map(|m| libm::sin((m * m) as f64)).collect();
        let (a, _) = fit_velocities(&rough, 3);
        let sum: f64 =
            (0..100).map(|m| 0.02 * rough[m] * libm::cos(2.0 * std::f64::consts::TAU * m as f64 / 100.0)).sum();
        assert!((a[1] - sum).abs() < 1e-14);
    }

    #[test]
    fn identity_starts_are_inside_and_differ() {
        let robot = chains::crs_a460();
        let seed = Seed::new(4);
        let first = radkhah2007_start(&robot, 10.0, 5, seed, 0).unwrap();
        assert_eq!(first, radkhah2007_start(&robot, 10.0, 5, seed, 0).unwrap());
        assert_ne!(first, radkhah2007_start(&robot, 10.0, 5, seed, 1).unwrap());
        for index in 0..10 {
            let start = radkhah2007_start(&robot, 10.0, 5, seed, index).unwrap().into();
            let uses = Quantity::ALL.map(|quantity| worst_use(&robot, &start, quantity).ratio);
            assert!(uses.iter().all(|&ratio| ratio < START_USE + 1e-9), "{uses:?}");
            assert!(uses.iter().any(|&ratio| ratio > START_USE - 1e-9), "{uses:?}");
        }
    }

    #[test]
    fn analytic_starts_of_joints_with_one_limit_are_centred_within_half_a_turn_of_it() {
        for (low, high) in [(-0.5, f64::INFINITY), (f64::NEG_INFINITY, 0.5)] {
            let robot = chains::crs_a460().with_joints(|joint| joint.limits.position = (low, high)).unwrap();
            let start = radkhah2007_start(&robot, 10.0, 5, Seed::new(4), 0).unwrap();
            for j in 0..robot.dof() {
                let position = start.position(j);
                let (room_below, room_above) = (position.minimum().value - low, high - position.maximum().value);
                assert!((0.0..=std::f64::consts::PI).contains(&room_below.min(room_above)), "{j}");
            }
        }
    }
}
