//! How much of each joint's position, velocity and acceleration limit a trajectory uses, at its true extrema.
//!
//! ```text
//! use of a position = |q − mid| / half range        use of a speed = |q̇| / limit        of an acceleration = |q̈| / limit
//! ```
//! A use of 1 touches the limit. Where only one end of a range is finite, the distance to it counts in rad above 1.

use super::margins::Margins;
use crate::model::{Limits, Robot};
use crate::trajectory::{Curve, Extremum, PeriodicTrajectory, Quantity};

/// The worst use of one kind of limit over all joints and all times.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WorstUse {
    /// Part of the limit that is used; above 1 it is exceeded.
    pub ratio: f64,
    /// Index of the joint.
    pub joint: usize,
    /// Time, s.
    pub t: f64,
    /// Value there: rad, rad/s, rad/s², rad/s³, N·m or A, with m for rad and N for N·m on a prismatic joint.
    pub value: f64,
    /// The limit it is held against, in the same unit.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub limit: f64,
}

impl WorstUse {
    /// Nothing used yet.
    pub(crate) const NONE: Self = Self { ratio: f64::NEG_INFINITY, joint: 0, t: 0.0, value: 0.0, limit: 0.0 };

    pub(crate) fn worst_of(self, other: Self) -> Self {
        if other.ratio > self.ratio { other } else { self }
    }

    /// The worse of two; `None` where there is neither.
    pub(crate) fn worst_of_both(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        one.into_iter().chain(other).reduce(Self::worst_of)
    }
}

/// Interval in which a motion may lie.
pub(crate) fn interval(limits: &Limits, quantity: Quantity) -> (f64, f64) {
    match quantity {
        Quantity::Position => limits.position,
        Quantity::Velocity => (-limits.velocity, limits.velocity),
        Quantity::Acceleration => (-limits.acceleration, limits.acceleration),
    }
}

/// Part of an interval that `value` uses, and the end that it is nearer to.
pub(crate) fn ratio_in((low, high): (f64, f64), value: f64) -> (f64, f64) {
    match (low.is_finite(), high.is_finite()) {
        (true, true) => {
            let (mid, half) = (0.5 * (low + high), 0.5 * (high - low));
            ((value - mid).abs() / half, if value < mid { low } else { high })
        }
        (true, false) => (1.0 + (low - value), low),
        (false, true) => (1.0 + (value - high), high),
        (false, false) => (0.0, f64::INFINITY),
    }
}

/// The worst use of one kind of limit, at the true extrema.
pub(crate) fn worst_use(robot: &Robot, trajectory: &PeriodicTrajectory, quantity: Quantity) -> WorstUse {
    let uses = robot.joints().iter().enumerate().flat_map(|(j, joint)| {
        let range = interval(&joint.limits, quantity);
        extreme_uses(trajectory, j, &trajectory.curve(j, quantity), |value| ratio_in(range, value))
    });
    uses.fold(WorstUse::NONE, WorstUse::worst_of)
}

/// The worst use of the jerk limits, at the true extrema; `None` where no joint has one.
pub(crate) fn worst_jerk(robot: &Robot, trajectory: &PeriodicTrajectory) -> Option<WorstUse> {
    let limited = robot.joints().iter().enumerate().filter(|(_, joint)| joint.limits.jerk.is_finite());
    let uses = limited.flat_map(|(j, joint)| {
        let limit = joint.limits.jerk;
        let used = |value: f64| (value.abs() / limit, limit.copysign(value));
        extreme_uses(trajectory, j, &trajectory.derivative(j, 3), used)
    });
    uses.reduce(WorstUse::worst_of)
}

/// What a joint's curve uses at its extrema; `used` gives the ratio at a value and the limit it is held against.
fn extreme_uses(
    trajectory: &PeriodicTrajectory,
    joint: usize,
    curve: &Curve,
    used: impl Fn(f64) -> (f64, f64),
) -> [WorstUse; 2] {
    [curve.minimum(), curve.maximum()].map(|Extremum { phase, value }| {
        let (ratio, limit) = used(value);
        WorstUse { ratio, joint, t: phase / trajectory.omega(), value, limit }
    })
}

/// Interval that the given part of a limit leaves, about its middle.
pub(crate) fn permitted(limits: &Limits, quantity: Quantity, part: f64) -> (f64, f64) {
    let (low, high) = interval(limits, quantity);
    if low.is_finite() && high.is_finite() {
        let (mid, half) = (0.5 * (low + high), 0.5 * (high - low) * part);
        (mid - half, mid + half)
    } else {
        (low, high)
    }
}

/// Part of an interval that a curve needs if its mean may move: of a position its span, else its peak.
pub(crate) fn room_used(curve: &Curve, quantity: Quantity, (low, high): (f64, f64)) -> f64 {
    match quantity {
        Quantity::Position => (curve.maximum().value - curve.minimum().value) / (high - low),
        Quantity::Velocity | Quantity::Acceleration => curve.peak() / high,
    }
}

