//! Friction of a joint at constant speeds.
//!
//! ```text
//! τ(+v) = g + Fc + Fv v      τ(−v) = g − Fc − Fv v      f(v) = (τ(+v) − τ(−v)) / 2 = Fc + Fv v
//! ```
//! with means over the same measured positions in both directions, `∫ τ dq / (q_high − q_low)`: gravity `g`, which
//! depends on position alone, cancels however the servo lags. Intervals cover the noise alone, not the
//! settling of the servo: where the speed differs by δ between the ends of a stroke, inertia takes `J v δ / stroke`
//! from the difference, which looks like a viscous friction too small by some tenths of a per cent.
//!
//! The half sum is gravity and the offset together, and is given for what it shows: it must not depend on
//! the speed. Where friction falls as a joint starts to move (Stribeck), the slowest speeds lie above the line through the
//! faster half.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::error::CalibrationError;
use crate::estimation::Measured;
use crate::experiment::Recording;
use crate::linalg::LeastSquares;
use crate::model::Robot;
use crate::signal::torque_map;
use crate::trajectory::{ConstantSpeedTrajectory, PeriodicTrajectory, Trajectory};

/// Left out at both ends of a segment, s: the settling time of the servo.
const SETTLING_S: f64 = 0.2;

/// Friction at one speed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FrictionPoint {
    /// Speed, rad/s (m/s).
    pub speed: f64,
    /// Half the difference of the efforts there and back, N·m (N).
    pub friction: Measured,
    /// Half their sum: gravity and offset, N·m (N).
    pub mean: f64,
}

/// Friction of one joint.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Friction {
    /// Viscous friction Fv, N·m·s/rad (N·s/m).
    pub viscous: Measured,
    /// Coulomb friction Fc, N·m (N).
    pub coulomb: Measured,
    /// How far the slowest speed lies above the line through the faster half, N·m (N): above zero by more than its
    /// interval, friction falls as the joint starts to move. `None` with fewer than four speeds.
    pub stribeck: Option<Measured>,
    /// RMS of the distance of the points from the line, N·m (N).
    pub residual_rms: f64,
    /// The speeds, ascending.
    pub points: Vec<FrictionPoint>,
}

/// Measures the friction of `joint` (from zero) on the recorded periods of a motion there and back at constant speeds.
///
/// # Errors
/// [`CalibrationError`] where the recording is of another motion, or has fewer than two periods or two speeds.
pub fn friction(recording: &Recording, robot: &Robot, joint: usize) -> Result<Friction, CalibrationError> {
    let PeriodicTrajectory::ConstantSpeed(motion) = &recording.trajectory else {
        return Err(CalibrationError::unfit("trajectory", "another motion", "segments at constant speed"));
    };
    if robot.dof() != recording.dof || joint >= recording.dof {
        return Err(CalibrationError::unfit("joint", joint + 1, "one that robot and recording have"));
    }
    let periods = recording.periods();
    if periods < 2 {
        return Err(CalibrationError::unfit(
            "recorded periods",
            periods,
            "at least two, whose scatter shows the noise",
        ));
    }
    let pairs = pairs(motion, joint, recording.rate_hz);
    if pairs.len() < 2 {
        return Err(CalibrationError::unfit("speeds there and back", pairs.len(), "at least two"));
    }
    let map = torque_map(robot, recording.effort_unit);
    let n = recording.dof;
    let effort = |k: usize| -> f64 { (0..n).map(|j| map[(joint, j)] * recording.effort(k)[j]).sum() };
    let mean = |period: usize, (first, last): (usize, usize), way: (f64, f64)| -> f64 {
        let start = recording.period(period).start;
        let position = |k: usize| recording.q(k)[joint].clamp(way.0, way.1);
        let work = |k: usize| 0.5 * (effort(k) + effort(k + 1)) * (position(k + 1) - position(k));
        let (first, last) = (start + first, start + last);
        (first..last).map(work).sum::<f64>() / (position(last) - position(first))
    };
    // Half differences and half sums by speed, then period; the scatter over periods is pooled over the speeds.
    let mut means = Vec::with_capacity(pairs.len());
    let mut scatter = 0.0;
    for pair in &pairs {
        let halves: Vec<(f64, f64)> = (0..periods)
            .map(|period| {
                let (there, back) = (mean(period, pair.there, pair.way), mean(period, pair.back, pair.way));
                (0.5 * (there - back), 0.5 * (there + back))
            })
            .collect();
        let share = 1.0 / periods as f64;
        let friction = halves.iter().map(|half| share * half.0).sum::<f64>();
        let gravity = halves.iter().map(|half| share * half.1).sum::<f64>();
        let weight = (pair.there.1 - pair.there.0) as f64;
        scatter += weight * halves.iter().map(|half| (half.0 - friction) * (half.0 - friction)).sum::<f64>();
        means.push((friction, gravity, weight));
    }
    let freedom = (pairs.len() * (periods - 1)) as f64;
    // Variance of a mean over one sample there and one back; means over `weight` samples and all periods have less.
    let variance = scatter / freedom;
    let std = |weight: f64| (variance / (weight * periods as f64)).sqrt();
    let point = |(pair, &(friction, mean, weight)): (&Pair, &(f64, f64, f64))| {
        let friction = Measured::new(friction, std(weight), freedom);
        FrictionPoint { speed: pair.speed, friction, mean }
    };
    let points: Vec<FrictionPoint> = pairs.iter().zip(&means).map(point).collect();
    let weights: Vec<f64> = means.iter().map(|mean| mean.2).collect();
    let line = Line::through(&points, &weights)?;
    let noise = variance / periods as f64;
    let residual: f64 = points.iter().map(|point| (point.friction.value - line.value(point.speed)).powi(2)).sum();
    let stribeck = if points.len() >= 4 {
        let half = points.len() / 2;
        let fast = Line::through(&points[half..], &weights[half..])?;
        let slow = points[0];
        let excess = slow.friction.value - fast.value(slow.speed);
        let spread = (noise / weights[0] + noise * fast.variance_at(slow.speed)).sqrt();
        Some(Measured::new(excess, spread, freedom))
    } else {
        None
    };
    Ok(Friction {
        viscous: Measured::new(line.slope(), (noise * line.covariance[(1, 1)]).sqrt(), freedom),
        coulomb: Measured::new(line.value(0.0), (noise * line.covariance[(0, 0)]).sqrt(), freedom),
        stribeck,
        residual_rms: (residual / points.len() as f64).sqrt(),
        points,
    })
}

