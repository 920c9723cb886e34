//! Where the meshes of a URDF are found, on the command line.

use std::path::PathBuf;

use armid_io::robot::PackagePath;

/// Where packages are.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct MeshArguments {
    /// Folders with the packages of `package://` meshes
    #[arg(long, value_name = "DIR", num_args = 1..)]
    package_path: Vec<PathBuf>,
}

impl MeshArguments {
    /// The folders that are looked through before those above the URDF.
    pub(crate) fn packages(&self) -> PackagePath {
        let of = |key: &str| std::env::var_os(key).unwrap_or_default();
        let ros = of("ROS_PACKAGE_PATH");
        let ament = of("AMENT_PREFIX_PATH");
        let named = |path: &PathBuf| !path.as_os_str().is_empty();
        let installed = std::env::split_paths(&ament).filter(named).map(|prefix| prefix.join("share"));
        let folders =
            self.package_path.iter().cloned().chain(std::env::split_paths(&ros).filter(named)).chain(installed);
        PackagePath::new(folders.collect())
    }
}
