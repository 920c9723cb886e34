//! The equations of motion of a serial arm: torque from motion, motion from torque, inertia and energy.
//!
//! ```text
//! τ = H(q) q̈ + c(q, q̇) + g(q) + τ_terms(q, q̇, q̈)
//! ```
//! `radkhah2007`'s Newton–Euler recursions (its eqs. 2–4), in frames that stand on the joints ([`chain`]).
//! Spatial vectors are angular first, `γ = (n, f)`; `radkhah2007` writes force first, `γ = (f, n)`. With
//! `P = [0 1; 1 0]` (3×3 blocks) that swaps the halves, `radkhah2007`'s `D` of eq. 4 is `P X* P` of ours: the permutation
//! is stated here once and used nowhere. The base frame's acceleration is minus gravity, so weight needs no term.
//!
//! Everything else (rotor inertia, friction, offset, springs, coupled motors) is a
//! [torque term](crate::model::term) beside the recursion, never inside it.
//! Not modelled: elasticity, backlash, gyroscopic torque of fast rotors, contact.
//!
//! References: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, ch. 5 (RNEA), 6 (CRBA), 7 (ABA);
//! W. Khalil, E. Dombre, *Modeling, Identification and Control of Robots*, 2002, ch. 9.

mod articulated;
pub mod chain;
mod composite;
mod energy;
mod inverse;
#[cfg(test)]
mod law_tests;
mod link_pose;
mod link_step;
mod model;
mod placed_term;
mod simulable;
mod symmetric;
mod together;
mod torque_difference;
mod torque_terms;
mod turns;

pub use crate::trajectory::States;
pub use energy::Energy;
pub use link_pose::LinkPose;
pub use model::Dynamics;
pub use placed_term::PlacedTerm;
pub use simulable::{TermError, check_simulable};
pub(crate) use together::{TOGETHER, Together, samples_of};
pub use torque_difference::TorqueDifference;
pub use torque_terms::{TermState, TorqueTerms};
