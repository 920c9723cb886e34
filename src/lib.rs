//! armid identifies the dynamic parameters of robot arms, and shows by simulation which design and which estimator
//! to trust before the robot moves.
//!
//! The modules read as the method section of a paper; each imports only from those above it:
//!
//! ```text
//! Robot → JointTorqueRegressor → BaseReduction → Design → ExperimentPlan → Recording → Samples → Observation → Estimate → StudyResult
//! ```
//!
//! | to | begin at |
//! |---|---|
//! | describe a robot | [`model::Robot`], [`model::format`] for TOML, URDF and MJCF |
//! | evaluate its dynamics | [`dynamics::Dynamics`], [`regressor::JointTorqueRegressor`] |
//! | find what torque reveals | [`base::reduce`] |
//! | design a trajectory | [`excitation::DesignProblem`], [`excitation::design`] |
//! | perform it | [`experiment::ExperimentPlan`] on any [`experiment::Arm`]; a simulated one is a [`experiment::Servo`] around a [`experiment::Plant`] |
//! | process what was recorded | [`signal::process`] |
//! | identify and validate | [`estimation::Identification`] |
//! | ask how good a method is | [`study`] |
//!
//! ```
//! use armid::base::{Method, reduce};
//! use armid::model::{Columns, bundled, format::parse_robot};
//! use armid::seed::Seed;
//! let robot = parse_robot(bundled()[0].robot)?;
//! let base = reduce(&robot, Columns::RIGID, Method::Structural, Seed::new(0))?;
//! assert_eq!((robot.name(), robot.dof(), base.rank()), ("crs-a460", 6, 36));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Files are read and written by the crate `armid-io`, whose first page goes from a log to parameters in a few lines;
//! simulated arms are in `armid-sim`. `examples/` has short programs.
//!
//! Conventions (fixed in `NOTATION.md`): SI units; six-dimensional vectors with the angular part first; the ten
//! parameters of a link are `m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz` in the link's own frame.
//! The library does no input or output and reads no clock.
#![forbid(unsafe_code)]

pub mod seed;
pub mod provenance;
pub mod cdr;
pub mod linalg;
pub mod optimiser;
pub mod statistics;
pub mod spatial;
pub mod model;
pub mod trajectory;
pub mod dynamics;
pub mod regressor;
pub mod base;
pub mod excitation;
pub mod experiment;
pub mod signal;
pub mod estimation;
pub mod calibration;
pub mod study;
pub mod conformance;
