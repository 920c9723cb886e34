//! What a real arm does and an identification model leaves out, each a switch with a magnitude.
//!
//! | where it acts | effects |
//! |---|---|
//! | friction of the joints | Stribeck, load, warming |
//! | between motor and link | elasticity, hysteresis, backlash |
//! | torque of the motors | ripple, cogging, torque constant, current lag, current delay |
//! | what the plant is made of | tool, base tilt, kinematics |
//! | sensors and clock | encoder step, eccentricities, jitter, dropped samples, converter offset and step, coloured noise |
//!
//! They live around a [`Plant`](super::Plant), not in an engine, so that every engine has them alike. Without any the
//! servo computes what it always did, to the last bit.

mod kind;
mod level;
mod selection;

pub use kind::{EffectEntry, EffectKind};
pub use level::Level;
pub use selection::Effects;
