//! The mechanics that armid stands on: random numbers, linear algebra and statistics; the robot, its motion, its dynamics, and
//! the parameters that torque reveals.
//!
//! ```text
//! Robot → JointTorqueRegressor → BaseReduction
//! ```
//! The crate `armid` hands on every module of this one, and its first page says where to begin. The modules stand in the order in
//! which they import each other; [`chains`] has robots for tests.
#![forbid(unsafe_code)]

pub mod seed;
pub mod provenance;
#[doc(hidden)]
pub mod plain;
pub mod number;
pub mod input;
pub mod observer;
pub mod remedy;
pub mod lanes;
pub mod linalg;
pub mod optimiser;
pub mod statistics;
pub mod spatial;
pub mod model;
pub mod chains;
pub mod trajectory;
pub mod dynamics;
pub mod regressor;
pub mod base;
pub mod codegen;
