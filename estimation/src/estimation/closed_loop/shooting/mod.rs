//! Multiple shooting: parameters of a motion that runs away from every start at hand.
//!
//! ```text
//! min Σ_j ‖y_j − f_j(x_j, β)‖²_Σ    where x_{j+1} = F_j(x_j, β)        over β and the states x_j of all nodes
//! ```
//! An interval between two nodes is too short for a motion to run away in, and begins where the arm was measured, whatever β.
//! The equality is a square with a weight that is raised in stages ([`search`]); each step of Gauss and Newton is solved interval by
//! interval, by orthogonal reflections alone, so that what grows within the motion does not grow in rounding ([`step`]). The β that is
//! found is where single shooting begins, whose minimum is the same: ends that meet are one motion.
//!
//! Source: H. G. Bock, "Numerical treatment of inverse problems in chemical reaction kinetics", Springer Series in Chemical
//! Physics 18, 1981, p. 102–125.

mod interval;
mod search;
mod start;
mod step;
#[cfg(test)]
mod tests;

pub(super) use start::{Output, shoot};
