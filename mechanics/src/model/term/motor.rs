//! Friction of a motor that drives several joints: the law of a joint's friction in the motor's coordinate.
//!
//! ```text
//! g = g_joint(v)        v the motor's velocity, row of C q̇
//! ```

use super::coulomb::CoulombFriction;
use super::entry::{ByJoint, Place, TermEntry};
use super::input::TermInput;
use super::law::TermLaw;
use super::load_friction::LoadFriction;
use super::number::Number;
use super::stribeck::Stribeck;
use super::viscous::ViscousFriction;
use super::warm_viscous::WarmViscousFriction;

/// Makes the term of a motor from that of a joint, with its own symbol, meaning and keys for revolute and prismatic joints.
macro_rules! of_motors {
    ($($motor:ident of $joint:ident: $symbol:literal, $meaning:literal, $revolute:literal, $prismatic:literal;)*) => {$(
        #[doc = concat!("The law of [`", stringify!($joint), "`] in the motor's coordinate.")]
        #[derive(Debug)]
        pub struct $motor;

        impl TermLaw for $motor {
            const ENTRY: TermEntry = TermEntry {
                symbol: $symbol,
                meaning: $meaning,
                place: Place::CoupledMotor,
                key: ByJoint { revolute: $revolute, prismatic: $prismatic },
                ..$joint::ENTRY
            };

            #[inline(always)]
            fn law<R: Number>(&self, x: &TermInput<R>) -> R {
                $joint.law(x)
            }
        }
    )*};
}

of_motors! {
    MotorViscousFriction of ViscousFriction: "Fvm", "viscous friction of the motor",
        "motor_viscous_nm_s_rad", "motor_viscous_n_s_m";
    MotorCoulombFriction of CoulombFriction: "Fcm", "Coulomb friction of the motor", "motor_coulomb_nm", "motor_coulomb_n";
    MotorStribeck of Stribeck: "Fsm", "static above Coulomb friction of the motor", "motor_stribeck_nm", "motor_stribeck_n";
    MotorLoadFriction of LoadFriction: "Flm", "Coulomb friction of the motor per transmitted torque",
        "motor_load_friction", "motor_load_friction";
    MotorWarmViscousFriction of WarmViscousFriction: "Fwm", "viscous friction of the warm motor above the cold one's",
        "motor_warm_viscous_nm_s_rad", "motor_warm_viscous_n_s_m";
}
