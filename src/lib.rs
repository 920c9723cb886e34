//! armid identifies the dynamic parameters of robot arms, and shows by simulation which design and which estimator
//! to trust before the robot moves.
//!
//! The modules read as the method section of a paper; each imports only from those above it:
//!
//! ```text
//! Robot → JointTorqueRegressor → BaseReduction → Design → ExperimentPlan → Recording → Samples → Observation → Estimate → StudyResult
//! ```
//!
//! Conventions (fixed in `NOTATION.md`): SI units; six-dimensional vectors with the angular part first; the ten
//! parameters of a link are `m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz` in the link's own frame.
//! The library does no input or output and reads no clock.
#![forbid(unsafe_code)]

pub mod seed;
pub mod provenance;
pub mod linalg;
pub mod statistics;
pub mod spatial;
pub mod model;
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
