//! The base parameters from the geometry alone: no random states, no trajectory.
//!
//! Torque is zero for every motion exactly if each entry of the mass matrix, and each gravity torque, is the zero
//! *function* of q (Coriolis terms are derivatives of the former). With ρ_j(q) the parameters of everything beyond
//! joint j, seen from link j, both are of one form:
//!
//! ```text
//! H_ij(q) = S_i(q)ᵀ I[ρ_j] S_j + (Cᵀ Ia C)_ij     g_j(q) = −a_g(q)ᵀ I[ρ_j] S_j + Fo_j      ρ_j = π_j + A(q_{j+1}) ρ_{j+1}
//! ```
//! S_i(q) and a_g(q), seen from link j, and A(q) are trigonometric (revolute) or plain (prismatic) polynomials in each
//! coordinate: a constant part and moving parts, linearly independent as functions. So a linear functional of φ that
//! torque reveals at link j splits exactly into: its constant part, which goes on as one functional of link j *and*
//! of all beyond, and its moving parts, each a functional of what lies beyond alone. Walking outwards and keeping
//! bases of these finite-dimensional spaces gives the row space of every stacked regressor that excites the robot
//! fully; its echelon form is K.
//!
//! Torque terms enter where they belong: a rotor adds a constant to an entry of H, so it regroups exactly with what the
//! links contribute to that constant; every other term is walked separately, being a function that the links do not have.
//!
//! The idea of propagating attainable motion and revealed functionals joint by joint is that of P. M. Wensing,
//! G. Niemeyer, J.-J. E. Slotine, "A geometric characterization of observability in inertial parameter
//! identification", arXiv:1711.03896; the split into constant and moving parts is what carries drives along.

mod functions;
mod harmonics;
mod motion;
mod recursion;
mod span;

pub use motion::BaseMotion;
pub(super) use recursion::reduce;
