//! Measurements joint by joint before an arm is identified: torque constants, and friction at constant speed.
//!
//! ```text
//! v = R i + L di/dt + Ke ω + V_b sgn(i)        Kt = Ke            from motor voltages: `back_emf`
//! N Kt i = Y(q, q̇, q̈) φ + Y_load φ_load        φ_load known        without voltages: `known_load`
//! (τ(+v) − τ(−v)) / 2 = Fc + Fv v                                  at the same positions: `friction`
//! τ = J θ̈ + f + K (θ − q_link)                                     motor and link measured: `transmission_stiffness`
//! ```
//! Each takes recordings of any arm and gives numbers with 95 % intervals.

mod back_emf;
mod error;
mod friction;
mod known_load;
#[cfg(test)]
mod tests;
mod transmission_stiffness;
#[cfg(test)]
mod transmission_stiffness_tests;

pub use crate::estimation::Measured;
pub use back_emf::{BackEmf, BackEmfPoint, Resistance, back_emf};
pub use error::CalibrationError;
pub use friction::{Friction, FrictionPoint, friction};
pub use known_load::{HiddenLoad, KnownLoad, KnownLoads, known_load, payload};
pub use transmission_stiffness::{StiffnessVerdict, TransmissionStiffness, transmission_stiffness};
