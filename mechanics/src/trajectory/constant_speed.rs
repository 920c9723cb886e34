//! Segments at constant speed with smooth reversals between them: the motion of calibrations.
//!
//! ```text
//! q̇ = v_k for D_k seconds, then over B seconds  q̇ = v_k + (v_{k+1} − v_k) σ(s)    σ = 10s³ − 15s⁴ + 6s⁵
//!                                               q = q_k + B (v_k s + (v_{k+1} − v_k)(5/2 s⁴ − 3 s⁵ + s⁶))
//! Σ_k v_k (D_k + B) = 0                         so that each joint comes back, v_{K+1} = v_1
//! ```
//! Acceleration is continuous and at most `15/8 · |v_{k+1} − v_k| / B`. There and back at one speed for one time is the
//! plain case: the reversal between them leaves the joint where it met it, so both segments cover the same positions.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::curve::Curve;
use super::definition::{PeriodicMotion, Trajectory};
use super::error::TrajectoryError;
use super::piecewise::{PiecewisePolynomial, derivative, horner};
use crate::model::{Joint, Robot};

/// The displacement of a change of speed over its length and the difference of speeds, in powers of s.
const CHANGE: [f64; 7] = [0.0, 0.0, 0.0, 0.0, 2.5, -3.0, 1.0];

/// The speeds of one joint.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ConstantSpeedJoint {
    /// Name of the joint.
    pub name: String,
    /// Position where the first segment begins, rad (m).
    pub q0: f64,
    /// Speed of each segment, rad/s (m/s); zeros for a joint that stands still.
    pub speed: Vec<f64>,
}

/// A motion of all joints at piecewise constant speeds.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::{ConstantSpeedJoint, ConstantSpeedTrajectory, Trajectory};
/// let joint = ConstantSpeedJoint { name: "joint1".into(), q0: 0.0, speed: vec![0.5, -0.5] };
/// let motion = ConstantSpeedTrajectory::new(0.2, vec![1.0, 1.0], vec![joint]).unwrap();
/// assert_eq!(motion.period_s(), 2.4);
/// let (mut q, mut qd, mut qdd) = ([0.0], [0.0], [0.0]);
/// motion.evaluate(0.8, &mut q, &mut qd, &mut qdd);
/// assert!((q[0] - 0.4).abs() < 1e-15 && qd == [0.5] && qdd == [0.0]);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub struct ConstantSpeedTrajectory {
    /// Length of each change of speed B, s.
    pub change_s: f64,
    /// Length of each segment D, s.
    pub stretch_s: Vec<f64>,
    /// The joints from the base outwards.
    pub joints: Vec<ConstantSpeedJoint>,
}

// Refuses what `ConstantSpeedTrajectory::new` refuses.
crate::plain::checked_when_read!(ConstantSpeedTrajectory, |value| Self::new(
    value.change_s,
    value.stretch_s,
    value.joints
));

impl ConstantSpeedTrajectory {
    /// Checks and takes the segments of all joints.
    ///
    /// # Errors
    /// [`TrajectoryError`] if a time is not above zero, if there is no segment or no joint, if a joint has
    /// another number of speeds than there are segments, if a number is not finite, or if a joint does not come back.
    pub fn new(change_s: f64, stretch_s: Vec<f64>, joints: Vec<ConstantSpeedJoint>) -> Result<Self, TrajectoryError> {
        if let Some(&found) = stretch_s.iter().chain([&change_s]).find(|time| !(time.is_finite() && **time > 0.0)) {
            return Err(TrajectoryError::Time { found });
        }
        if stretch_s.is_empty() {
            return Err(TrajectoryError::NoSegment);
        }
        if joints.is_empty() {
            return Err(TrajectoryError::NoJoint);
        }
        let motion = Self { change_s, stretch_s, joints };
        let segments = motion.stretch_s.len();
        for ConstantSpeedJoint { name, q0, speed } in &motion.joints {
            let joint = || name.clone();
            if speed.len() != segments {
                return Err(TrajectoryError::Speeds { joint: joint(), found: speed.len(), segments });
            }
            if let Some(&found) = speed.iter().chain([q0]).find(|value| !value.is_finite()) {
                return Err(TrajectoryError::NotFinite { joint: joint(), found });
            }
            let ways = speed.iter().zip(&motion.stretch_s).map(|(v, d)| v * (d + change_s));
            let (left, travelled) = ways.fold((0.0, 0.0), |(sum, size): (f64, f64), way| (sum + way, size + way.abs()));
            if !travelled.is_finite() || left.abs() > 1e-9 * travelled {
                return Err(TrajectoryError::NotPeriodic { joint: joint(), distance: left });
            }
        }
        Ok(motion)
    }

