//! `armid calibrate`: what is measured joint by joint before an arm is identified.

mod bench;
mod calibration;
mod friction;
mod payload;
mod torque_constant;

pub(crate) use calibration::{Arguments, run};
