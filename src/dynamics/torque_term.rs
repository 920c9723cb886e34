//! What the drives add to the torque of the rigid links, one law per type.
//!
//! ```text
//! τ += φ · d · g(dᵀq̇, dᵀq̈)        d = e_j (joint side) or Cᵀe_j (motor side)
//! ```
//! `g` is the law: the torque of one unit of its parameter, at the velocity and acceleration of the coordinate it lives
//! in. A joint-side term (bearing friction, offset) lives in its joint's coordinate; a motor-side term (rotor, motor
//! friction) in its motor's, `q_motor = C q`, and by d'Alembert's principle reaches every joint which that motor
//! drives. Without a coupling matrix both are the same. Inverse and forward dynamics, the regressor's columns and its
//! derivatives are all made from these laws and from nothing else.

use std::fmt;

use crate::model::{ParameterKind, smooth_sign};

/// In which coordinate a term lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The joint's own coordinate.
    Joint,
    /// The motor's coordinate, `q_motor = C q`.
    Motor,
}

/// One law `g(v, a)` of the drives of a robot: torque per unit of its parameter, one for each joint or motor.
///
/// The law may be any function of velocity, but must be affine in acceleration with a constant slope: the slope is
/// the term's part in the mass matrix.
pub trait TorqueTerm: fmt::Debug + Send + Sync {
    /// The parameter that multiplies the law.
    fn kind(&self) -> ParameterKind;

    /// In which coordinate it lives.
    fn side(&self) -> Side;

    /// The law `g(v, a)` of joint or motor `index`, torque per unit parameter; `v` in rad/s, `a` in rad/s².
    fn torque(&self, index: usize, v: f64, a: f64) -> f64;

    /// Its slopes `(∂g/∂v, ∂g/∂a)`.
    fn slopes(&self, index: usize, v: f64, a: f64) -> (f64, f64);

    /// The law of several neighbours, the first of them `first`: `out_k = g(v_k, a_k)`.
    fn torques(&self, first: usize, v: &[f64], a: &[f64], out: &mut [f64]) {
        for (k, ((out, &v), &a)) in out.iter_mut().zip(v).zip(a).enumerate() {
            *out = self.torque(first + k, v, a);
        }
    }
}

macro_rules! linear_law {
    ($(#[$doc:meta])* $name:ident, $kind:ident, $side:ident, |$v:ident, $a:ident| $law:expr, $slopes:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name;

        impl TorqueTerm for $name {
            fn kind(&self) -> ParameterKind {
                ParameterKind::$kind
            }

            fn side(&self) -> Side {
                Side::$side
            }

            #[inline]
            fn torque(&self, _index: usize, $v: f64, $a: f64) -> f64 {
                $law
            }

            #[inline]
            fn slopes(&self, _index: usize, _v: f64, _a: f64) -> (f64, f64) {
                $slopes
            }
        }
    };
}

linear_law!(
    /// Inertia of the rotor, seen at the joint through the gear: `g = a`.
    RotorInertia, Ia, Motor, |_v, a| a, (0.0, 1.0)
);
linear_law!(
    /// Viscous friction of the joint: `g = v`.
    ViscousFriction, Fv, Joint, |v, _a| v, (1.0, 0.0)
);
linear_law!(
    /// A constant torque, or an offset of the current sensor: `g = 1`.
    Offset, Fo, Joint, |_v, _a| 1.0, (0.0, 0.0)
);
linear_law!(
    /// Viscous friction of a coupled motor: `g = v`.
    MotorViscous, Fvm, Motor, |v, _a| v, (1.0, 0.0)
);

macro_rules! coulomb_law {
    ($(#[$doc:meta])* $name:ident, $kind:ident, $side:ident) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name {
            /// Velocity scale `v_s` of the smooth sign of each joint or motor, rad/s; 0 is the plain sign.
            pub velocities: Vec<f64>,
        }

        impl TorqueTerm for $name {
            fn kind(&self) -> ParameterKind {
                ParameterKind::$kind
            }

            fn side(&self) -> Side {
                Side::$side
            }

            #[inline]
            fn torque(&self, index: usize, v: f64, _a: f64) -> f64 {
                smooth_sign(v, self.velocities[index])
            }

            #[inline]
            fn slopes(&self, index: usize, v: f64, _a: f64) -> (f64, f64) {
                // d/dv tanh(v / v_s) = (1 − tanh²) / v_s; the plain sign is flat wherever it has a slope.
                let v_s = self.velocities[index];
                let s = smooth_sign(v, v_s);
                (if v_s > 0.0 { (1.0 - s * s) / v_s } else { 0.0 }, 0.0)
            }
        }
    };
}

coulomb_law!(
    /// Coulomb friction of the joint: `g = tanh(v / v_s)`.
    CoulombFriction, Fc, Joint
);
coulomb_law!(
    /// Coulomb friction of a coupled motor: `g = tanh(v / v_s)`.
    MotorCoulomb, Fcm, Motor
);

#[cfg(test)]
mod tests {
    use super::*;

    fn laws() -> [Box<dyn TorqueTerm>; 6] {
        [
            Box::new(RotorInertia),
            Box::new(ViscousFriction),
            Box::new(CoulombFriction { velocities: vec![0.05, 1.0] }),
            Box::new(Offset),
            Box::new(MotorViscous),
            Box::new(MotorCoulomb { velocities: vec![0.3, 1.0] }),
        ]
    }

    #[test]
    fn analytic_laws_in_closed_form() {
        let (v, a) = (0.03, -2.0);
        let tanh = |x: f64| (libm::exp(x) - libm::exp(-x)) / (libm::exp(x) + libm::exp(-x));
        let expected = [a, v, tanh(0.6), 1.0, v, tanh(0.1)];
        for (law, expected) in laws().iter().zip(expected) {
            // One rounding of exp in each of four places.
            assert!((law.torque(0, v, a) - expected).abs() < 1e-14, "{law:?}");
        }
        let plain = CoulombFriction { velocities: vec![0.0] };
        assert!(plain.torque(0, -1e-9, 0.0).total_cmp(&-1.0).is_eq() && plain.slopes(0, 1.0, 0.0) == (0.0, 0.0));
        let mut several = [0.0; 2];
        laws()[2].torques(0, &[0.03, 0.03], &[0.0; 2], &mut several);
        assert!((several[0] - tanh(0.6)).abs() < 1e-14 && (several[1] - tanh(0.03)).abs() < 1e-14);
    }

    #[test]
    fn identity_slopes_are_central_differences_and_acceleration_slopes_are_constant() {
        for law in laws() {
            for (v, a) in [(0.03, -2.0), (-0.2, 0.4), (0.0, 0.0)] {
                let h = 1e-6;
                let dv = (law.torque(0, v + h, a) - law.torque(0, v - h, a)) / (2.0 * h);
                let da = (law.torque(0, v, a + h) - law.torque(0, v, a - h)) / (2.0 * h);
                let (by_velocity, by_acceleration) = law.slopes(0, v, a);
                // Truncation h² g‴/6 with g‴ up to 2/v_s³ = 16000.
                assert!((dv - by_velocity).abs() < 1e-8 && (da - by_acceleration).abs() < 1e-8, "{law:?}");
                assert!(by_acceleration.total_cmp(&law.slopes(0, 1.0, 1.0).1).is_eq());
            }
        }
    }
}
