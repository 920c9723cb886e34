//! Neural networks of one layer, whose weights or states are the parameters.
//!
//! ```text
//! minimise ½ ‖z − h γ‖² by a dynamics        γ the parameters in units of their columns
//! ```
//! Both come to rest at weighted least squares, which a factorisation finds at once: they are here to be compared. What they
//! add is the time that they take.

mod adaline;
mod hopfield_tank;

pub use adaline::Adaline;
pub use hopfield_tank::HopfieldTank;
