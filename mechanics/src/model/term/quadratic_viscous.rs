//! Viscous friction that grows with the square of speed, or less than in proportion to it.
//!
//! ```text
//! g = v |v|        φ = Fq        beside Fv
//! ```
//! Churned grease makes it positive. A negative one is the first bend of grease that shears thin; it is a fit within the speeds that were measured,
//! and gives energy beyond `Fv / |Fq|`.
//!
//! Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, *Automatica* 30(7), 1994; A. C. Bittencourt, S. Gunnarsson,
//! *J. Dyn. Syst. Meas. Control* 134(5), 2012, for the bend.

use super::entry::{ByJoint, Dimension, Dissipation, Prior, PriorOf, Sign, Structure, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;
use super::viscous::ViscousFriction;

/// See the module.
#[derive(Debug)]
pub struct QuadraticViscousFriction;

impl QuadraticViscousFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fq",
        name: "quadratic",
        meaning: "friction with the square of speed",
        group: "quadratic",
        dimension: Dimension { effort: 0, coordinate: 2, per_time: 2 },
        unit: ByJoint { revolute: "N·m·s²/rad²", prismatic: "N·s²/m²" },
        key: ByJoint { revolute: "quadratic_nm_s2_rad2", prismatic: "quadratic_n_s2_m2" },
        sign: Sign::Any,
        dissipation: Dissipation::No(
            "a negative coefficient bends viscous friction, and beyond its range outweighs it",
        ),
        structure: Structure::Function { family: "square of speed", odd: true },
        prior: Prior { key: "quadratic_nm_s2_rad2", of: PriorOf::Unit, default: Some(1.0) },
        ..ViscousFriction::ENTRY
    };
}

impl TermLaw for QuadraticViscousFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.qd * x.qd.magnitude()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{QUADRATIC_VISCOUS, Scale};
    use super::*;

    #[test]
    fn analytic_four_times_the_torque_at_twice_the_speed_against_the_motion() {
        let at = |qd: f64| {
            let shape = [Scale::new(0.0); 2];
            QUADRATIC_VISCOUS.torque(&TermInput { q: 0.3, qd, qdd: 0.0, load: 0.0, warmth: 0.0, shape })
        };
        assert_eq!((at(0.5), at(1.0), at(-2.0)), (0.25, 1.0, -4.0));
    }
}
