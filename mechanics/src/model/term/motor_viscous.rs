//! Viscous friction of a motor that drives several joints.
//!
//! ```text
//! g = v        φ = Fvm        v the motor's velocity, row of C q̇
//! ```

use super::entry::{ByJoint, Place, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;
use super::viscous::ViscousFriction;

/// See the module.
#[derive(Debug)]
pub struct MotorViscousFriction;

impl MotorViscousFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fvm",
        meaning: "viscous friction of the motor",
        place: Place::CoupledMotor,
        key: ByJoint { revolute: "motor_viscous_nm_s_rad", prismatic: "motor_viscous_n_s_m" },
        ..ViscousFriction::ENTRY
    };
}

impl TermLaw for MotorViscousFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        ViscousFriction.law(x)
    }
}
