//! What commands answer: texts for a person, JSON for a program.

pub(crate) mod advice;
pub(crate) mod campaign;
pub(crate) mod clearance;
pub(crate) mod design;
pub(crate) mod drive_gains;
pub(crate) mod estimate;
pub(crate) mod findings;
pub(crate) mod friction_speed;
pub(crate) mod model_file;
pub(crate) mod payload;
pub(crate) mod robots;
pub(crate) mod run;
pub(crate) mod selection;
pub(crate) mod separating;
pub(crate) mod study;
pub(crate) mod transmission;
mod verdict;
