//! Values in files for which JSON has no form of its own: a matrix is the list of its rows, a vector the list of its
//! components, and an infinite number is `null`.

mod checked;
pub mod infinite;
pub mod matrix;
pub mod vector;

pub use crate::checked_when_read;
