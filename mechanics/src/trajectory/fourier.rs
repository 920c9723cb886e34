//! `radkhah2007`'s parametrisation (II.C): every joint moves along a finite Fourier series of one common period.
//!
//! ```text
//! q(t)  = Σ_l  a_l/(ω l) sin ωl t − b_l/(ω l) cos ωl t + q0
//! q̇(t)  = Σ_l  a_l cos ωl t + b_l sin ωl t
//! q̈(t)  = Σ_l  −a_l ω l sin ωl t + b_l ω l cos ωl t            ω = 2π/T,  l = 1 … H
//! ```
//! a and b are velocity amplitudes, rad/s (m/s for a prismatic joint), q0 is in rad (m).
//!
//! Reference: J. Swevers et al., "Optimal robot excitation and identification", IEEE T-RA 13(5), 1997.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::curve::Curve;
use super::definition::{PeriodicMotion, Trajectory};
use super::error::TrajectoryError;
use super::states::States;
use super::trigonometric::TrigonometricPolynomial;

/// The series of one joint.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FourierJoint {
    /// Name of the joint.
    pub name: String,
    /// Velocity amplitudes of the cosines, rad/s, one for each harmonic.
    pub a: Vec<f64>,
    /// Velocity amplitudes of the sines, rad/s, as many.
    pub b: Vec<f64>,
    /// Mean position, rad.
    pub q0: f64,
}

/// A Fourier trajectory of all joints.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::{FourierJoint, FourierTrajectory, Trajectory};
/// let joint = FourierJoint { name: "joint1".into(), a: vec![0.5], b: vec![0.0], q0: 0.2 };
/// let trajectory = FourierTrajectory::new(10.0, vec![joint]).unwrap();
/// let (mut q, mut qd, mut qdd) = ([0.0], [0.0], [0.0]);
/// trajectory.evaluate(0.0, &mut q, &mut qd, &mut qdd);
/// assert_eq!((q, qd, qdd), ([0.2], [0.5], [0.0]));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub struct FourierTrajectory {
    /// Period T, s.
    pub period_s: f64,
    /// The joints from the base outwards.
    pub joints: Vec<FourierJoint>,
}

// Refuses what `FourierTrajectory::new` refuses.
crate::plain::checked_when_read!(FourierTrajectory, |value| Self::new(value.period_s, value.joints));

impl FourierTrajectory {
    /// Checks and takes the series of all joints.
    ///
    /// # Errors
    /// [`TrajectoryError`] if the period is not a finite number above zero, if there is no joint, if a
    /// joint's `a` and `b` differ in length from each other or from those of the first joint, or if a coefficient is
    /// not finite.
    pub fn new(period_s: f64, joints: Vec<FourierJoint>) -> Result<Self, TrajectoryError> {
        if !(period_s.is_finite() && period_s > 0.0) {
            return Err(TrajectoryError::Period { found: period_s });
        }
        let Some(first) = joints.first() else {
            return Err(TrajectoryError::NoJoint);
        };
        let harmonics = first.a.len();
        for FourierJoint { name, a, b, q0 } in &joints {
            let joint = || name.clone();
            if a.len() != harmonics || b.len() != harmonics {
                return Err(TrajectoryError::Amplitudes { joint: joint(), a: a.len(), b: b.len(), harmonics });
            }
            if let Some(&found) = a.iter().chain(b).chain([q0]).find(|value| !value.is_finite()) {
                return Err(TrajectoryError::NotFinite { joint: joint(), found });
            }
        }
        Ok(Self { period_s, joints })
    }

    /// Number of harmonics H.
    pub fn harmonics(&self) -> usize {
        self.joints.first().map_or(0, |joint| joint.a.len())
    }

    /// Fundamental angular frequency ω = 2π/T, rad/s.
    pub fn omega(&self) -> f64 {
        TAU / self.period_s
    }

    /// Position of joint `index` over the phase ωt, rad.
    pub fn position(&self, index: usize) -> TrigonometricPolynomial {
        self.wave(index, 0)
    }

    /// The derivative of any order of joint `index`'s position over the phase ωt.
    pub(super) fn wave(&self, index: usize, order: usize) -> TrigonometricPolynomial {
        let FourierJoint { a, b, q0, .. } = &self.joints[index];
        let frequency: Vec<f64> = (1..=self.harmonics()).map(|l| l as f64 * self.omega()).collect();
        let turned = |values: &[f64], sign: f64| -> Vec<f64> {
            values
                .iter()
                .zip(&frequency)
                .map(|(value, w)| match order {
                    0 => sign * value / w,
                    1 => sign * value,
                    _ => (2..=order).fold(sign * value, |product, _| product * w),
                })
                .collect()
        };
        // Each derivative turns a cosine into −sine and a sine into cosine.
        let (cosine, sine) = match order % 4 {
            0 => (turned(b, -1.0), turned(a, 1.0)),
            1 => (turned(a, 1.0), turned(b, 1.0)),
            2 => (turned(b, 1.0), turned(a, -1.0)),
            _ => (turned(a, -1.0), turned(b, -1.0)),
        };
        TrigonometricPolynomial { mean: if order == 0 { *q0 } else { 0.0 }, cosine, sine }
    }

