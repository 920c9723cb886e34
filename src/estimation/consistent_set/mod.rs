//! A full, physically consistent set of standard parameters, as close to a guess as the estimate allows.
//!
//! ```text
//! minimise   Σ_links ( tr(P₀⁻¹ P) − ln det P ) + Σ_drives ( x/x₀ − ln x )     subject to   K φ = β̂
//! ```
//! P is a link's pseudo-inertia and P₀ that of the guess; x is a rotor inertia or a friction, never negative. This
//! distance is least at the guess itself, does not depend on frames or units, and grows without bound towards what no
//! body can have, so its minimum is consistent. Where no consistent set has exactly the estimated base parameters, the
//! equation is replaced by `½ λ rᵀ C⁻¹ r` with `r = K φ − β̂` and the covariance C of the estimate, for the smallest λ of
//! a series with which every base parameter stays inside its 95 % interval; or, where there is none, the largest.
//!
//! Reference: T. Lee, P. M. Wensing, F. C. Park, "Geometric robot dynamic identification: a convex programming approach",
//! IEEE Trans. Robotics 36(2), 2020.

mod distance;
mod newton;
mod set;

pub use set::{ConsistentSet, consistent_set};
