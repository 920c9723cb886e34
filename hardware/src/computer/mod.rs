//! The controller of a simulated robot: servo loop, encoders, currents and the ROS 2 interface of a real one, in real time,
//! with faults on demand.
//!
//! ```text
//!            ┌── Wire: action, topics ──┐          orders            ┌───── RobotController: one step per servo period ─────┐
//!  DDS ←───→ │ goals checked and joined │ ───────────────────────→  │ Commander ─ JointLoop ─ Plant     Fault       │ ─→ log
//!            └──────────────────────────┘ ←──────────────────────── └────────────────────────────────────────────────┘
//!                                            states, results
//! ```
//! [`RobotController`] and everything in it have no clock and no network: time is the number of servo steps.
//! [`serve()`] paces them by the wall clock and counts the deadlines that were missed.
//!
//! What it refuses and stops by itself, for any client:
//!
//! | what | does |
//! |---|---|
//! | a motion with wrong joints, no point, outside a limit, past, or that begins elsewhere | is refused |
//! | a set-point outside the position limits or not finite | is not taken |
//! | a set-point faster than the speed limit | is followed at the speed limit |
//! | no set-point for 20 ms while moving | brings the arm to rest |
//! | no set-point for 100 ms while moving | switches the motors off, brakes on |
//! | a joint further than 0.2 rad (m) from its command | switches the motors off, brakes on |
//! | a current above the drive's limit | is clamped |

mod commander;
mod fault;
#[cfg(test)]
pub(crate) mod flywheels;
mod joint_limits;
mod log;
mod pace;
mod replacement;
mod output;
mod reporter;
mod robot_controller;
mod serve;
mod spline;
mod wire;

pub use commander::{Commander, Watchdog};
pub use fault::{Fault, FaultKind};
pub use joint_limits::JointLimits;
pub use log::StepLog;
pub use output::Output;
pub use pace::Deadlines;
pub use replacement::Replacement;
pub use robot_controller::{Report, RobotController, RobotControllerError};
pub use serve::{Progress, ServeError, ServeOptions, serve};
pub use spline::{Spline, Unfit};
