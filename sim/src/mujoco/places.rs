//! Where the library may be.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::layout::LAYOUTS;

/// Names of the library's file, one for each version that is taken.
pub(super) fn files() -> [String; LAYOUTS.len()] {
    LAYOUTS.map(|layout| {
        if cfg!(target_os = "macos") {
            format!("libmujoco.{}.dylib", layout.version)
        } else if cfg!(windows) {
            "mujoco.dll".to_owned()
        } else {
            format!("libmujoco.so.{}", layout.version)
        }
    })
}

/// Names a library that takes precedence.
pub(super) const VARIABLE: &str = "ARMID_MUJOCO_LIB";

/// How many folders above the program are looked into: `target/release/deps` of a repository has its root as fourth.
const ABOVE: usize = 6;

/// What decides where to look, so that it can be stated in a test.
#[derive(Clone, Debug, Default)]
pub(super) struct Surroundings {
    pub(super) variable: Option<OsString>,
    pub(super) program: Option<PathBuf>,
    pub(super) cache: Option<PathBuf>,
}

impl Surroundings {
    /// Those of this process.
    pub(super) fn now() -> Self {
        let named = |name| env::var_os(name).filter(|value| !value.is_empty());
        let home = || named("HOME").map(PathBuf::from);
        let cache = if cfg!(target_os = "macos") {
            home().map(|home| home.join("Library/Caches"))
        } else {
            named("XDG_CACHE_HOME").map(PathBuf::from).or_else(|| home().map(|home| home.join(".cache")))
        };
        Self { variable: named(VARIABLE), program: env::current_exe().ok(), cache }
    }

    /// The file that the environment names.
    pub(super) fn named(&self) -> Option<PathBuf> {
        self.variable.as_ref().map(PathBuf::from)
    }

    /// The folders to look into, the first first.
    pub(super) fn folders(&self) -> Vec<PathBuf> {
        let mut folders = Vec::new();
        // The repository that armid was built in.
        if let Some(root) = Path::new(env!("CARGO_MANIFEST_DIR")).parent() {
            folders.push(root.join("third_party/mujoco"));
        }
        for above in self.program.iter().flat_map(|program| program.ancestors().skip(1).take(ABOVE)) {
            let folder = above.join("third_party/mujoco");
            if !folders.contains(&folder) {
                folders.push(folder);
            }
        }
        folders.extend(self.cache.iter().map(|cache| cache.join("armid/mujoco")));
        folders
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_come_in_the_stated_order() {
        let around = Surroundings {
            variable: Some("/a/libmujoco.so".into()),
            program: Some("/b/target/release/armid".into()),
            cache: Some("/c".into()),
        };
        assert_eq!(around.named(), Some("/a/libmujoco.so".into()));
        let folders = around.folders();
        let at = |folder: &str| folders.iter().position(|found| found == Path::new(folder)).unwrap();
        assert!(folders[0].ends_with("third_party/mujoco"));
        assert!(at("/b/target/release/third_party/mujoco") < at("/b/third_party/mujoco"));
        assert_eq!(at("/c/armid/mujoco"), folders.len() - 1);
        assert_eq!(Surroundings::default().folders().len(), 1);
    }
}
