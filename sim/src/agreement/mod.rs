//! How far do the simulated arms agree?
//!
//! ```text
//! equations      RNEA(q, q̇, q̈_engine) − τ                              at random states, relative
//! free motion    max |q_engine(t; h) − q_reference(t)| ~ C hᵖ          h halved again and again: p and C
//! energy         |E(t) − E(0)| in free motion, relative to the energy that moved
//! closed loop    max |q_engine − q_other| along an experiment, servo and friction included
//! ```
//! Free motion has no torque, no friction and a short horizon, so that the order of a method shows. The reference is a
//! Runge–Kutta method over the core's articulated-body algorithm with steps so fine that its own error, measured by
//! halving them, is rounding: it shares no code with any engine. In the closed loop torque is
//! held over a servo step, which makes every engine first order there: only differences are given.
//!
//! What an engine must reach is in `tolerance`, with reasons. Not covered: contacts, which no engine here has.

mod case;
mod certificate;
mod closed_loop;
mod equations;
mod free_motion;
mod motion;
mod reference;
mod tolerance;

pub use case::Case;
pub use certificate::{Absent, Agreement, Breach, EngineAgreement, PairDifference, agree};
pub use free_motion::StepError;
pub use motion::safe_motion;
pub use tolerance::Tolerance;
