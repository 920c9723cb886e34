//! Viscous friction of a joint.
//!
//! ```text
//! g = v        φ = Fv
//! ```

use super::entry::{
    ByJoint, Carrier, Dimension, Dissipation, Needs, Place, Prior, PriorOf, Sign, Structure, TermEntry,
};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct ViscousFriction;

impl ViscousFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fv",
        name: "viscous",
        meaning: "viscous friction",
        group: "viscous",
        place: Place::Joint,
        carrier: Carrier::Drive,
        dimension: Dimension { effort: 0, coordinate: 1, per_time: 1 },
        unit: ByJoint { revolute: "N·m·s/rad", prismatic: "N·s/m" },
        key: ByJoint { revolute: "viscous_nm_s_rad", prismatic: "viscous_n_s_m" },
        sign: Sign::NotNegative,
        dissipation: Dissipation::Always,
        structure: Structure::Viscous,
        prior: Prior { key: "viscous", of: PriorOf::Value, default: None },
        needs: Needs::MOTION,
        shapes: &[],
    };
}

impl TermLaw for ViscousFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.qd
    }
}
