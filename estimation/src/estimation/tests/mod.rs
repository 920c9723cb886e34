//! Laws of the estimators: coverage of their intervals, agreement with other routes, recovery of exact data.

mod chain;
mod coverage;
mod declared;
mod discrepancy;
mod drive_gains;
mod factorisation;
mod friction_speed;
mod instrumental;
mod load_friction;
mod motion_noise;
mod noisy_recording;
mod physical;
mod recovery;
mod robust;
mod setting;

pub(super) use setting::{a460_samples, synthetic};
