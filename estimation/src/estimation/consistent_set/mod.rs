//! The physically consistent set of standard parameters that agrees best with data.
//!
//! ```text
//! min_φ ½ χ²(φ) + R(φ)        χ²(φ) = (K φ − β̂)ᵀ C⁻¹ (K φ − β̂)        P_i ≻ 0, x_j > 0, tr(Q P_i) > 0
//! ```
//! P is a link's pseudo-inertia, x a rotor inertia or a friction, Q a bound by the shape of a link ([`shape_bounds`]); C is the
//! covariance of the estimate, or of the equations of a fit, and R what a prior adds ([`prior`]). It is what a semidefinite program
//! gives; where several sets agree alike, the one nearest to the guess by `Σ tr(P₀⁻¹P) − ln det P + Σ x/x₀ − ln x` is taken.
//!
//! The logarithms are a self-concordant barrier, so the optimum is reached along the path of minimisers for a growing weight of the
//! data ([`path`]), by Newton steps in coordinates of the barrier ([`newton`], [`coordinates`]). The search ends where K φ = β̂ holds
//! exactly, or where the duality gap is 1e-7 of the objective.
//!
//! References: C. D. Sousa, R. Cortesão, "Physical feasibility of robot base inertial parameter identification: a linear matrix
//! inequality approach", International Journal of Robotics Research 33(6), 2014; T. Lee, P. M. Wensing, F. C. Park, "Geometric robot
//! dynamic identification: a convex programming approach", IEEE Trans. Robotics 36(2), 2020.

mod constrained;
mod coordinates;
mod newton;
mod path;
mod prior;
mod region;
mod shape_bounds;
#[cfg(test)]
mod optimum_tests;

pub(super) use constrained::{ConstrainedFit, constrained_fit, definite_inverse};
pub(super) use coordinates::{basis, symmetric};
pub(super) use prior::Prior;
pub(super) use shape_bounds::ShapeBounds;
