//! What a trajectory is to everything that follows it: joint positions, velocities and accelerations at any time.

use std::ops::Range;

use super::curve::Curve;
use super::states::States;

/// Part of the largest acceleration amplitude below which a harmonic counts as none.
const NEGLIGIBLE: f64 = 0.05;

/// Samples of one period in which the harmonics of a motion are looked for.
const SPECTRUM_SAMPLES: usize = 512;

/// A periodic motion of all joints of a robot, in its own coordinates (rad, m).
pub trait Trajectory: Send + Sync {
    /// Number of joints n.
    fn dof(&self) -> usize;

    /// Period, s.
    fn period_s(&self) -> f64;

    /// Position (rad), velocity (rad/s) and acceleration (rad/s²) of every joint at time `t` (s), each of length n.
    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]);

    /// `count` samples of one period, at `t_k = k T / count`.
    fn sample(&self, count: usize) -> States {
        self.sample_part(count, 0..count)
    }

    /// Those samples of [`sample`](Self::sample) whose number is in a range.
    fn sample_part(&self, count: usize, numbers: Range<usize>) -> States {
        let mut states = States::with_len(self.dof(), numbers.len());
        for (place, k) in numbers.enumerate() {
            let [q, qd, qdd] = states.sample_mut(place);
            self.evaluate(self.period_s() * k as f64 / count as f64, q, qd, qdd);
        }
        states
    }
}

/// What every periodic motion provides.
pub trait PeriodicMotion: Trajectory {
    /// Names of the joints, n.
    fn names(&self) -> Vec<&str>;

    /// The derivative of this order with respect to time of joint `joint`'s position (0 position … 3 jerk), over the
    /// phase ωt, in rad and s.
    fn curve(&self, joint: usize, order: usize) -> Curve;

    /// Scales the motion of a joint about its mean position by `factor`, and moves the mean by `shift` (rad).
    fn adjust(&mut self, joint: usize, factor: f64, shift: f64);

    /// Runs the same path at `part` of the speed: period T/part, velocities times part, accelerations times part².
    fn slow_down(&mut self, part: f64);

    /// The highest frequency that the motion commands, Hz: that of its last harmonic whose acceleration has 5 % of the
    /// largest one's amplitude, in any joint.
    fn highest_hz(&self) -> f64 {
        let mut highest = 1;
        for joint in 0..self.dof() {
            let curve = self.curve(joint, 2);
            let step = std::f64::consts::TAU / SPECTRUM_SAMPLES as f64;
            let values: Vec<f64> = (0..SPECTRUM_SAMPLES).map(|k| curve.value(step * k as f64)).collect();
            let amplitude = |h: usize| {
                let (mut cosine, mut sine) = (0.0, 0.0);
                for (k, value) in values.iter().enumerate() {
                    let (s, c) = libm::sincos(step * ((k * h) % SPECTRUM_SAMPLES) as f64);
                    cosine += c * value;
                    sine += s * value;
                }
                libm::hypot(cosine, sine)
            };
            let amplitudes: Vec<f64> = (0..SPECTRUM_SAMPLES / 4).map(amplitude).collect();
            let least = NEGLIGIBLE * amplitudes.iter().copied().fold(0.0, f64::max);
            let last = amplitudes.iter().rposition(|&amplitude| amplitude > least).unwrap_or(0);
            highest = highest.max(last);
        }
        highest as f64 / self.period_s()
    }
}
