//! Friction that falls as it starts to move, of a motor that drives several joints.

use super::entry::{ByJoint, Place, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;
use super::stribeck::Stribeck;

/// The law of [`Stribeck`] in the motor's coordinate.
#[derive(Debug)]
pub struct MotorStribeck;

impl MotorStribeck {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fsm",
        meaning: "static above Coulomb friction of the motor",
        place: Place::CoupledMotor,
        key: ByJoint { revolute: "motor_stribeck_nm", prismatic: "motor_stribeck_n" },
        ..Stribeck::ENTRY
    };
}

impl TermLaw for MotorStribeck {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        Stribeck.law(x)
    }
}
