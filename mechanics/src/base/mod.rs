//! Which parameters, and which combinations of parameters, the joint torques reveal.
//!
//! ```text
//! Y(q, q̇, q̈) φ = Y_b(q, q̇, q̈) β        β = K φ        Y_b = the kept columns of Y        K is b × p
//! ```
//! K is the reduced row echelon form of the stacked regressor: the columns are walked from left to right in the order
//! of the parameters and kept if independent of those kept before, so K is unique, and three routes to it can be
//! compared entry by entry ([`Method`]): the five steps of `radkhah2007` section II.B, one rank-revealing QR, and a
//! recursion over the links that needs neither random numbers nor a trajectory.
//!
//! An independent column may still be too close to the others for any torque sensor: an axis that is off by a rounding of the
//! file makes columns at a distance of 1e-6 and less. They are left out, by the same rule for every method ([`NearlyDependent`]).
//!
//! A slip of `radkhah2007` step 5, corrected here: `f_i = L α_i` describes the *columns*. The parameters regroup the other
//! way: the torque keeps its value when a dependent parameter φ_i goes into the kept ones, `β_b = φ_b + Σ_i α_bi φ_i`;
//! no φ_i equals `D_BSVᵀ α_i`.

mod error;
mod dependence;
mod nearly_dependent;
mod formula;
mod geometry;
mod load;
mod method;
mod radkhah2007;
mod random_states;
mod reduce;
mod reduction;
mod scaled_stack;
mod structural;

pub use error::BaseError;
pub use formula::{Coefficient, Formula, Product, Quantity, Symbol};
pub use load::LOAD_UNITS;
pub use method::Method;
pub use nearly_dependent::NearlyDependent;
pub use radkhah2007::Radkhah2007Sets;
pub use reduce::{reduce, reduce_on, reduce_with_base, structural_base};
pub use reduction::{BaseReduction, Category};
pub use structural::BaseMotion;

#[cfg(test)]
mod tests;
