//! The list of periodic motions that an experiment can perform.

use std::ops::{Deref, DerefMut};

use super::b_spline::BSplineTrajectory;
use super::constant_speed::ConstantSpeedTrajectory;
use super::curve::Curve;
use super::custom::CustomTrajectory;
use super::definition::{PeriodicMotion, Trajectory};
use super::fourier::FourierTrajectory;
use super::fourier_quintic::FourierQuinticTrajectory;
use super::quantity::Quantity;

/// A periodic motion of all joints.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::{FourierJoint, FourierTrajectory, PeriodicTrajectory, Trajectory};
/// let joint = FourierJoint { name: "joint1".into(), a: vec![0.5], b: vec![0.0], q0: 0.2 };
/// let motion = PeriodicTrajectory::from(FourierTrajectory::new(10.0, vec![joint]).unwrap());
/// assert_eq!((motion.dof(), motion.period_s(), motion.names()), (1, 10.0, vec!["joint1"]));
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "family", rename_all = "kebab-case")]
pub enum PeriodicTrajectory {
    /// Finite Fourier series.
    Fourier(FourierTrajectory),
    /// Fourier series with a polynomial that lets it start and stop at rest.
    FourierQuintic(FourierQuinticTrajectory),
    /// Periodic splines on equidistant knots.
    BSpline(BSplineTrajectory),
    /// Segments at constant speed, for calibrations.
    ConstantSpeed(ConstantSpeedTrajectory),
    /// One from outside of this list.
    Custom(CustomTrajectory),
}

/// The motion behind the name.
impl Deref for PeriodicTrajectory {
    type Target = dyn PeriodicMotion;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Fourier(motion) => motion,
            Self::FourierQuintic(motion) => motion,
            Self::BSpline(motion) => motion,
            Self::ConstantSpeed(motion) => motion,
            Self::Custom(motion) => motion.motion(),
        }
    }
}

impl DerefMut for PeriodicTrajectory {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Fourier(motion) => motion,
            Self::FourierQuintic(motion) => motion,
            Self::BSpline(motion) => motion,
            Self::ConstantSpeed(motion) => motion,
            Self::Custom(motion) => motion.motion_mut(),
        }
    }
}

impl PeriodicTrajectory {
    /// Fundamental angular frequency ω = 2π/T, rad/s.
    pub fn omega(&self) -> f64 {
        std::f64::consts::TAU / self.period_s()
    }

    /// One motion of one joint over the phase ωt.
    pub fn curve(&self, joint: usize, quantity: Quantity) -> Curve {
        (**self).curve(joint, quantity as usize)
    }

    /// The derivative of this order (0 position … 3 jerk) of one joint over the phase ωt, in rad and s.
    pub fn derivative(&self, joint: usize, order: usize) -> Curve {
        (**self).curve(joint, order)
    }

    /// Returns this path at `part` of the speed: period T/part, velocities times part, accelerations times part².
    #[must_use]
    pub fn at_speed(&self, part: f64) -> Self {
        let mut slowed = self.clone();
        slowed.slow_down(part);
        slowed
    }

    /// What the numbers of its file mean, for a reader of it; T is the period, t from 0 to T.
    pub const fn formula(&self) -> &'static str {
        match self {
            Self::Fourier(_) => "q(t) = q0 + Σ_l a_l/(ω l) sin(ω l t) − b_l/(ω l) cos(ω l t), ω = 2π/T",
            Self::FourierQuintic(_) => {
                "q(t) = F(t) − T Σa_l A(u) − T² ω Σ(l b_l) B(u), u = t/T, A = u − 10u³ + 15u⁴ − 6u⁵, B = u²(1 − u)²/2, \
                 F = q0 + Σ_l a_l/(ω l) sin(ω l t) − b_l/(ω l) cos(ω l t), ω = 2π/T"
            }
            Self::BSpline(_) => {
                "q(t) = Σ_k c_k N(K t/T − k), repeated with period K; N the cardinal B-spline of this degree"
            }
            Self::ConstantSpeed(_) => {
                "q̇ = v_k for a stretch, then v_k + (v_{k+1} − v_k)(10s³ − 15s⁴ + 6s⁵) over change_s, s from 0 to 1"
            }
            Self::Custom(_) => "a law of the program's own",
        }
    }
}

impl Trajectory for PeriodicTrajectory {
    fn dof(&self) -> usize {
        (**self).dof()
    }

    fn period_s(&self) -> f64 {
        (**self).period_s()
    }

    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        (**self).evaluate(t, q, qd, qdd);
    }
}

macro_rules! from {
    ($($kind:ident($motion:ty)),*) => {
        $(impl From<$motion> for PeriodicTrajectory {
            fn from(motion: $motion) -> Self {
                Self::$kind(motion)
            }
        })*
    };
}

