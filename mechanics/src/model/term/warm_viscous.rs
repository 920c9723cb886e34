//! Viscous friction that changes as the gear warms up.
//!
//! ```text
//! g = w v        φ = Fw, viscous friction of the warm gear less that of the cold one
//! ```
//! `w` is the temperature of the gear above that of a cold one, 1 at its rated power. Without a record of temperature
//! nothing of it shows, and the gear counts as cold.

use super::entry::{ByJoint, Dissipation, Needs, Prior, PriorOf, Sign, Structure, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;
use super::viscous::ViscousFriction;

/// See the module.
#[derive(Debug)]
pub struct WarmViscousFriction;

impl WarmViscousFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fw",
        name: "warming",
        meaning: "viscous friction of the warm gear above the cold one's",
        group: "warming",
        key: ByJoint { revolute: "warm_viscous_nm_s_rad", prismatic: "warm_viscous_n_s_m" },
        sign: Sign::Any,
        dissipation: Dissipation::Beside("Fv"),
        structure: Structure::Function { family: "warmth", odd: true },
        prior: Prior { key: "warm_viscous_nm_s_rad", of: PriorOf::Unit, default: Some(1.0) },
        needs: Needs { warmth: true, ..Needs::MOTION },
        ..ViscousFriction::ENTRY
    };
}

impl TermLaw for WarmViscousFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.warmth * x.qd
    }
}
