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
use crate::model::{Joint, Robot};
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
    let mut draw = |joint: &Joint| -> Vec<f64> {
        // `radkhah2007`'s random velocities; where a joint states no speed limit, its shape alone counts.
        let speed = if joint.limits.velocity.is_finite() { joint.limits.velocity } else { 1.0 };
        (0..count).map(|_| rng.random_range(-speed..speed)).collect()
    };
    let velocities: Vec<Vec<f64>> = robot.joints().iter().map(&mut draw).collect();
    let none = vec![0.0; highest];
    let joint = |joint: &Joint| FourierJoint { name: joint.name.clone(), a: none.clone(), b: none.clone(), q0: 0.0 };
    let mut joints: Vec<FourierJoint> = robot.joints().iter().map(joint).collect();
    // Joints of equally many harmonics share the factor of their basis.
    for harmonics_alike in 1..=highest {
        let alike: Vec<usize> = (0..robot.dof()).filter(|&j| harmonics[j] == harmonics_alike).collect();
        if alike.is_empty() {
            continue;
        }
        let lists: Vec<&[f64]> = alike.iter().map(|&j| &velocities[j][..]).collect();
        let fits = fit_velocities(&lists, harmonics_alike);
        for (&j, fit) in alike.iter().zip(fits) {
            for (l, pair) in fit.chunks_exact(2).enumerate() {
                (joints[j].a[l], joints[j].b[l]) = (pair[0], pair[1]);
            }
        }
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

/// Least squares of the velocity basis on each of several lists of as many velocities at `t_m = m T / M`: `(a_1, b_1, …, a_H, b_H)`.
fn fit_velocities(velocities: &[&[f64]], harmonics: usize) -> Vec<Vec<f64>> {
    let (count, columns) = (velocities[0].len(), 2 * harmonics);
    let system = DMatrix::from_fn(count, columns + velocities.len(), |m, c| {
        if c >= columns {
            return velocities[c - columns][m];
        }
        let (s, cos) = libm::sincos(std::f64::consts::TAU * ((m * (c / 2 + 1)) % count) as f64 / count as f64);
        if c % 2 == 0 { cos } else { s }
    });
    // What follows the basis' own columns in the factor of [A | q̇ …] is Qᵀ q̇.
    let factor = triangular_factor(&system);
    let r = factor.view((0, 0), (columns, columns)).into_owned();
    let fit = |c: usize| {
        let projected = factor.view((0, columns + c), (columns, 1));
        solve_upper(&r, &DVector::from_iterator(columns, projected.iter().copied())).iter().copied().collect()
    };
    (0..velocities.len()).map(fit).collect()
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
        // On equidistant samples least squares is the discrete Fourier sum.
        let rough: Vec<f64> = (0..100).map(|m| libm::sin((m * m) as f64)).collect();
        let fits = fit_velocities(&[&exact, &rough], 5);
        for l in 0..5 {
            assert!((fits[0][2 * l] - trajectory.joints[3].a[l]).abs() < 1e-14);
            assert!((fits[0][2 * l + 1] - trajectory.joints[3].b[l]).abs() < 1e-14);
        }
        let sum: f64 =
            (0..100).map(|m| 0.02 * rough[m] * libm::cos(2.0 * std::f64::consts::TAU * m as f64 / 100.0)).sum();
        assert!((fits[1][2] - sum).abs() < 1e-14);
        assert_eq!(fit_velocities(&[&rough], 5)[0], fits[1]);
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
