//! Laws of the estimators: coverage of their intervals, agreement with other routes, recovery of exact data.

mod chain;
mod coverage;
mod declared;
mod discrepancy;
mod drive_gains;
mod factorisation;
mod instrumental;
mod noisy_recording;
mod physical;
mod recovery;
mod robust;
mod setting;
mod stribeck_speed;

pub(super) use setting::synthetic;
