//! Does the arm keep clear of itself and of what stands around it, at every instant?
//!
//! ```text
//! d(t) ≥ d(t_m) − Σ_j R_j ( |q̇_j(t_m)| h + ½ q̈_j,max h² )        for |t − t_m| ≤ h
//! ```
//! R_j bounds how far a point of the moving body can be from the axis of joint j, so the right-hand side bounds the
//! distance between samples; halving h until it meets the value makes the bound as tight as one likes. Distances are
//! those of `parry3d`; their slopes follow from the kinematics, `∂d/∂q_j = n · (z_j × (p − o_j))`.

mod body;
mod limits;
mod scene;
mod sweep;
mod touching;

#[cfg(test)]
mod hull_tests;

pub use body::Separation;
pub use limits::ClearanceLimits;
pub use scene::{Pair, Scene};
pub use sweep::{CLEARANCE_TOLERANCE, WorstClearance, smallest_clearance};
pub use touching::{TouchingLinks, touching_links};
