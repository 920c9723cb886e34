//! One number, or one of each of several samples or runs: the arithmetic of everything that is computed side by side.
//!
//! ```text
//! f(x₁), f(x₂), …, f(x_L)        one recursion f, written once for any Lane; L as many as the processor has lanes for
//! ```
//! Every operation is the IEEE one on each lane. Nothing is contracted, and no sum runs across lanes, so that what a lane holds
//! has the same bits alone ([`f64`]), beside others ([`Wide`]), and on any width. Which width there is is found out when
//! the program runs (the crate `pulp`).

mod arithmetic;
mod elementary;
mod lane;
mod sines;
mod wide;

pub use crate::arithmetic_of;
pub use elementary::{exp, sin_cos, tanh};
pub use lane::Lane;
pub use sines::Sines;
pub use wide::{MOST_LANES, Wide, sines_and_cosines};
