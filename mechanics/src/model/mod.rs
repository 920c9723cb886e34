//! What anyone can read off a robot arm: a serial chain, its joints, limits and drives, and the names and the order
//! of its dynamic parameters.
//!
//! ```text
//! T_i(q) = before_i · J_i(q) · after_i        J = rotation about z, or translation along z
//! ```
//! places the frame of link i in that of link i−1. Standard DH fills `after`, modified DH and URDF fill `before`, so
//! one recursion serves every convention, and each keeps the link frame in which its parameters are published.
//!
//! A [`Robot`] carries no inertia: parameters are values of their own ([`StandardParameters`]), and the true ones of
//! a simulation are a type of `study`, which no module that identifies can name.

mod bundled;
mod capsule;
mod columns;
mod columns_error;
mod declared_uncertainty;
mod drive;
mod drive_kind;
mod friction;
mod hull;
mod joint;
mod motor_circuit;
mod parameter_id;
mod parameters;
mod point;
mod reference_units;
mod robot;
mod robot_error;
mod servo;
mod shape;
pub mod format;
pub mod term;

pub use bundled::{BundledRobot, bundled};
pub use capsule::Capsule;
pub use columns::{Columns, MOST_TERMS, distinct};
pub use columns_error::ColumnsError;
pub use declared_uncertainty::{DeclaredUncertainty, DeclaredUncertaintyError};
pub use drive::Drive;
pub use drive_kind::DriveKind;
pub use friction::smooth_sign;
pub use hull::PointHull;
pub use hull::{HULL_POINTS, HULL_TOLERANCE, Hull};
pub use joint::{DhConvention, DhRow, Joint, JointKind, Limits, exact_sincos};
pub use motor_circuit::MotorCircuit;
pub use parameter_id::{ParameterId, ParameterKind};
pub use parameters::{DriveParameters, StandardParameters};
pub use point::NamedPoint;
pub use reference_units::ReferenceUnits;
pub use robot::{Robot, RobotSpec};
pub use robot_error::RobotError;
pub use servo::{EffortInterface, ServoTuning};
pub use shape::{Cuboid, Obstacle, Shape, Solid};