/// Brings every joint inside the given parts of its limits with the least change of shape: the amplitudes of a joint
/// shrink by one factor, then its mean moves into what its range leaves.
///
/// A joint already inside is left as it is, to the last bit.
pub(crate) fn shrink_into_limits(robot: &Robot, trajectory: &mut PeriodicTrajectory, margins: &Margins) {
    for (j, joint) in robot.joints().iter().enumerate() {
        let mut factor = 1.0_f64;
        for quantity in Quantity::ALL {
            let permitted = permitted(&joint.limits, quantity, margins.part(quantity));
            let peak = room_used(&trajectory.curve(j, quantity), quantity, permitted);
            if peak > 1.0 {
                factor = factor.min(1.0 / peak);
            }
        }
        if joint.limits.jerk.is_finite() {
            let peak = trajectory.derivative(j, 3).peak() / (margins.acceleration * joint.limits.jerk);
            if peak > 1.0 {
                factor = factor.min(1.0 / peak);
            }
        }
        if factor < 1.0 {
            trajectory.adjust(j, factor, 0.0);
        }
        let position = trajectory.curve(j, Quantity::Position);
        let (low, high) = permitted(&joint.limits, Quantity::Position, margins.position);
        let (under, over) = (low - position.minimum().value, position.maximum().value - high);
        match (under > 0.0, over > 0.0) {
            (true, true) => trajectory.adjust(j, 1.0, 0.5 * (under - over)),
            (true, false) => trajectory.adjust(j, 1.0, under),
            (false, true) => trajectory.adjust(j, 1.0, -over),
            (false, false) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::seed::Seed;
    use crate::trajectory::{FourierJoint, FourierTrajectory};
    use rand::RngExt;

    #[test]
    fn analytic_use_of_one_harmonic() {
        let mut robot = chains::planar_2r();
        let limits =
            Limits { position: (-1.0, 2.0), velocity: 2.0, acceleration: 4.0, jerk: 8.0, torque: 10.0, ..Limits::NONE };
        robot = robot.with_joints(|joint| joint.limits = limits).unwrap();
        let joint = |a: f64, q0: f64| FourierJoint { name: String::new(), a: vec![a], b: vec![0.0], q0 };
        let period = std::f64::consts::TAU;
        let series = FourierTrajectory { period_s: period, joints: vec![joint(1.0, 0.5), joint(0.5, 1.6)] };
        let trajectory = series.clone().into();
        // Amplitude 1 in all four for joint 1, 0.5 for joint 2, whose mean is 1.1 off the middle of a range of ±1.5.
        let position = worst_use(&robot, &trajectory, Quantity::Position);
        assert!((position.ratio - 1.6 / 1.5).abs() < 1e-12 && position.joint == 1 && position.limit == 2.0);
        assert!((worst_use(&robot, &trajectory, Quantity::Velocity).ratio - 0.5).abs() < 1e-12);
        assert!((worst_use(&robot, &trajectory, Quantity::Acceleration).ratio - 0.25).abs() < 1e-12);
        assert!((worst_jerk(&robot, &trajectory).unwrap().ratio - 0.125).abs() < 1e-12);
        let mut inside = trajectory;
        shrink_into_limits(&robot, &mut inside, &Margins::default());
        let PeriodicTrajectory::Fourier(inside) = inside else { panic!("another family") };
        assert_eq!(inside.joints[0], series.joints[0]);
        assert!((inside.joints[1].q0 - 1.5).abs() < 1e-12);
    }

    #[test]
    fn identity_shrunk_trajectories_are_inside() {
        let mut rng = Seed::new(8).stream("shrink", 0);
        let (robot, _) = chains::random_robot(&mut rng, 3);
        let limits =
            Limits { position: (-0.7, 1.9), velocity: 1.5, acceleration: 5.0, jerk: 12.0, torque: 1.0, ..Limits::NONE };
        let robot = robot.with_joints(|joint| joint.limits = limits).unwrap();
        for _ in 0..50 {
            let mut draw = |size: f64| (0..4).map(|_| rng.random_range(-size..size)).collect::<Vec<f64>>();
            let joints = (0..3)
                .map(|_| FourierJoint { name: String::new(), a: draw(2.0), b: draw(2.0), q0: draw(3.0)[0] })
                .collect();
            let mut trajectory = FourierTrajectory { period_s: 6.0, joints }.into();
            let margins = Margins { position: 0.9, velocity: 0.9, acceleration: 0.9, torque: 1.0 };
            shrink_into_limits(&robot, &mut trajectory, &margins);
            for quantity in Quantity::ALL {
                assert!(worst_use(&robot, &trajectory, quantity).ratio < 0.9 + 1e-9);
            }
            assert!(worst_jerk(&robot, &trajectory).unwrap().ratio < 0.9 + 1e-9);
        }
    }
}
