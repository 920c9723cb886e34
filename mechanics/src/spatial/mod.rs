//! Six-dimensional vectors of rigid-body mechanics, placements of frames, and the inertia of one body.
//!
//! Angular part first, always: a motion is `(ω, v)`, a force `(n, f)`. `radkhah2007` writes its eqs. 2-4 force first,
//! `γ = (f, n)`; the permutation that swaps the two halves is the only difference.
//!
//! This module does not depend on robots. Reference: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, ch. 2.

mod inertia;
mod lane_motion;
mod log_cholesky;
mod placement;
mod vectors;

pub use inertia::{Inertia, InertiaError, PseudoInertia};
pub use lane_motion::{LaneForce, LaneMotion, LanePlacement, Three, cross, sum};
pub use log_cholesky::LogCholesky;
pub use placement::Placement;
pub use vectors::{Force, Motion};