from! {
    Fourier(FourierTrajectory), FourierQuintic(FourierQuinticTrajectory), ConstantSpeed(ConstantSpeedTrajectory),
    BSpline(BSplineTrajectory), Custom(CustomTrajectory)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::table_one;
    use crate::trajectory::{BSplineJoint, ConstantSpeedJoint, States};

    /// One motion of each kind on the robot of Table I.
    fn motions() -> Vec<PeriodicTrajectory> {
        let series = table_one::corrected();
        let spline = |degree: usize| {
            let joint = |j: usize| BSplineJoint {
                name: format!("joint{j}"),
                c: (0..11).map(|k| libm::sin((k * k + j) as f64)).collect(),
            };
            BSplineTrajectory::new(10.0, degree, (0..6).map(joint).collect()).unwrap()
        };
        let speeds = |j: usize| ConstantSpeedJoint {
            name: format!("joint{j}"),
            q0: 0.1 * j as f64,
            speed: vec![0.1 * j as f64, -0.1 * j as f64],
        };
        let segments = ConstantSpeedTrajectory::new(0.8, vec![0.57, 0.57], (0..6).map(speeds).collect()).unwrap();
        vec![
            series.clone().into(),
            FourierQuinticTrajectory::from(series).into(),
            spline(3).into(),
            spline(5).into(),
            segments.into(),
        ]
    }

    #[test]
    fn identity_velocity_and_acceleration_are_derivatives_of_position() {
        for motion in motions() {
            let at = |t: f64| {
                let mut x = [[0.0; 6]; 3];
                let [q, qd, qdd] = &mut x;
                motion.evaluate(t, q, qd, qdd);
                x
            };
            let h = 1e-4;
            for k in 0..34 {
                // No knot of 11 lies within h of these times, so that cubic splines are smooth there.
                let t = 0.31 * f64::from(k) + 0.01;
                let (before, now, after) = (at(t - h), at(t), at(t + h));
                for i in 0..6 {
                    // Central differences: h²/6 times a derivative of at most 100.
                    assert!((now[1][i] - (after[0][i] - before[0][i]) / (2.0 * h)).abs() < 2e-7);
                    assert!((now[2][i] - (after[1][i] - before[1][i]) / (2.0 * h)).abs() < 1e-6);
                }
            }
            let (start, end) = (at(0.0), at(motion.period_s()));
            assert!(start.iter().flatten().zip(end.iter().flatten()).all(|(x, y)| (x - y).abs() < 1e-12));
        }
    }

    #[test]
    fn identity_curves_equal_the_evaluation() {
        for motion in motions() {
            let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
            for k in 0..29 {
                let t = 0.37 * f64::from(k);
                motion.evaluate(t, &mut q, &mut qd, &mut qdd);
                for i in 0..6 {
                    for (quantity, expected) in Quantity::ALL.into_iter().zip([q[i], qd[i], qdd[i]]) {
                        let found = motion.curve(i, quantity).value(motion.omega() * t);
                        assert!((found - expected).abs() < 1e-11, "{quantity:?} {found} {expected} at {t}");
                    }
                }
            }
        }
    }

    #[test]
    fn identity_adjusting_scales_about_the_mean_and_shifts() {
        for motion in motions() {
            let mut moved = motion.clone();
            moved.adjust(2, 0.5, 0.3);
            moved.adjust(3, 1.0, 0.0);
            // Six samples between two of 11 knots: their mean is that of the curve.
            let (now, before) = (moved.sample(66), motion.sample(66));
            for k in 0..66 {
                // The velocity has no mean of its own: it halves.
                assert!((now.qd(k)[2] - 0.5 * before.qd(k)[2]).abs() < 1e-14);
                assert_eq!(now.q(k)[3], before.q(k)[3]);
            }
            let mean = |states: &States| (0..66).map(|k| states.q(k)[2]).sum::<f64>() / 66.0;
            if !matches!(motion, PeriodicTrajectory::FourierQuintic(_) | PeriodicTrajectory::ConstantSpeed(_)) {
                assert!((mean(&now) - mean(&before) - 0.3).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn identity_a_slower_motion_has_the_same_path_and_its_part_of_the_speed() {
        for motion in motions() {
            let part = 0.1;
            let slow = motion.at_speed(part);
            assert!((slow.period_s() * part / motion.period_s() - 1.0).abs() < 1e-15);
            let ([mut q, mut qd, mut qdd], [mut sq, mut sqd, mut sqdd]) = ([[0.0; 6]; 3], [[0.0; 6]; 3]);
            for k in 0..37 {
                let t = 0.31 * f64::from(k);
                motion.evaluate(t, &mut q, &mut qd, &mut qdd);
                slow.evaluate(t / part, &mut sq, &mut sqd, &mut sqdd);
                for i in 0..6 {
                    // Rounding of the phase times the derivative.
                    assert!((q[i] - sq[i]).abs() < 1e-13);
                    assert!((part * qd[i] - sqd[i]).abs() < 1e-13);
                    assert!((part * part * qdd[i] - sqdd[i]).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn identity_files_read_back_to_the_last_bit() {
        for motion in motions() {
            let text = motion.to_toml();
            assert_eq!(PeriodicTrajectory::from_toml(&text).unwrap(), motion, "{text}");
            let json = serde_json::to_string(&motion).unwrap();
            assert_eq!(serde_json::from_str::<PeriodicTrajectory>(&json).unwrap(), motion);
        }
    }

    #[test]
    fn analytic_highest_frequency_of_each_family() {
        let found: Vec<f64> = motions().iter().map(|motion| motion.highest_hz()).collect();
        assert_eq!(found[0], 0.5);
        // A spline of 11 knots has lines beyond 0.5 Hz, which fall with the power degree − 1 of the frequency.
        assert!(found[1] >= 0.5 && found[2] > found[3] && found[3] > 0.5 && found[2] < 12.0, "{found:?}");
    }
}
