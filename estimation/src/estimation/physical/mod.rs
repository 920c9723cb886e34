//! Least squares over physically consistent sets: pseudo-inertias positive definite, rotor inertias and friction not negative.
//!
//! ```text
//! min_φ ½ ‖y − W K φ‖²_P + R(φ)        P_1 … P_n ≻ 0, I_a, F_v, F_c … ≥ 0        β̂ = K φ̂
//! ```
//! [`solution`] solves it, [`inference`] makes error bars that know the constraint. A consistent estimate makes every mass matrix positive
//! definite and every friction dissipate, so that simulations run; and whatever noise says, it is nearer to a true arm than the
//! unconstrained one, in the metric of its own covariance: the projection onto a convex set moves towards all its points.
//!
//! Where the robot has shapes, they bound how the mass of their links is distributed; the shape of a link whose nominal body reaches
//! beyond it is no such bound, which [`Finding::BeyondShape`](super::Finding::BeyondShape) tells. The optimum is that of the
//! semidefinite program, and its duality gap is in the [`Termination`](super::Termination).
//!
//! `pc-iv` and `pc-didim` go on from the estimators that simulate the arm: each step of theirs ends at the nearest consistent set.
//!
//! Fails where a torque that the model lacks pushes the equations out of what a body can have: the estimate then lies on the
//! boundary, [`Finding::HeldBack`](super::Finding::HeldBack) says how far from its equations.
//!
//! References: C. D. Sousa, R. Cortesão, "Physical feasibility of robot base inertial parameter identification: a linear matrix
//! inequality approach", International Journal of Robotics Research 33(6), 2014; P. M. Wensing, S. Kim, J.-J. Slotine (2018);
//! T. Lee, P. M. Wensing, F. C. Park (2020), for the priors.

pub(super) mod direct_inverse;
mod fit;
mod inference;
pub(super) mod instrumental;
pub(super) mod ordinary;
pub(super) mod reweighted;
mod solution;
pub(super) mod weighted;

pub(super) use fit::{PRIOR_IN_SI, STATED_IN_SI};
