//! Why there is no MuJoCo, or why it rejects a robot.

use armid::dynamics::TermError;
use std::path::PathBuf;

use super::layout::{LAYOUTS, versions};
use super::places::files;

/// Why a robot cannot be simulated by MuJoCo.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MujocoError {
    /// The library is nowhere.
    #[error(
        "found no {} in {}, nor by the system's loader; run scripts/get-mujoco, which fetches MuJoCo {}",
        files().join(" or "),
        searched.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", "),
        LAYOUTS[0].version
    )]
    NotFound {
        /// The folders in which it was looked for.
        searched: Vec<PathBuf>,
    },
    /// The file named by the environment does not exist or cannot be read.
    #[error(
        "{}, named by ARMID_MUJOCO_LIB: {reason}, expected the library of MuJoCo {}; run scripts/get-mujoco \
         and unset the variable, or name another file",
        path.display(),
        versions()
    )]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The file ends before the library does.
    #[error("{}: found {found} bytes, expected {expected}: the file is cut short; run scripts/get-mujoco", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Its length, bytes.
        found: u64,
        /// The least length that its own table of contents asks for, bytes.
        expected: u64,
    },
    /// The file is something else than this library for this machine.
    #[error(
        "{}: {reason}, expected the library of MuJoCo {} for this machine; run scripts/get-mujoco",
        path.display(),
        versions()
    )]
    Unloadable {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Another version.
    #[error("{}: found MuJoCo {found}, expected {}; run scripts/get-mujoco", path.display(), versions())]
    Version {
        /// The file.
        path: PathBuf,
        /// The version that it says it is.
        found: String,
    },
    /// The parameters are of another robot.
    #[error("the parameters are of {found} links, expected the robot's {expected}")]
    Parameters {
        /// Number of links they describe.
        found: usize,
        /// Number of joints of the robot.
        expected: usize,
    },
    /// A torque term that the engine cannot simulate.
    #[error(transparent)]
    Term(#[from] TermError),
    /// A number of the model that is NaN or infinite.
    #[error("joint \"{joint}\": {quantity} is {value}, expected a finite number")]
    NotFinite {
        /// Name of the joint.
        joint: String,
        /// Which quantity.
        quantity: &'static str,
        /// What was found.
        value: f64,
    },
    /// A link without mass.
    #[error("link {link}, moved by joint \"{joint}\": its mass is {mass} kg, expected one above zero")]
    Mass {
        /// Number of the link, from one.
        link: usize,
        /// Name of the joint that moves it.
        joint: String,
        /// What was found, kg.
        mass: f64,
    },
    /// A link's inertia about its centre of mass has a principal moment that is not positive.
    #[error(
        "link {link}, moved by joint \"{joint}\": its inertia about the centre of mass has the eigenvalue \
         {eigenvalue:.6e} kg·m², expected all three above zero"
    )]
    PrincipalMoment {
        /// Number of the link, from one.
        link: usize,
        /// Name of the joint that moves it.
        joint: String,
        /// The smallest eigenvalue, kg·m².
        eigenvalue: f64,
    },
    /// A link's principal moments break the triangle inequality.
    #[error(
        "link {link}, moved by joint \"{joint}\": its inertia about the centre of mass has the eigenvalue \
         {eigenvalue:.6e} kg·m², expected at most the sum {sum:.6e} kg·m² of the other two"
    )]
    Triangle {
        /// Number of the link, from one.
        link: usize,
        /// Name of the joint that moves it.
        joint: String,
        /// The largest eigenvalue, kg·m².
        eigenvalue: f64,
        /// The sum of the other two, kg·m².
        sum: f64,
    },
    /// A rotor with negative inertia.
    #[error("joint \"{joint}\": the inertia of its rotor is {rotor} kg·m², expected one not below zero")]
    Rotor {
        /// Name of the joint.
        joint: String,
        /// What was found, kg·m².
        rotor: f64,
    },
    /// MuJoCo refuses the model for a reason of its own.
    #[error("MuJoCo rejects the model: {reason}")]
    Refused {
        /// What it says.
        reason: String,
    },
}