    /// There and back at each of `speeds` (rad/s, above zero, ascending) within `range`, for one joint of a robot whose
    /// other joints stand at `pose`. Segments last 3 s at most, and times are multiples of 10 ms.
    ///
    /// # Errors
    /// [`TrajectoryError`] if `range` is too short for a speed: a change of speed takes
    /// `15/8 · 2 v / (0.8 · acceleration limit)`.
    pub fn there_and_back(
        robot: &Robot,
        joint: usize,
        speeds: &[f64],
        pose: &[f64],
        range: (f64, f64),
    ) -> Result<Self, TrajectoryError> {
        let grid = |seconds: f64| libm::ceil(seconds * 100.0 - 1e-6) / 100.0;
        let most = speeds.iter().copied().fold(0.0, f64::max);
        let limit = robot.joints()[joint].limits.acceleration;
        let limit = if limit.is_finite() { 0.8 * limit } else { 5.0 * most };
        let change_s = grid((2.0 * most * 15.0 / 8.0 / limit).max(0.1));
        let way = range.1 - range.0;
        let speed: Vec<f64> = speeds.iter().flat_map(|&v| [v, -v]).collect();
        let still =
            |other: &Joint, q0: f64| ConstantSpeedJoint { name: other.name.clone(), q0, speed: vec![0.0; speed.len()] };
        let mut share = 1.0;
        // The drift from speed to speed is small beside the way of a reversal: a few shares of the way are enough.
        while share > 0.1 {
            let segment = |v: f64| libm::floor((share * way / v - 0.69 * change_s).clamp(0.0, 3.0) * 100.0) / 100.0;
            let stretch_s: Vec<f64> = speeds.iter().flat_map(|&v| [segment(v); 2]).collect();
            if stretch_s.iter().any(|&d| d < 0.1) {
                break;
            }
            let joints = robot.joints().iter().zip(pose).map(|(other, &q)| still(other, q));
            let mut motion = Self { change_s, stretch_s, joints: joints.collect() };
            motion.joints[joint].speed.clone_from(&speed);
            let curve = motion.curve(joint, 0);
            let (low, high) = (curve.minimum().value, curve.maximum().value);
            if high - low <= way {
                motion.joints[joint].q0 += 0.5 * (range.0 + range.1) - 0.5 * (low + high);
                return Self::new(motion.change_s, motion.stretch_s, motion.joints);
            }
            share -= 0.05;
        }
        Err(TrajectoryError::Range { joint: robot.joints()[joint].name.clone(), range: way, speed: most })
    }

    /// When each segment begins and ends within the period, s.
    pub fn segments(&self) -> Vec<Range<f64>> {
        let mut begin = 0.0;
        let span = |&d: &f64| {
            let here = begin;
            begin += d + self.change_s;
            here..here + d
        };
        self.stretch_s.iter().map(span).collect()
    }

    /// Length and polynomial in s ∈ [0, 1] of each piece of a joint's position: segment, change, segment, …
    fn pieces(&self, joint: usize) -> Vec<(f64, Vec<f64>)> {
        let ConstantSpeedJoint { q0, speed, .. } = &self.joints[joint];
        let mut q = *q0;
        let mut pieces = Vec::with_capacity(2 * speed.len());
        for (k, (&v, &d)) in speed.iter().zip(&self.stretch_s).enumerate() {
            let next = speed[(k + 1) % speed.len()];
            pieces.push((d, vec![q, v * d]));
            q += v * d;
            let b = self.change_s;
            let mut change: Vec<f64> = CHANGE.iter().map(|c| c * b * (next - v)).collect();
            change[0] += q;
            change[1] += b * v;
            pieces.push((b, change));
            q += 0.5 * b * (v + next);
        }
        pieces
    }

    /// Mean position of a joint, rad (m).
    fn mean(&self, joint: usize) -> f64 {
        let integral = |(length, polynomial): &(f64, Vec<f64>)| -> f64 {
            length * polynomial.iter().enumerate().map(|(power, c)| c / (power + 1) as f64).sum::<f64>()
        };
        self.pieces(joint).iter().map(integral).sum::<f64>() / self.period_s()
    }
}

impl Trajectory for ConstantSpeedTrajectory {
    fn dof(&self) -> usize {
        self.joints.len()
    }

    fn period_s(&self) -> f64 {
        self.stretch_s.iter().map(|d| d + self.change_s).sum()
    }

    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let period = self.period_s();
        let turns = t / period;
        let within = period * (turns - turns.floor());
        for joint in 0..self.joints.len() {
            let mut left = within;
            let pieces = self.pieces(joint);
            let last = pieces.len() - 1;
            for (k, (length, piece)) in pieces.into_iter().enumerate() {
                if left <= length || k == last {
                    let s = (left / length).min(1.0);
                    let first = derivative(&piece);
                    q[joint] = horner(&piece, s);
                    qd[joint] = horner(&first, s) / length;
                    qdd[joint] = horner(&derivative(&first), s) / (length * length);
                    break;
                }
                left -= length;
            }
        }
    }
}

