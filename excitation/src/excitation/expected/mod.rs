//! Which torque does an effect add that the model has no parameter for, along a motion, by the nominal parameters?
//!
//! ```text
//! d(q, q̇, q̈) = τ(arm with the effect) − τ(arm without)        for the motion that the encoders show
//! ```
//! Before the arm moves nobody knows its parameters; those that an experimenter would guess stand for them. Each effect is
//! the torque term that defines it, or the plant with what it adds, solved along one period ([`EffectLaw`]). Which effects
//! an arm has, and how strong, is declared: `experiment::effects` has the list.

mod effect;
mod periodic_derivative;
mod torques;
mod warm_gears;

pub use effect::{EffectLaw, ExpectedEffect, ExpectedEffects};
pub use torques::EffectTorques;
pub use warm_gears::{WarmGear, WarmGears};
