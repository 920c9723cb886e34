//! How should the arm move so that its parameters show best, without breaking a limit?
//!
//! `radkhah2007` sections II.C, II.D and III: finite Fourier series as trajectories, a criterion on the information
//! `M = W_bᵀ Σ⁻¹ W_b` of the base columns, limits as constraints, and an optimiser of our own.

mod admission;
mod b_spline;
mod basis;
mod certificate;
mod certified_file;
pub mod clearance;
pub mod course;
mod constant_speed;
pub mod criterion;
mod curve;
mod descent;
mod design;
pub mod effort;
mod error;
mod extremum;
mod family;
mod feasibility;
mod fourier;
mod fourier_quintic;
mod information;
mod limit_rows;
mod limit_survey;
mod limits;
mod objective;
pub mod optimiser;
mod padded_rows;
mod path_rows;
mod periodic;
mod piecewise;
mod problem;
mod sampled;
mod shape;
mod start;
mod termination;
mod trajectory;
mod trajectory_file;
mod trigonometric;

#[cfg(test)]
pub(crate) mod fixtures;

pub use admission::{AdmissionFault, check};
pub use b_spline::{BSplineJoint, BSplineTrajectory};
pub use basis::{MotionBasis, Quantity};
pub use certificate::{Certificate, WeakParameter};
pub use constant_speed::{ConstantSpeedJoint, ConstantSpeedTrajectory};
pub use criterion::{Criterion, CriterionKind};
pub use curve::Curve;
pub use design::{Design, best_of, design, design_from, multistart, nearest_of, random_design};
pub use error::ExcitationError;
pub use extremum::{EXTREMUM_TOLERANCE, Extremum};
pub use family::Family;
pub use fourier::{FourierJoint, FourierTrajectory};
pub use fourier_quintic::FourierQuinticTrajectory;
pub use information::Information;
pub use limit_rows::LimitRows;
pub use limit_survey::{WorstCases, WorstLimitUse};
pub use limits::WorstUse;
pub use objective::InformationObjective;
pub use periodic::{PeriodicMotion, PeriodicTrajectory};
pub use piecewise::PiecewisePolynomial;
pub use problem::{DEFAULT_EVALUATIONS, DesignProblem, Margins};
pub use sampled::SampledBasis;
pub use start::{START_VELOCITIES, radkhah2007_start};
pub use termination::{HistoryPoint, Termination};
pub use trajectory::Trajectory;
pub use trigonometric::TrigonometricPolynomial;
