//! Friction that falls as a joint sets off.
//!
//! ```text
//! τ_S = s Fc exp(−(q̇/v_S)²) sgn(q̇)      sgn smooth, v_S = 0.05 rad/s (m/s)
//! ```
//! on top of `Fc sgn(q̇) + Fv q̇`, `s` the share. At speeds far above `v_S` nothing is left of it.
//!
//! Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, *Automatica* 30(7), 1994, eq. 6 with exponent 2; `v_S` of
//! the size that TUM-ICS/BIRDy states for the TX40.

use crate::model::smooth_sign;

/// Stribeck velocity, rad/s (m/s).
pub(super) const VELOCITY: f64 = 0.05;

/// What stiction adds to the friction of a joint of Coulomb friction `coulomb` (N·m) at speed `v`, N·m.
pub(super) fn excess(share: f64, coulomb: f64, v: f64, coulomb_velocity: f64) -> f64 {
    let x = v / VELOCITY;
    share * coulomb * libm::exp(-x * x) * smooth_sign(v, coulomb_velocity)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_curve_at_given_speeds() {
        // exp(−x²) at x = 0.5, 1, 2 from tables: 0.778801, 0.367879, 0.018316. The plain sign: v_c = 0.
        for (x, value) in [(0.5, 0.778_801), (1.0, 0.367_879), (2.0, 0.018_316)] {
            assert!((excess(0.4, 5.0, x * VELOCITY, 0.0) - 2.0 * value).abs() < 1e-6 * 2.0);
            assert!((excess(0.4, 5.0, -x * VELOCITY, 0.0) + 2.0 * value).abs() < 1e-6 * 2.0);
        }
        assert!(excess(0.4, 5.0, 0.0, 0.01).abs() < 1e-300);
    }
}
