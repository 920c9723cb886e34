//! What a real arm does and an identification model leaves out, each a switch with a magnitude.
//!
//! | where it acts | effects |
//! |---|---|
//! | friction of the joints | Stribeck, load, direction, position, presliding, warming |
//! | between motor and link | elasticity, hysteresis, backlash, transmission error |
//! | torque of the motors | ripple, cogging, torque constant, current lag, current delay |
//! | what the plant is made of | tool, cable, base tilt, kinematics |
//! | sensors and clock | encoder step, eccentricities, jitter, dropped samples, clock slips, converter offset and step, coloured noise, white noise, spikes |
//!
//! They live around a [`Plant`](super::Plant), not in an engine, so that every engine has them alike: an [`ActualArm`]
//! changes what the plant is built from, and a [`Servo`](super::Servo) with it changes torques, encoders and samples.
//! Effects on friction and the spring of a cable are coefficients of [torque terms](crate::model::term) that the truth has and
//! the identification model lacks; only their sizes stand here. Load, temperature, displacement and springs need more than one
//! step of the plant in a servo step; how many follows from their stiffness. Without any effect the servo's numbers are
//! unchanged, to the last bit.
//!
//! What belongs to one arm (signs, phases) is drawn from the seed of its effects; what belongs to one run (jitter, losses,
//! noise) from the servo's seed and run.

mod actual_arm;
mod backlash;
mod base_tilt;
mod cable;
mod clock_slips;
mod coloured_noise;
mod current_loop;
mod direction_friction;
mod draw;
mod drive_friction;
mod drives;
mod eccentricity;
mod elasticity;
mod expected;
mod hysteresis;
mod kind;
mod kinematics;
mod level;
mod position_friction;
mod presliding;
mod ripple;
mod sample_clock;
mod selection;
mod spikes;
mod tool;
mod torque_constant;
mod transmission_error;
mod uneven_links;
mod warming;

pub use actual_arm::ActualArm;
pub(super) use actual_arm::ActualSensors;
pub(super) use clock_slips::ClockSlips;
pub(super) use coloured_noise::Memory;
pub(super) use drives::ActualDrives;
pub(super) use eccentricity::Eccentricity;
pub use expected::ExpectedEffectError;
pub use kind::{EffectEntry, EffectKind};
pub use level::Level;
pub(super) use sample_clock::SampleClock;
pub use selection::Effects;
pub(super) use spikes::Spikes;
