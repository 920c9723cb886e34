//! The closed loop of estimators that simulate: the servo of the core around the analytic plant, along the plans of recordings.
//!
//! ```text
//! plan → commands → servo(nominal gains) ⇄ arm(φ) → q, q̇, q̈, τ of one mean period, and ∂q/∂φ, ∂τ/∂φ
//! ```
//! Logs of commanded positions are followed by position servos instead (`commanded`).
//! The loop is that of [`armid::experiment::Servo`] with ideal sensors: the same controller, limits, phases and start.

mod bodies;
mod commanded;
mod intervals;
mod period_mean;
mod simulated_loop;
mod walk;

pub use simulated_loop::{SimulatedLoop, closed_loop};
