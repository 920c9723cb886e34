//! Everything beside the links' ten parameters: torque terms, in one list.
//!
//! ```text
//! τ = Y_links(q, q̇, q̈) φ_links + Σ_terms Σ_j φ_j d_j g(d_jᵀq, d_jᵀq̇, d_jᵀq̈, d_jᵀτ_t)        d_j = e_j or Cᵀe_j
//! ```
//! A term has one coefficient `φ_j` for each joint or motor and one law `g`, written once. Columns of the regressor,
//! their derivatives, inverse and forward dynamics, energy, the engines, effort limits, the base reduction, parameter
//! files, exports and reports are made from the [`TermEntry`] and the [`TermLaw`] and never ask which term it is.
//!
//! A term has no state of its own. What has (current loops, elastic transmissions, the temperature of a gear) belongs to
//! the simulated arm around the plant; a law may depend on what that state does (`load`, `warmth`).

mod coulomb;
mod coulomb_direction;
mod current_lag;
mod entry;
mod handle;
mod input;
mod joint_spring;
mod law;
mod list;
mod load_friction;
mod motor;
mod number;
mod offset;
mod position_friction;
mod quadratic_viscous;
mod rotor;
mod stribeck;
mod viscous;
mod warm_viscous;

pub use coulomb::CoulombFriction;
pub use coulomb_direction::CoulombDirection;
pub use current_lag::{CURRENT_LAG, CurrentLag};
pub use entry::{
    ByJoint, Carrier, Dimension, Dissipation, Needs, Place, Prior, PriorOf, ShapeParameter, Sign, Structure, TermEntry,
};
pub use handle::Term;
pub use input::{MOST_SHAPES, Runs, Shapes, TermBlock, TermInput};
pub use joint_spring::JointSpring;
pub use law::{TermLaw, TorqueTerm};
pub use list::*;
pub use load_friction::LoadFriction;
pub use motor::{
    MotorCoulombFriction, MotorLoadFriction, MotorStribeck, MotorViscousFriction, MotorWarmViscousFriction,
};
pub use number::{Number, Scale, Slope};
pub use offset::Offset;
pub use position_friction::{PositionCosine, PositionSine};
pub use quadratic_viscous::QuadraticViscousFriction;
pub use rotor::RotorInertia;
pub use stribeck::Stribeck;
pub use viscous::ViscousFriction;
pub use warm_viscous::WarmViscousFriction;
