//! A constant torque, or an offset of the current sensor.
//!
//! ```text
//! g = 1        φ = Fo
//! ```

use super::entry::{
    ByJoint, Carrier, Dimension, Dissipation, Needs, Place, Prior, PriorOf, Sign, Structure, TermEntry,
};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct Offset;

impl Offset {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fo",
        name: "offset",
        meaning: "offset",
        group: "offsets",
        place: Place::Joint,
        carrier: Carrier::Link,
        dimension: Dimension { effort: 0, coordinate: 0, per_time: 0 },
        unit: ByJoint { revolute: "N·m", prismatic: "N" },
        key: ByJoint { revolute: "offset_nm", prismatic: "offset_n" },
        sign: Sign::Any,
        dissipation: Dissipation::No("a constant torque does work on the way and takes it on the way back"),
        structure: Structure::Constant,
        prior: Prior { key: "offset_nm", of: PriorOf::Unit, default: None },
        needs: Needs::MOTION,
        shapes: &[],
    };
}

impl TermLaw for Offset {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.qd.constant(1.0)
    }
}
