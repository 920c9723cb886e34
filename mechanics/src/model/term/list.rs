//! The list of terms. A new one is its file, its `mod` line, and its line here.

use super::handle::Term;
use super::input::{Runs, TermInput};
use super::law::TermLaw;

macro_rules! terms {
    ($($(#[$doc:meta])* $name:ident: $law:ident;)*) => {
        /// A term of the list.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Listed {
            $($law,)*
        }

        $($(#[$doc])* pub const $name: Term = Term { law: &super::$law, listed: Some(Listed::$law) };)*

        impl Term {
            /// Every term of the list, in the order of the columns of a joint.
            pub const ALL: &'static [Self] = &[$($name,)*];

            /// Gives the law of each of N coordinates, in several runs at once, to `take`.
            #[inline(always)]
            pub fn torques_of_runs<R: Runs, const N: usize>(
                self,
                input: impl Fn(usize) -> TermInput<R>,
                mut take: impl FnMut(usize, R),
            ) {
                // Loops: the closure of an array's maker is compiled without the processor's lanes, each product a call.
                match self.listed {
                    $(Some(Listed::$law) => {
                        for i in 0..N {
                            take(i, super::$law.law(&input(i)));
                        }
                    })*
                    None => {
                        for i in 0..N {
                            take(i, R::apart(&input(i), |x| self.torque(x)));
                        }
                    }
                }
            }
        }
    };
}

// The order is that of a joint's columns: in stored results it may only be added to.
terms! {
    /// Inertia of the rotor.
    ROTOR: RotorInertia;
    /// Viscous friction of the joint.
    VISCOUS: ViscousFriction;
    /// Coulomb friction of the joint.
    COULOMB: CoulombFriction;
    /// Constant torque, or offset of the current sensor.
    OFFSET: Offset;
    /// Viscous friction of a coupled motor.
    MOTOR_VISCOUS: MotorViscousFriction;
    /// Coulomb friction of a coupled motor.
    MOTOR_COULOMB: MotorCoulombFriction;
    /// Friction that falls as a joint starts to move.
    STRIBECK: Stribeck;
    /// Friction that falls as a joint starts to move, of a coupled motor.
    MOTOR_STRIBECK: MotorStribeck;
    /// Coulomb friction that grows with the transmitted torque.
    LOAD_FRICTION: LoadFriction;
    /// Coulomb friction that grows with the transmitted torque, of a coupled motor.
    MOTOR_LOAD_FRICTION: MotorLoadFriction;
    /// Viscous friction that changes as the gear warms up.
    WARM_VISCOUS: WarmViscousFriction;
    /// Viscous friction that changes as the gear warms up, of a coupled motor.
    MOTOR_WARM_VISCOUS: MotorWarmViscousFriction;
    /// Coulomb friction that differs between the two directions.
    COULOMB_DIRECTION: CoulombDirection;
    /// A spring to a joint.
    SPRING: JointSpring;
    /// Friction that grows with the square of speed.
    QUADRATIC_VISCOUS: QuadraticViscousFriction;
    /// Coulomb friction that depends on position: its cosine.
    POSITION_COSINE: PositionCosine;
    /// Coulomb friction that depends on position: its sine.
    POSITION_SINE: PositionSine;
}
