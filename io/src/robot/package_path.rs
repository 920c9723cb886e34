//! Where the files that a URDF names are: `package://NAME/rest`, `model://NAME/rest`, `file://path`, or a path beside the URDF.

use std::path::{Path, PathBuf};

use armid::remedy::{Remedy, Setting};

use crate::error::Error;

/// Folders in which packages are looked for, in this order; the folders above the URDF come after them.
///
/// A folder is one that holds packages, `FOLDER/NAME/rest`, or a package itself, where it is called NAME.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PackagePath(Vec<PathBuf>);

impl PackagePath {
    /// These folders.
    #[must_use]
    pub fn new(folders: Vec<PathBuf>) -> Self {
        Self(folders)
    }

    /// The file that a URDF in `folder` names.
    ///
    /// # Errors
    /// [`Error`] where there is none, with what was looked through.
    pub fn find(&self, file: &str, folder: Option<&Path>) -> Result<PathBuf, Error> {
        if let Some(path) = file.strip_prefix("file://") {
            return existing(PathBuf::from(path), file);
        }
        let Some(rest) = file.strip_prefix("package://").or_else(|| file.strip_prefix("model://")) else {
            let path = folder.map_or_else(|| PathBuf::from(file), |folder| folder.join(file));
            return existing(path, file);
        };
        let rest = Path::new(rest);
        let mut parts = rest.components();
        let name = parts.next().map(|name| name.as_os_str());
        let inside = parts.as_path();
        let above = folder.and_then(|folder| std::path::absolute(folder).ok());
        let above: Vec<PathBuf> = above.iter().flat_map(|folder| folder.ancestors()).map(Path::to_path_buf).collect();
        for parent in self.0.iter().chain(&above) {
            let itself = parent.file_name().filter(|own| Some(*own) == name).map(|_| parent.join(inside));
            if let Some(found) = std::iter::once(parent.join(rest)).chain(itself).find(|path| path.is_file()) {
                return Ok(found);
            }
        }
        let named = self.0.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", ");
        let beside = if above.is_empty() { "" } else { "the folders above the URDF" };
        let looked =
            [named.as_str(), beside].iter().filter(|text| !text.is_empty()).copied().collect::<Vec<_>>().join(" and ");
        let looked = if looked.is_empty() { "no folder to look in".to_owned() } else { format!("not in {looked}") };
        let name = name.unwrap_or_default().to_string_lossy();
        Err(Error::unknown(format!("{file} not found: {looked}")).help(
            Remedy::set(Setting::PackagePath, "DIR")
                .say(format!(" or ROS_PACKAGE_PATH says which folder holds \"{name}\"")),
        ))
    }
}

fn existing(path: PathBuf, file: &str) -> Result<PathBuf, Error> {
    if path.is_file() { Ok(path) } else { Err(Error::unknown(format!("{file} not found: {}", path.display()))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_found_by_the_folders_given_and_by_those_above_the_urdf() {
        let folder = tempfile::tempdir().unwrap();
        let at = |path: &str| folder.path().join(path);
        for path in ["share/arm_description/meshes", "share/arm_description/urdf", "elsewhere/other/meshes"] {
            std::fs::create_dir_all(at(path)).unwrap();
        }
        for path in ["share/arm_description/meshes/a.stl", "elsewhere/other/meshes/b.stl"] {
            std::fs::write(at(path), "solid").unwrap();
        }
        let (urdf, own) = (at("share/arm_description/urdf"), at("share/arm_description/meshes/a.stl"));
        let none = PackagePath::default();
        assert_eq!(none.find("package://arm_description/meshes/a.stl", Some(&urdf)).unwrap(), own);
        assert_eq!(
            none.find("../meshes/a.stl", Some(&urdf)).unwrap().canonicalize().unwrap(),
            own.canonicalize().unwrap()
        );
        assert_eq!(none.find(&format!("file://{}", own.display()), None).unwrap(), own);
        let fault = none.find("package://other/meshes/b.stl", Some(&urdf)).unwrap_err().to_string();
        assert!(fault.contains("package://other/meshes/b.stl not found: not in the folders above the URDF"), "{fault}");
        assert!(
            none.find("package://other/meshes/b.stl", None).unwrap_err().to_string().contains("no folder to look in")
        );
        for holder in ["elsewhere", "elsewhere/other"] {
            let found = PackagePath::new(vec![at(holder)]).find("package://other/meshes/b.stl", Some(&urdf)).unwrap();
            assert_eq!(found, at("elsewhere/other/meshes/b.stl"));
        }
    }
}
