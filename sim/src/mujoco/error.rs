//! Why there is no MuJoCo, or why it rejects a robot.

use armid::dynamics::TermError;
use std::path::PathBuf;

use super::layout::{LAYOUTS, versions};
use super::places::files;

/// Why a robot cannot be simulated by MuJoCo.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum MujocoError {
    /// The library is nowhere.
    #[error(
        "found no {} in {}, nor by the system's loader; run scripts/get-mujoco, which fetches MuJoCo {}",
        files().join(" or "),
        searched.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", "),
        LAYOUTS[0].version
    )]
    NotFound { searched: Vec<PathBuf> },
    /// The file named by the environment does not exist or cannot be read.
    #[error(
        "{}, named by ARMID_MUJOCO_LIB: {reason}, expected the library of MuJoCo {}; run scripts/get-mujoco \
         and unset the variable, or name another file",
        path.display(),
        versions()
    )]
    Unreadable { path: PathBuf, reason: String },
    /// The file ends before the library does.
    #[error("{}: found {found} bytes, expected {expected}: the file is cut short; run scripts/get-mujoco", path.display())]
    Truncated { path: PathBuf, found: u64, expected: u64 },
    /// The file is something else than this library for this machine.
    #[error(
        "{}: {reason}, expected the library of MuJoCo {} for this machine; run scripts/get-mujoco",
        path.display(),
        versions()
    )]
    Unloadable { path: PathBuf, reason: String },
    /// Another version.
    #[error("{}: found MuJoCo {found}, expected {}; run scripts/get-mujoco", path.display(), versions())]
    Version { path: PathBuf, found: String },
    /// The parameters are of another robot.
    #[error("the parameters are of {found} links, expected the robot's {expected}")]
    Parameters { found: usize, expected: usize },
    /// A torque term that the engine cannot simulate.
    #[error(transparent)]
    Term(#[from] TermError),
    /// A number of the model that is NaN or infinite.
    #[error("joint \"{joint}\": {quantity} is {value}, expected a finite number")]
    NotFinite { joint: String, quantity: &'static str, value: f64 },
    /// A link without mass.
    #[error("link {link}, moved by joint \"{joint}\": its mass is {mass} kg, expected one above zero")]
    Mass { link: usize, joint: String, mass: f64 },
    /// A link's inertia about its centre of mass has a principal moment that is not positive.
    #[error(
        "link {link}, moved by joint \"{joint}\": its inertia about the centre of mass has the eigenvalue \
         {eigenvalue:.6e} kg·m², expected all three above zero"
    )]
    PrincipalMoment { link: usize, joint: String, eigenvalue: f64 },
    /// A link's principal moments break the triangle inequality.
    #[error(
        "link {link}, moved by joint \"{joint}\": its inertia about the centre of mass has the eigenvalue \
         {eigenvalue:.6e} kg·m², expected at most the sum {sum:.6e} kg·m² of the other two"
    )]
    Triangle { link: usize, joint: String, eigenvalue: f64, sum: f64 },
    /// A rotor with negative inertia.
    #[error("joint \"{joint}\": the inertia of its rotor is {rotor} kg·m², expected one not below zero")]
    Rotor { joint: String, rotor: f64 },
    /// MuJoCo refuses the model for a reason of its own.
    #[error("MuJoCo rejects the model: {reason}")]
    Refused { reason: String },
}
