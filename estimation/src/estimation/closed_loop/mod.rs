//! Estimators that simulate the arm in closed loop with its known servo.
//!
//! ```text
//! r(t) → servo → τ_s(β) → arm(β) → q_s(β)        the same reference, start and servo as the recording's
//! iv      Zᵀ Σ⁻¹ (y − W β) = 0                   Z = W(q_s, q̇_s, q̈_s)
//! didim   min ‖y − τ_s(β)‖_Σ, ∂τ_s/∂β ≈ Z        clie   the same, ∂τ_s/∂β exact        cloe   min ‖q − q_s(β)‖
//! ```
//! A [`ClosedLoop`] simulates; β becomes a full set of standard parameters by the smallest change of the nominal set
//! ([`crate::estimation::complete`]), since the motion depends on β alone. A trial whose mass matrix is not positive definite, or
//! whose motion runs away, is a rejected step. A search begins at weighted least squares, unless the problem holds a
//! [start](crate::estimation::EstimationProblem::start).

pub(super) mod clie;
pub(super) mod cloe;
mod commanded;
mod descent;
pub(super) mod didim;
mod endogeneity;
mod error;
mod hidden;
mod instrumental_fit;
pub(super) mod iv;
mod shooting;
mod simulation;
mod starting_point;
mod torque_error;
mod trial;

pub use error::ClosedLoopError;
pub(super) use instrumental_fit::InstrumentalFit;
pub use simulation::{
    ClosedLoop, ClosedLoopFactory, ClosedLoopInterval, ClosedLoopIntervals, ClosedLoopMotion, ClosedLoopNode,
    ClosedLoopReference, ClosedLoopSlopes, CommandedLoop, closed_loop_of, commanded_loop_of,
};
pub(super) use torque_error::{TorqueSearch, TorqueSlope, search as torque_search};
