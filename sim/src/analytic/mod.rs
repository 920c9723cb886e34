//! The embedded simulator: own forward dynamics, Runge–Kutta of order 4, smooth Coulomb friction.
//!
//! ```text
//! H(q) q̈ + c(q, q̇) + g(q) + Fv q̇ + Fc tanh(q̇ / v_s) + Fo = τ          H with rotor inertia
//! ```
//! Written for one purpose, thousands of closed-loop experiments: no allocation, no branch on data, sizes known when
//! compiled. Its forward dynamics share no code with the core's
//! ([`armid::dynamics::Dynamics::forward`]); the two are compared in tests.
//!
//! Not modelled: elasticity, backlash, stiction beyond the smooth law, contact, motor electrics.

mod chain;
mod forward;
mod factor;
mod forces;
mod integrator;
mod jet;
mod law_numbers;
mod plant;
mod runs;
mod slopes;
mod team;

pub use plant::{AnalyticError, AnalyticPlant, MOST_JOINTS};
pub(crate) use runs::record_runs_watched;
pub use runs::{BatchRun, perform_runs, record_runs};
pub(crate) use slopes::{SlopedArm, sloped_arm};
pub use team::AnalyticBatch;
