//! What reproduces the source paper (`radkhah2007` in `references.bib`): its Table I, its Table II, and its claims.
//!
//! | part | what it is |
//! |---|---|
//! | [`table_one`] | the trajectory of its experiments, as printed and corrected; a family of designs can be made of it |
//! | [`table_two()`] | the 32 parameters of the CRS A460 that it printed |
//! | [`compare_with_table_two`] | these beside the simulated arm's true parameters and the estimates of this library |
//! | [`evaluate_claims`] | each claim as a measured quantity with its sample size and, where it is statistical, an interval |
//!
//! The verdict on a claim follows from the numbers by a rule that stands in the code, so that a report cannot say more
//! than was measured. What `radkhah2007` has in common with the rest of the field (recursions, reduction in five steps,
//! criteria, Fourier series, weighted least squares) stands in the modules of the method and cites it there.
//!
//! Reference: K. Radkhah, D. Kulic, E. Croft, "Dynamic parameter identification for the CRS A460 robot", IROS 2007.

mod claim;
mod claim_evaluation;
mod fitted_model;
mod reproduction;
mod table_two;
mod table_two_comparison;

pub use crate::trajectory::table_one;
pub use claim::{Claim, Quantity, Verdict};
pub use claim_evaluation::{ArmFactory, evaluate_claims};
pub use reproduction::Reproduction;
pub use table_two::{TableTwoRow, table_two};
pub use table_two_comparison::{TableLine, compare_with_table_two};
