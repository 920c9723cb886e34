//! Viscous friction of a joint.
//!
//! ```text
//! g = v        φ = Fv
//! ```

use super::coulomb::CoulombFriction;
use super::entry::{ByJoint, Dimension, Prior, PriorOf, Structure, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct ViscousFriction;

impl TermLaw for ViscousFriction {
    const ENTRY: TermEntry = TermEntry {
        symbol: "Fv",
        name: "viscous",
        meaning: "viscous friction",
        group: "viscous",
        dimension: Dimension { effort: 0, coordinate: 1, per_time: 1 },
        unit: ByJoint { revolute: "N·m·s/rad", prismatic: "N·s/m" },
        key: ByJoint { revolute: "viscous_nm_s_rad", prismatic: "viscous_n_s_m" },
        structure: Structure::Viscous,
        prior: Prior { key: "viscous", of: PriorOf::Value, default: None },
        shapes: &[],
        ..CoulombFriction::ENTRY
    };

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.qd
    }
}
