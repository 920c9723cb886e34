//! How an experiment is performed on any arm, and what position, velocity, acceleration and torque were in it. The crate `armid`
//! hands on these modules, and its first page says where to begin.
#![forbid(unsafe_code)]

pub use armid_excitation::excitation;
pub use armid_mechanics::{chains, dynamics, input, linalg, model, observer, provenance, seed, spatial, trajectory};
use armid_mechanics::{lanes, plain, statistics};

pub mod experiment;
pub mod signal;