/// Two segments at one speed, as samples of the period, and the positions that both cover.
struct Pair {
    speed: f64,
    way: (f64, f64),
    there: (usize, usize),
    back: (usize, usize),
}

/// The segments of a joint that are followed by their way back, without their ends, by speed.
fn pairs(motion: &ConstantSpeedTrajectory, joint: usize, rate_hz: f64) -> Vec<Pair> {
    let speed = &motion.joints[joint].speed;
    let sample = |t: f64| (t * rate_hz).round() as usize;
    let window = |segment: &Range<f64>| (sample(segment.start), sample(segment.end));
    let segments = motion.segments();
    let n = motion.dof();
    let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut at = |t: f64| {
        motion.evaluate(t, &mut q, &mut qd, &mut qdd);
        q[joint]
    };
    let mut pairs: Vec<Pair> = (0..speed.len().saturating_sub(1))
        .filter(|&k| speed[k] > 0.0 && speed[k + 1] == -speed[k])
        .map(|k| {
            let way = (at(segments[k].start + SETTLING_S), at(segments[k].end - SETTLING_S));
            Pair { speed: speed[k], way, there: window(&segments[k]), back: window(&segments[k + 1]) }
        })
        .filter(|pair| pair.way.1 > pair.way.0 && pair.there.1 > pair.there.0 && pair.back.1 > pair.back.0)
        .collect();
    pairs.sort_by(|a, b| a.speed.total_cmp(&b.speed));
    pairs
}

/// A weighted straight line; its covariance is for unit variance at unit weight.
struct Line {
    solution: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Line {
    fn through(points: &[FrictionPoint], weights: &[f64]) -> Result<Self, CalibrationError> {
        let root: Vec<f64> = weights.iter().map(|weight| weight.sqrt()).collect();
        let w = DMatrix::from_fn(points.len(), 2, |k, c| root[k] * if c == 0 { 1.0 } else { points[k].speed });
        let y = DVector::from_fn(points.len(), |k, _| root[k] * points[k].friction.value);
        let fit = LeastSquares::solve(&w, &y)
            .map_err(|fault| CalibrationError::NotExcited { parameter: "viscous friction", fault })?;
        Ok(Self { solution: fit.solution().clone(), covariance: fit.inverse_information() })
    }

    fn slope(&self) -> f64 {
        self.solution[1]
    }

    fn value(&self, speed: f64) -> f64 {
        self.solution[0] + self.solution[1] * speed
    }

    fn variance_at(&self, speed: f64) -> f64 {
        let c = &self.covariance;
        c[(0, 0)] + 2.0 * speed * c[(0, 1)] + speed * speed * c[(1, 1)]
    }
}
