//! Time by which a reported torque leads the one that acts.
//!
//! ```text
//! τ_reported = τ + T dτ/dt        φ = Tl, T of each motor, s        above zero: the report is early, as a set point of current is
//! ```
//! Exact for a current loop of first order with time constant T, whose set point is reported; of a delay T it is the first term of
//! `τ(t + T)`. Where the reported torque is late (a filtered reading) T is below zero.
//!
//! The torque changes with all parameters at once, so that no law of one moment gives this column: the term is in no list, no engine and no file
//! of parameters has it, and `estimation::select` finds its column.

use super::entry::{ByJoint, Dimension, Dissipation, Needs, Place, Prior, PriorOf, Sign, Structure, TermEntry};
use super::handle::Term;
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;
use super::viscous::ViscousFriction;

/// See the module.
#[derive(Debug)]
pub struct CurrentLag;

/// Time by which the reported torque leads; in no list.
pub const CURRENT_LAG: Term = Term::new(&CurrentLag);

impl CurrentLag {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Tl",
        name: "current-lag",
        meaning: "time by which the reported torque leads the one that acts",
        group: "current lag",
        place: Place::Motor,
        dimension: Dimension { effort: 1, coordinate: 0, per_time: 1 },
        unit: ByJoint { revolute: "s", prismatic: "s" },
        key: ByJoint { revolute: "current_lag_s", prismatic: "current_lag_s" },
        sign: Sign::Any,
        dissipation: Dissipation::No("it is no torque of the arm but an error of its report"),
        structure: Structure::Function { family: "current-lag", odd: false },
        prior: Prior { key: "current_lag_s", of: PriorOf::Unit, default: Some(0.01) },
        needs: Needs { rate: true, ..Needs::MOTION },
        shapes: &[],
        ..ViscousFriction::ENTRY
    };
}

impl TermLaw for CurrentLag {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    /// Zero: the arm itself has no such torque.
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.qd.constant(0.0)
    }
}
