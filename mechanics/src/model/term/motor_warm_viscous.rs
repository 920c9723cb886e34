//! Viscous friction that changes as it warms up, of a motor that drives several joints.

use super::entry::{ByJoint, Place, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;
use super::warm_viscous::WarmViscousFriction;

/// The law of [`WarmViscousFriction`] in the motor's coordinate.
#[derive(Debug)]
pub struct MotorWarmViscousFriction;

impl MotorWarmViscousFriction {
    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Fwm",
        meaning: "viscous friction of the warm motor above the cold one's",
        place: Place::CoupledMotor,
        key: ByJoint { revolute: "motor_warm_viscous_nm_s_rad", prismatic: "motor_warm_viscous_n_s_m" },
        ..WarmViscousFriction::ENTRY
    };
}

impl TermLaw for MotorWarmViscousFriction {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        WarmViscousFriction.law(x)
    }
}
