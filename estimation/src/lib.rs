//! From samples to parameters with their intervals, mistakes in logs, and constants of single joints. The crate `armid` hands on these
//! modules, and its first page says where to begin.
#![forbid(unsafe_code)]

pub use armid_measurement::{experiment, signal};
use armid_mechanics::plain;
pub use armid_mechanics::{
    base, chains, dynamics, input, linalg, model, number, observer, provenance, regressor, remedy, seed, spatial,
    statistics, trajectory,
};

pub mod estimation;
pub mod diagnosis;
pub mod calibration;
