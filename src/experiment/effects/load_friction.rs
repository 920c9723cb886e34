//! Coulomb friction that grows with the torque that goes through the gear.
//!
//! ```text
//! τ_L = μ |τ_t| sgn(q̇)      τ_t what the links take: M_l q̈ + c + g, without rotor and friction
//! ```
//! Source: A. C. Bittencourt, S. Gunnarsson, "Static friction in a robot joint", *J. Dyn. Syst. Meas. Control* 134(5), 2012:
//! Coulomb friction linear in the load, some hundredths of it.

use crate::model::smooth_sign;

/// What a transmitted torque `load` (N·m) adds to the friction of a joint at speed `v`, N·m.
pub(super) fn excess(per_torque: f64, load: f64, v: f64, coulomb_velocity: f64) -> f64 {
    per_torque * load.abs() * smooth_sign(v, coulomb_velocity)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_friction_follows_the_load_and_opposes_the_motion() {
        assert!((excess(0.05, -20.0, 1.0, 0.01) - 1.0).abs() < 1e-15);
        assert!((excess(0.05, 20.0, -1.0, 0.01) + 1.0).abs() < 1e-15);
        assert!(excess(0.05, 20.0, 0.0, 0.01).abs() < 1e-300);
    }
}
