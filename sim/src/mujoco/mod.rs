//! MuJoCo as a plant, for independent checks.
//!
//! ```text
//! H(q) q̈ + c(q, q̇) + g(q) = τ − friction(q̇)          H with rotor inertia, as joint and tendon armature
//! ```
//! Everything on the left is computed by MuJoCo from a model generated for it ([`mjcf()`]); friction and offset are the
//! core's drive laws, applied as generalised forces, so that they are the same in every engine. Contacts and
//! constraints are off.
//!
//! The library is found when the first plant is made, never when armid is built: it is looked for where
//! `ARMID_MUJOCO_LIB` says and nowhere else, or in `third_party/mujoco` of the repository that armid was built in and
//! of the folders above the program, in the user's cache, and by the system's loader. Versions 3.17.0 and 4.0.0
//! are taken, since where its fields stand depends on the version. `scripts/get-mujoco` fetches the first.
//!
//! The only `unsafe` of armid is in `functions`, `library` and `model`. Bits are reproducible on one machine; between
//! machines they depend on the C library's sine and cosine.
//!
//! Reference: E. Todorov, T. Erez, Y. Tassa, "MuJoCo: A physics engine for model-based control", IROS 2012.

mod error;
mod functions;
mod layout;
mod library;
mod mjcf;
mod model;
mod places;
mod plant;
mod shared_object;
mod status;
mod term_forces;
#[cfg(test)]
mod tests;

pub use error::MujocoError;
pub use mjcf::{mjcf, mjcf_for_exchange};
pub use model::{MujocoModel, MujocoStepper};
pub use plant::{MujocoPlant, MujocoScheme};
pub use status::MujocoStatus;
