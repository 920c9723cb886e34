//! Which mistake in a log, or about a robot, explains the measured torque better than the log as it stands?
//!
//! ```text
//! J = 1/n Σ_i ‖e_i‖²/‖τ_i‖²  +  friction and inertia below zero by 3 σ  +  limits exceeded        e = τ − Y_b β̂
//! ```
//! A log with degrees for radians, a flipped sign, two joints exchanged or a wrong gear ratio is as well-formed as a good one,
//! and least squares finds parameters for it. These explain little of the torque or are physically inconsistent, or
//! the log exceeds the joint limits. Each mistake that people make is undone in turn and the parameters are fitted
//! again: the one after which J is much smaller is named, with what to correct. J is the cost of a fit of at most 160
//! instants with equal weight on each joint, not an estimate.
//!
//! A log is suspect only where J is large; one whose torque is explained is left alone, however it might be explained
//! otherwise. A sign or a factor that all efforts share is read from the robot file's own torque (`slope`), before anything else. What
//! neither shows is not named: the zero of a joint whose axis is vertical, a small factor on all efforts.

mod evidence;
mod mistake;
mod search;
mod slope;

pub use mistake::Mistake;
pub use search::{Evidence, Suspicion, diagnose, standing_joints};
