//! Coulomb friction that differs between the two directions.
//!
//! ```text
//! g = tanh²(v / v_s)        φ = Fd = (Fc⁺ − Fc⁻)/2        beside Fc = (Fc⁺ + Fc⁻)/2
//! ```
//! so that friction is `Fc⁺` in the positive direction, `Fc⁻` in the negative, and nothing at rest. Away from standstill
//! its law is 1, that of an offset: data distinguish the two only by what happens within a few `v_s`, or not at all where
//! `v_s` is 0. Its slope is at most 0.77 times that of Coulomb friction of the same size.
//!
//! Source: P. I. Corke, B. Armstrong-Hélouvry, ICRA 1994, give both directions for every joint of the PUMA 560.

use super::coulomb::CoulombFriction;
use super::entry::{ByJoint, Dissipation, Prior, PriorOf, Sign, Structure, TermEntry};
use super::input::{Shapes, TermInput};
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct CoulombDirection;

impl TermLaw for CoulombDirection {
    const ENTRY: TermEntry = TermEntry {
        symbol: "Fd",
        name: "direction",
        meaning: "Coulomb friction forward above mean",
        group: "direction",
        key: ByJoint { revolute: "coulomb_direction_nm", prismatic: "coulomb_direction_n" },
        sign: Sign::Any,
        dissipation: Dissipation::Beside("Fc"),
        structure: Structure::Function { family: "squared smooth sign", odd: false },
        prior: Prior { key: "coulomb_direction_nm", of: PriorOf::Unit, default: Some(0.5) },
        ..CoulombFriction::ENTRY
    };

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        let sign = x.qd.smooth_sign(x.shape[0]);
        sign * sign
    }

    fn structure_at(&self, shape: &Shapes) -> Structure {
        // The square of the plain sign is 1 wherever anything is sampled.
        if shape[0].value == 0.0 { Structure::Constant } else { Self::ENTRY.structure }
    }
}
