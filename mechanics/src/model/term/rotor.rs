//! Inertia of a rotor, seen at the joint through its gear.
//!
//! ```text
//! g = a        φ = Ia = J_m N²
//! ```
//! By d'Alembert's principle a motor that drives several joints loads each of them. Gyroscopic torque of fast rotors is
//! left out. Source: W. Khalil, E. Dombre, *Modeling, Identification and Control of Robots*, 2002, sec. 9.4.4.

use super::entry::{
    ByJoint, Carrier, Dimension, Dissipation, Needs, Place, Prior, PriorOf, Sign, Structure, TermEntry,
};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct RotorInertia;

impl RotorInertia {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Ia",
        name: "rotor",
        meaning: "rotor inertia",
        group: "rotors",
        place: Place::Motor,
        carrier: Carrier::Drive,
        dimension: Dimension { effort: 0, coordinate: 1, per_time: 2 },
        unit: ByJoint { revolute: "kg·m²", prismatic: "kg" },
        key: ByJoint { revolute: "rotor_kg_m2", prismatic: "rotor_kg" },
        sign: Sign::NotNegative,
        dissipation: Dissipation::Stores,
        structure: Structure::Inertia,
        prior: Prior { key: "rotor", of: PriorOf::Value, default: None },
        needs: Needs::MOTION,
        shapes: &[],
    };
}

impl TermLaw for RotorInertia {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.qdd
    }

    fn energy(&self, x: &TermInput<f64>) -> f64 {
        0.5 * x.qd * x.qd
    }
}
