//! How does a periodic motion move every joint, at every time of an experiment?
//!
//! ```text
//! q(t), q̇(t), q̈(t)  (n each)      of finite Fourier series, splines and segments at constant speed, t ∈ [0, T)
//! ```
//! A [`Trajectory`] is evaluated at a time; a [`PeriodicMotion`] also hands out the curve of each joint, whose extrema
//! are known between samples; a [`TrajectoryFamily`] is the set of motions of one kind as a linear space of coefficients; a
//! [`Timeline`] is the ramp from rest into the motion and back. Nothing here depends on limits, torque or experiments.

mod b_spline;
mod constant_speed;
mod curve;
mod custom;
mod definition;
mod error;
mod extremum;
mod family;
mod fourier;
mod fourier_quintic;
mod linear_family;
mod periodic;
mod piecewise;
mod quantity;
mod quintic_step;
mod shape;
mod states;
pub mod table_one;
mod timeline;
mod trajectory_file;
mod trigonometric;

pub use b_spline::{BSplineJoint, BSplineTrajectory};
pub use constant_speed::{ConstantSpeedJoint, ConstantSpeedTrajectory};
pub use curve::Curve;
pub use custom::CustomTrajectory;
pub use definition::{PeriodicMotion, Trajectory};
pub use error::TrajectoryError;
pub use extremum::{EXTREMUM_TOLERANCE, Extremum};
pub use family::Family;
pub use fourier::{FourierJoint, FourierTrajectory};
pub use fourier_quintic::FourierQuinticTrajectory;
pub use linear_family::{MotionScale, ShapeFunctions, TrajectoryFamily};
pub use periodic::PeriodicTrajectory;
pub use piecewise::PiecewisePolynomial;
pub use quantity::Quantity;
pub use quintic_step::QuinticStep;
pub use states::States;
pub use timeline::{PathPoint, Segment, Timeline};
pub use trigonometric::TrigonometricPolynomial;
