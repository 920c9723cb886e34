//! Coulomb friction that depends on position: the first harmonic of a gear that runs out of true, or of a cable's pull.
//!
//! ```text
//! g = cos(q/l) tanh(v / v_s)        φ = Fpc        g = sin(q/l) tanh(v / v_s)        φ = Fps        beside Fc
//! ```
//! so that Coulomb friction is `Fc + Fpc cos(q/l) + Fps sin(q/l)`: with `l = 1` once a turn of the joint, with `1/l` the ratio of the gear
//! once a turn of the motor. `l` is in the robot file.
//!
//! Source: B. Armstrong, "Friction: experimental determination, modeling and compensation", ICRA 1988, for friction of the PUMA that
//! depends on position.

use super::coulomb::CoulombFriction;
use super::entry::{ByJoint, Dissipation, Prior, PriorOf, ShapeParameter, Sign, Structure, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// The cosine; see the module.
#[derive(Debug)]
pub struct PositionCosine;

/// The sine; see the module.
#[derive(Debug)]
pub struct PositionSine;

/// Motion of one radian of the wave.
const WAVE: ShapeParameter = ShapeParameter {
    key: "friction_wave_rad",
    meaning: "motion in which position-dependent friction goes on by one radian, rad (m)",
    default: 1.0,
    smooths: false,
};

impl PositionCosine {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fpc",
        name: "position",
        meaning: "cosine of position-dependent Coulomb friction",
        group: "position",
        key: ByJoint { revolute: "position_cosine_nm", prismatic: "position_cosine_n" },
        sign: Sign::Any,
        dissipation: Dissipation::Beside("Fc"),
        structure: Structure::Function { family: "cosine times smooth sign", odd: true },
        prior: Prior { key: "position_friction_nm", of: PriorOf::Unit, default: Some(0.5) },
        shapes: &[ShapeParameter::COULOMB_VELOCITY, WAVE],
        ..CoulombFriction::ENTRY
    };
}

impl PositionSine {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fps",
        meaning: "sine of position-dependent Coulomb friction",
        key: ByJoint { revolute: "position_sine_nm", prismatic: "position_sine_n" },
        structure: Structure::Function { family: "sine times smooth sign", odd: false },
        ..PositionCosine::ENTRY
    };
}

impl TermLaw for PositionCosine {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.q.over(x.shape[1]).sine_cosine().1 * x.qd.smooth_sign(x.shape[0])
    }
}

impl TermLaw for PositionSine {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.q.over(x.shape[1]).sine_cosine().0 * x.qd.smooth_sign(x.shape[0])
    }
}

#[cfg(test)]
mod tests {
    use super::super::{POSITION_COSINE, POSITION_SINE, Scale};
    use super::*;

    #[test]
    fn analytic_amplitude_and_phase_of_the_wave() {
        // Fpc = 0.5 cos 0.4, Fps = 0.5 sin 0.4: half a newton metre, largest at q/l = 0.4.
        for (q, qd) in [(0.02, 1.0), (0.02, -1.0), (0.13, 1.0)] {
            let shape = [Scale::new(0.0), Scale::new(0.05)];
            let x = TermInput { q, qd, qdd: 0.0, load: 0.0, warmth: 0.0, shape };
            let found = 0.5 * (libm::cos(0.4) * POSITION_COSINE.torque(&x) + libm::sin(0.4) * POSITION_SINE.torque(&x));
            assert!((found - 0.5 * libm::cos(q / 0.05 - 0.4) * qd).abs() < 1e-15, "{q} {found}");
        }
    }
}
