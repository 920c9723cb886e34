//! Coulomb friction that grows with the transmitted torque, of a motor that drives several joints.

use super::entry::{ByJoint, Place, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::load_friction::LoadFriction;
use super::number::Number;

/// The law of [`LoadFriction`] in the motor's coordinate.
#[derive(Debug)]
pub struct MotorLoadFriction;

impl MotorLoadFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Flm",
        meaning: "Coulomb friction of the motor per transmitted torque",
        place: Place::CoupledMotor,
        key: ByJoint { revolute: "motor_load_friction", prismatic: "motor_load_friction" },
        ..LoadFriction::ENTRY
    };
}

impl TermLaw for MotorLoadFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        LoadFriction.law(x)
    }
}
