//! Coulomb friction of a motor that drives several joints.
//!
//! ```text
//! g = tanh(v / v_s)        φ = Fcm        v the motor's velocity, row of C q̇
//! ```

use super::coulomb::CoulombFriction;
use super::entry::{ByJoint, Place, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct MotorCoulombFriction;

impl MotorCoulombFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fcm",
        meaning: "Coulomb friction of the motor",
        place: Place::CoupledMotor,
        key: ByJoint { revolute: "motor_coulomb_nm", prismatic: "motor_coulomb_n" },
        ..CoulombFriction::ENTRY
    };
}

impl TermLaw for MotorCoulombFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        CoulombFriction.law(x)
    }
}