impl PeriodicMotion for ConstantSpeedTrajectory {
    fn names(&self) -> Vec<&str> {
        self.joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    fn curve(&self, joint: usize, order: usize) -> Curve {
        let period = self.period_s();
        let mut begin = 0.0;
        let (mut knots, mut pieces) = (Vec::new(), Vec::new());
        for (length, mut piece) in self.pieces(joint) {
            knots.push(std::f64::consts::TAU * begin / period);
            begin += length;
            for _ in 0..order {
                piece = derivative(&piece).into_iter().map(|c| c / length).collect();
            }
            if piece.is_empty() {
                piece.push(0.0);
            }
            pieces.push(piece);
        }
        knots.push(std::f64::consts::TAU);
        Curve::Piecewise(PiecewisePolynomial { knots, pieces })
    }

    fn adjust(&mut self, joint: usize, factor: f64, shift: f64) {
        let mean = self.mean(joint);
        let moved = &mut self.joints[joint];
        if factor != 1.0 {
            moved.q0 = mean + factor * (moved.q0 - mean);
            moved.speed.iter_mut().for_each(|speed| *speed *= factor);
        }
        moved.q0 += shift;
    }

    fn slow_down(&mut self, part: f64) {
        self.change_s /= part;
        self.stretch_s.iter_mut().for_each(|segment| *segment /= part);
        self.joints.iter_mut().flat_map(|joint| &mut joint.speed).for_each(|speed| *speed *= part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::planar_2r;

    fn motion() -> ConstantSpeedTrajectory {
        let joint = |name: &str, scale: f64| ConstantSpeedJoint {
            name: name.into(),
            q0: 0.3,
            speed: [0.4, -0.4, 1.1, -1.1].map(|v| scale * v).to_vec(),
        };
        ConstantSpeedTrajectory::new(0.3, vec![1.0, 1.0, 0.5, 0.5], vec![joint("a", 1.0), joint("b", 0.0)]).unwrap()
    }

    #[test]
    fn identity_position_is_the_integral_of_speeds_and_accelerations() {
        let motion = motion();
        let at = |t: f64| {
            let mut x = [[0.0; 2]; 3];
            let [q, qd, qdd] = &mut x;
            motion.evaluate(t, q, qd, qdd);
            x
        };
        let h = 1e-5;
        for k in 0..420 {
            let t = 0.01 * f64::from(k) + 0.003;
            let (low, mid, high) = (at(t - h), at(t), at(t + h));
            assert!(((high[0][0] - low[0][0]) / (2.0 * h) - mid[1][0]).abs() < 1e-7, "{t}");
            assert!(((high[1][0] - low[1][0]) / (2.0 * h) - mid[2][0]).abs() < 1e-5, "{t}");
            assert_eq!(mid[0][1], 0.3);
        }
        let (start, end) = (at(0.0), at(motion.period_s() - 1e-12));
        assert!((start[0][0] - end[0][0]).abs() < 1e-9 && (start[1][0] - end[1][0]).abs() < 1e-9);
        for segment in motion.segments() {
            assert_eq!(at(segment.start + 1e-6)[1], at(segment.end - 1e-6)[1]);
        }
    }

    #[test]
    fn analytic_there_and_back_fills_its_range_and_keeps_the_acceleration() {
        let robot = planar_2r();
        let speeds = [0.2, 0.7, 1.5];
        let motion = ConstantSpeedTrajectory::there_and_back(&robot, 1, &speeds, &[0.5, 0.0], (-1.0, 1.4)).unwrap();
        let (low, high) = (motion.curve(1, 0).minimum().value, motion.curve(1, 0).maximum().value);
        assert!(low >= -1.0 && high <= 1.4 && (low + high - 0.4).abs() < 1e-12 && high - low > 1.5, "{low} {high}");
        assert!((motion.curve(1, 1).maximum().value - 1.5).abs() < 1e-12);
        let limit = robot.joints()[1].limits.acceleration;
        assert!(limit.is_infinite() || motion.curve(1, 2).maximum().value <= 0.8 * limit);
        assert!(ConstantSpeedTrajectory::there_and_back(&robot, 1, &[40.0], &[0.5, 0.0], (-0.1, 0.1)).is_err());
    }

    #[test]
    fn faults_say_what_was_found() {
        let joint = |speed: Vec<f64>| ConstantSpeedJoint { name: "elbow".into(), q0: 0.0, speed };
        let text =
            |change, joint| ConstantSpeedTrajectory::new(change, vec![1.0, 1.0], vec![joint]).unwrap_err().to_string();
        assert!(text(0.0, joint(vec![1.0, -1.0])).contains("time is 0 s"));
        assert!(text(0.1, joint(vec![1.0])).contains("1 speeds"));
        assert!(text(0.1, joint(vec![1.0, f64::NAN])).contains("NaN"));
        assert!(text(0.1, joint(vec![1.0, -0.9])).contains("away after a period"));
    }
}
