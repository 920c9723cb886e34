//! Coulomb friction of a joint.
//!
//! ```text
//! g = tanh(v / v_s)        φ = Fc
//! ```
//! The smooth sign with velocity scale `v_s`; the plain sign where `v_s` is 0, which no engine simulates.

use super::entry::{
    ByJoint, Carrier, Dimension, Dissipation, Needs, Place, Prior, PriorOf, ShapeParameter, Sign, Structure, TermEntry,
};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct CoulombFriction;

impl CoulombFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fc",
        name: "coulomb",
        meaning: "Coulomb friction",
        group: "Coulomb",
        place: Place::Joint,
        carrier: Carrier::Drive,
        dimension: Dimension { effort: 0, coordinate: 0, per_time: 0 },
        unit: ByJoint { revolute: "N·m", prismatic: "N" },
        key: ByJoint { revolute: "coulomb_nm", prismatic: "coulomb_n" },
        sign: Sign::NotNegative,
        dissipation: Dissipation::Always,
        structure: Structure::Function { family: "smooth sign", odd: true },
        prior: Prior { key: "coulomb", of: PriorOf::Value, default: None },
        needs: Needs::MOTION,
        shapes: &[ShapeParameter::COULOMB_VELOCITY],
    };
}

impl TermLaw for CoulombFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.qd.smooth_sign(x.shape[0])
    }
}
