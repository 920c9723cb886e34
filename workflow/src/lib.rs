//! What the command `armid` does, as functions: settings in, a plain answer out.
//!
//! | to | call |
//! |---|---|
//! | find the base parameters | [`reduce`] |
//! | simulate a loaded robot | [`simulated_arm`], [`simulate`] |
//! | design a trajectory | [`design::design`] |
//! | identify a log | [`identification::identify`] |
//! | perform a study | [`study::perform`], [`study::merge`], [`study::forecast`] |
//!
//! Work that takes long reports to an [`Observer`](armid::observer::Observer), which may end it. Nothing here knows a terminal.

mod counter;
pub mod design;
pub mod identification;
mod reduction;
mod simulation;
pub mod study;

pub use reduction::{ReductionAnswer, ReductionSettings, reduce};
pub use simulation::{Simulated, SimulationSettings, simulate, simulated_arm};
