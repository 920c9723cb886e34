//! Trajectories that reveal the parameters of a robot arm best, inside its limits. The crate `armid` hands on this module, and its
//! first page says where to begin.
#![forbid(unsafe_code)]

use armid_mechanics::plain;
pub use armid_mechanics::{
    base, chains, dynamics, input, linalg, model, observer, optimiser, provenance, regressor, seed, spatial,
    statistics, trajectory,
};

pub mod excitation;
