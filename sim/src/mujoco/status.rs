//! Whether MuJoCo is available on this machine.

use std::path::PathBuf;

use super::MujocoError;
use super::library::Library;
use super::places::Surroundings;

/// Whether MuJoCo can be used here, for `armid doctor`.
///
/// ```
/// use armid_sim::MujocoStatus;
/// match MujocoStatus::now() {
///     MujocoStatus::Found { path, version } => assert!(["3.17.0", "4.0.0"].contains(&version) && path.to_string_lossy().contains("mujoco")),
///     MujocoStatus::Missing { reason } => assert!(reason.to_string().contains("scripts/get-mujoco")),
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum MujocoStatus {
    /// It can.
    Found {
        /// The library's file; its bare name where the system's loader found it.
        path: PathBuf,
        /// Its version, as in `3.17.0`.
        version: &'static str,
    },
    /// It cannot.
    Missing {
        /// Why, and what to run.
        reason: MujocoError,
    },
}

impl MujocoStatus {
    /// Looks for the library and loads it.
    pub fn now() -> Self {
        match Library::get() {
            Ok(library) => Self::Found { path: library.path().to_path_buf(), version: library.version() },
            Err(reason) => Self::Missing { reason },
        }
    }

    /// Why the library that `ARMID_MUJOCO_LIB` names cannot be used; `None` where none is named, or where it can.
    pub fn named_but_unusable() -> Option<MujocoError> {
        Surroundings::now().named()?;
        Library::get().err()
    }
}
