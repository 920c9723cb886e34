//! Values in files for which JSON has no form of its own: a matrix is the list of its rows, a vector the list of its
//! components, and an infinite number is `null`.

pub mod infinite;
pub mod matrix;
pub mod vector;