    /// `count` samples of one period, at `t_k = k T / count`.
    pub fn sample(&self, count: usize) -> States {
        Trajectory::sample(self, count)
    }
}

impl Trajectory for FourierTrajectory {
    fn dof(&self) -> usize {
        self.joints.len()
    }

    fn period_s(&self) -> f64 {
        self.period_s
    }

    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let omega = self.omega();
        let cycles = t / self.period_s;
        let (s1, c1) = libm::sincos(TAU * (cycles - cycles.floor()));
        for (i, joint) in self.joints.iter().enumerate() {
            (q[i], qd[i], qdd[i]) = (joint.q0, 0.0, 0.0);
        }
        let harmonics = self.joints.iter().map(|joint| joint.a.len()).max().unwrap_or(0);
        let (mut s, mut c) = (s1, c1);
        for l in 0..harmonics {
            let w = omega * (l + 1) as f64;
            let per_w = 1.0 / w;
            for (i, joint) in self.joints.iter().enumerate() {
                let (Some(a), Some(b)) = (joint.a.get(l), joint.b.get(l)) else { continue };
                q[i] += (a * s - b * c) * per_w;
                qd[i] += a * c + b * s;
                qdd[i] += w * (b * c - a * s);
            }
            (s, c) = (s * c1 + c * s1, c * c1 - s * s1);
        }
    }
}

impl PeriodicMotion for FourierTrajectory {
    fn names(&self) -> Vec<&str> {
        self.joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    fn curve(&self, joint: usize, order: usize) -> Curve {
        Curve::Trigonometric(self.wave(joint, order))
    }

    fn adjust(&mut self, joint: usize, factor: f64, shift: f64) {
        let series = &mut self.joints[joint];
        if factor != 1.0 {
            for amplitude in series.a.iter_mut().chain(&mut series.b) {
                *amplitude *= factor;
            }
        }
        series.q0 += shift;
    }

    fn slow_down(&mut self, part: f64) {
        // Amplitudes a, b are velocities: their ratio to ω, which is the path, stays.
        self.period_s /= part;
        for joint in &mut self.joints {
            for amplitude in joint.a.iter_mut().chain(&mut joint.b) {
                *amplitude *= part;
            }
        }
    }

    fn highest_hz(&self) -> f64 {
        self.harmonics() as f64 / self.period_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::table_one;

    #[test]
    fn identity_velocity_and_acceleration_are_derivatives_of_position() {
        let trajectory = table_one::corrected();
        let at = |t: f64| {
            let mut x = [[0.0; 6]; 3];
            let [q, qd, qdd] = &mut x;
            trajectory.evaluate(t, q, qd, qdd);
            x
        };
        let h = 1e-4;
        for k in 0..17 {
            let t = 0.61 * f64::from(k);
            let (before, now, after) = (at(t - h), at(t), at(t + h));
            for i in 0..6 {
                // Central differences: h²/6 times a third derivative of at most 30.
                assert!((now[1][i] - (after[0][i] - before[0][i]) / (2.0 * h)).abs() < 1e-7);
                assert!((now[2][i] - (after[1][i] - before[1][i]) / (2.0 * h)).abs() < 2e-7);
            }
        }
    }

    #[test]
    fn identity_polynomials_equal_the_evaluation() {
        let trajectory = table_one::corrected();
        let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
        for k in 0..13 {
            let t = 0.77 * f64::from(k);
            trajectory.evaluate(t, &mut q, &mut qd, &mut qdd);
            let phase = trajectory.omega() * t;
            for i in 0..6 {
                assert!((trajectory.position(i).value(phase) - q[i]).abs() < 1e-13);
                assert!((trajectory.curve(i, 1).value(phase) - qd[i]).abs() < 1e-13);
                assert!((trajectory.curve(i, 2).value(phase) - qdd[i]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn faults_say_what_was_found() {
        let joint = |a: Vec<f64>, b: Vec<f64>| FourierJoint { name: "elbow".into(), a, b, q0: 0.0 };
        let text = |result: Result<FourierTrajectory, TrajectoryError>| result.unwrap_err().to_string();
        assert!(text(FourierTrajectory::new(0.0, vec![joint(vec![1.0], vec![1.0])])).contains("period is 0 s"));
        assert!(text(FourierTrajectory::new(1.0, vec![])).contains("number of joints is 0"));
        let uneven = text(FourierTrajectory::new(1.0, vec![joint(vec![1.0], vec![])]));
        assert!(uneven.contains("joint \"elbow\" has 1 values in a and 0 in b"), "{uneven}");
        assert!(text(FourierTrajectory::new(1.0, vec![joint(vec![f64::NAN], vec![0.0])])).contains("NaN"));
    }
}
