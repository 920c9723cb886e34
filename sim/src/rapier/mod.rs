//! An independent simulator as a plant: multibody joints of the physics engine rapier, in reduced
//! coordinates.
//!
//! ```text
//! (H(q) + h D) a = τ − τ_friction(q̇) − bias(q, q̇)        q̇ ← q̇ + h a        q ← q + h q̇        h = dt / substeps
//! ```
//! The engine shares no line with the equations of this project: it has its own kinematics, Jacobians, mass matrix and
//! integrator. Generated from a robot and its parameters: one body per link with mass, centre of mass and principal
//! inertia, one joint about or along z between the frames `before` and `after` of the model, rotor inertia as the
//! engine's armature. Its default damping is zeroed, and there is no contact and no sleep.
//!
//! Friction is the law of the core ([`armid::dynamics::TorqueTerms`]), made implicit through the engine's damping `D`
//! (see `term_forces`), and coupled rotors, which the engine does not model, are a torque in every step (see `rotors`).
//!
//! The method is of order 1: an error halves with the step. Within a step the engine treats Coriolis forces
//! implicitly, and explicitly where it finds that the former adds energy.
//!
//! Reference: rapier3d-f64 0.36, `Multibody::update_mass_matrix` and `Multibody::update_acceleration`.

mod engine;
mod error;
mod plant;
mod rotors;
mod term_forces;

pub use error::RapierError;
pub use plant::{DEFAULT_SUBSTEPS, RapierPlant};
