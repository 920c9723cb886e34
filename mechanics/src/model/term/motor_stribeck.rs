//! Friction that falls as it starts to move, of a motor that drives several joints.

use super::{ByJoint, Number, Place, Stribeck, TermEntry, TermInput, TermLaw};

/// The law of [`Stribeck`] in the motor's coordinate.
#[derive(Debug)]
pub struct MotorStribeck;

impl TermLaw for MotorStribeck {
    const ENTRY: TermEntry = TermEntry {
        symbol: "Fsm",
        meaning: "static above Coulomb friction of the motor",
        place: Place::CoupledMotor,
        key: ByJoint { revolute: "motor_stribeck_nm", prismatic: "motor_stribeck_n" },
        ..Stribeck::ENTRY
    };

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        Stribeck.law(x)
    }
}
