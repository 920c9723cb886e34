//! The physically consistent set of standard parameters that agrees best with an estimate.
//!
//! ```text
//! χ²(φ) = (K φ − β̂)ᵀ C⁻¹ (K φ − β̂)        D(φ) = Σ_links ( tr(P₀⁻¹ P) − ln det P ) + Σ_drives ( x/x₀ − ln x )
//! φ* = lim_{λ→∞} argmin ½ λ χ²(φ) + D(φ)
//! ```
//! P is a link's pseudo-inertia and P₀ that of the guess; x is a rotor inertia or a friction, never negative; C is the
//! covariance of the estimate. D is least at the guess itself, does not depend on frames or units, and grows without bound
//! towards the boundary of the consistent parameters. The limit is the set that agrees best with the estimate among all
//! that are consistent, which is what a semidefinite program gives, and where several agree alike, the one nearest to
//! the guess.
//!
//! D is a self-concordant barrier, so the limit is reached along the path of minimisers for growing λ, by Newton steps
//! whose length guarantees a decrease ([`newton`]). The search ends where K φ = β̂ holds exactly, or where the duality
//! gap says that no consistent set up to ten times as far from the guess has a χ² lower by more than 1 %.
//!
//! References: T. Lee, P. M. Wensing, F. C. Park, "Geometric robot dynamic identification: a convex programming approach",
//! IEEE Trans. Robotics 36(2), 2020, for D; S. Boyd, L. Vandenberghe, "Convex Optimization", Cambridge, 2004, sections 9.6
//! and 11.3, for the path.

mod distance;
mod newton;
mod set;
#[cfg(test)]
mod clarabel_tests;
#[cfg(test)]
pub(super) mod fixtures;

pub use set::{ConsistentSet, consistent_set};
