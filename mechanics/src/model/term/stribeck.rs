//! Friction that falls as a joint starts to move.
//!
//! ```text
//! g = exp(−(v/v_S)²) tanh(v / v_s)        φ = Fs = static friction − Fc
//! ```
//! on top of `Fc` and `Fv`. At speeds far above `v_S` nothing is left of it.
//!
//! Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, *Automatica* 30(7), 1994, eq. 6 with exponent 2; `v_S` of
//! the size that TUM-ICS/BIRDy states for the TX40.

use super::coulomb::CoulombFriction;
use super::entry::{ByJoint, Dissipation, Prior, PriorOf, ShapeParameter, Structure, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct Stribeck;

impl Stribeck {
    /// Speed at which 1/e of it is left.
    pub const VELOCITY: ShapeParameter = ShapeParameter {
        key: "stribeck_velocity_rad_s",
        meaning: "Stribeck velocity, rad/s (m/s)",
        default: 0.05,
        smooths: false,
    };

    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fs",
        name: "stribeck",
        meaning: "static above Coulomb friction",
        group: "Stribeck",
        key: ByJoint { revolute: "stribeck_nm", prismatic: "stribeck_n" },
        dissipation: Dissipation::Always,
        structure: Structure::Function { family: "Stribeck", odd: true },
        prior: Prior { key: "stribeck", of: PriorOf::Value, default: Some(0.5) },
        shapes: &[ShapeParameter::COULOMB_VELOCITY, Self::VELOCITY],
        ..CoulombFriction::ENTRY
    };
}

impl TermLaw for Stribeck {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        let speed = x.qd.over(x.shape[1]);
        (-speed * speed).exponential() * x.qd.smooth_sign(x.shape[0])
    }
}

#[cfg(test)]
mod tests {
    use super::super::{STRIBECK, Scale};
    use super::*;

    #[test]
    fn published_curve_at_given_speeds() {
        // exp(−x²) at x = 0.5, 1, 2 from tables: 0.778801, 0.367879, 0.018316. The plain sign: v_s = 0.
        for (x, value) in [(0.5, 0.778_801), (1.0, 0.367_879), (2.0, 0.018_316)] {
            let at = |qd: f64| {
                let shape = [Scale::new(0.0), Scale::new(0.05)];
                STRIBECK.torque(&TermInput { q: 0.0, qd, qdd: 0.0, load: 0.0, warmth: 0.0, shape })
            };
            assert!((at(0.05 * x) - value).abs() < 1e-6 && (at(-0.05 * x) + value).abs() < 1e-6);
        }
    }
}
