//! Coulomb friction of a motor that drives several joints.
//!
//! ```text
//! g = tanh(v / v_s)        φ = Fcm        v the motor's velocity, row of C q̇
//! ```

use super::{ByJoint, CoulombFriction, Number, Place, TermEntry, TermInput, TermLaw};

/// See the module.
#[derive(Debug)]
pub struct MotorCoulombFriction;

impl TermLaw for MotorCoulombFriction {
    const ENTRY: TermEntry = TermEntry {
        symbol: "Fcm",
        meaning: "Coulomb friction of the motor",
        place: Place::CoupledMotor,
        key: ByJoint { revolute: "motor_coulomb_nm", prismatic: "motor_coulomb_n" },
        ..CoulombFriction::ENTRY
    };

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        CoulombFriction.law(x)
    }
}
