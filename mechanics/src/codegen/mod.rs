//! The dynamics of an identified arm as source code that needs nothing but a compiler.
//!
//! ```text
//! Y φ = Y_b K φ        φ' = β on the kept columns, 0 on the others        K φ' = β, so Y φ' = Y_b β
//! ```
//! The base parameters are put in the places of the parameters that stand for them, all others are zero, and the
//! Newton–Euler recursion is written down with them. What is multiplied by zero is never written, what occurs twice is
//! computed once, and constants are multiplied out, so the code has the operations that the base parameters need and no
//! others. A column of the regressor is the torque of a unit of its parameter, by the axes in the frame of its link. Accelerations
//! follow from the mass matrix. [`BaseModel`] holds the operations; [`Language`] says how they are written.
//!
//! Reference: W. Khalil, J.-F. Kleinfinger, "Minimum operations and minimum parameters of the dynamic models of tree structure
//! robots", IEEE J. Robotics and Automation 3(6), 1987, for the recursion with base parameters.

mod base_model;
mod error;
mod expression;
mod forward;
mod language;
mod recursion;
mod vector;

pub use base_model::BaseModel;
pub use error::CodegenError;
pub use language::Language;
