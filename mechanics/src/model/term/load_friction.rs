//! Coulomb friction that grows with the torque that goes through the gear.
//!
//! ```text
//! g = |τ_t| tanh(v / v_s)        φ = Fl, friction per transmitted torque
//! ```
//! `τ_t` is what the links take, `M_l q̈ + c + g`, without rotor and friction.
//!
//! Source: A. C. Bittencourt, S. Gunnarsson, "Static friction in a robot joint", *J. Dyn. Syst. Meas. Control* 134(5), 2012:
//! Coulomb friction linear in the load, some hundredths of it.

use super::coulomb::CoulombFriction;
use super::entry::{ByJoint, Dimension, Dissipation, Needs, Prior, PriorOf, ShapeParameter, Structure, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct LoadFriction;

impl LoadFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fl",
        name: "load",
        meaning: "Coulomb friction per transmitted torque",
        group: "load friction",
        dimension: Dimension { effort: 1, coordinate: 0, per_time: 0 },
        unit: ByJoint { revolute: "1", prismatic: "1" },
        key: ByJoint { revolute: "load_friction", prismatic: "load_friction" },
        dissipation: Dissipation::Always,
        structure: Structure::Function { family: "load", odd: true },
        prior: Prior { key: "load_friction", of: PriorOf::Value, default: Some(0.5) },
        needs: Needs { load: true, ..Needs::MOTION },
        shapes: &[ShapeParameter::COULOMB_VELOCITY],
        ..CoulombFriction::ENTRY
    };
}

impl TermLaw for LoadFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.load.magnitude() * x.qd.smooth_sign(x.shape[0])
    }
}
