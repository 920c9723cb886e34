//! The base parameters as formulas in the robot's own Denavit–Hartenberg lengths.
//!
//! ```text
//! β = m2 − Izz2/a2² + m3 + m4 + m5 + m6
//! ```
//! A number like −10.76 fits many formulas, and on a real arm two lengths are often equal. So a formula is never read
//! off one number: the structural recursion is run again on the same arm with each length and each oblique angle
//! changed in turn. How a coefficient answers gives its exponents; its value then gives the factor, and the formula is
//! accepted only if it predicts the coefficient on further arms with all lengths and angles changed at random.
//! Constants are accepted on the same terms. What no formula predicts is printed as a number of 12 digits.
//!
//! Tried in this order, so that the simplest is found: a rational constant with numerator and denominator up to 8; one
//! product of powers; sums of two and of three such products.

mod coefficient;
mod family;
mod recognise;
mod symbol;
mod text;

pub use coefficient::{Coefficient, Product};
pub use symbol::{Quantity, Symbol};
pub use text::Formula;
