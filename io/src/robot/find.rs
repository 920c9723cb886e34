//! Where a robot is found by what it is called.

use std::path::{Path, PathBuf};

use armid::model::bundled;
use armid::model::format::ChainEnds;
use armid::remedy::{Remedy, Task};

use super::LoadedRobot;
use crate::error::Error;
use crate::suggestion;
use crate::text::Text;

/// Finds and reads a robot by what it is called: [`load`] for what is a chain already, from the current folder.
///
/// # Errors
/// As [`load`].
pub fn find(name: &str) -> Result<LoadedRobot, Error> {
    load(name, &ChainEnds::default(), None)
}

/// Finds and reads a robot: a bundled name, a folder with `robot.toml`, or a file that ends in `.toml`, `.urdf` or
/// `.xml`. Relative paths begin at `beside`, the folder of the file that names the robot. `chain` chooses the chain in
/// a tree.
///
/// # Errors
/// [`Error`] where there is no such robot, its file cannot be read, or `chain` is given for what is a chain already.
pub fn load(name: &str, chain: &ChainEnds, beside: Option<&Path>) -> Result<LoadedRobot, Error> {
    if let Some(entry) = bundled().iter().find(|entry| entry.name == name) {
        no_chain(chain, name)?;
        return LoadedRobot::bundled(entry);
    }
    let path = beside.map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
    if !path.exists() {
        return Err(unknown(name, &path));
    }
    let path = if path.is_dir() { path.join("robot.toml") } else { path };
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("toml") => {
            no_chain(chain, name)?;
            LoadedRobot::file(&path)
        }
        Some("urdf" | "xml") => LoadedRobot::tree(Text::read(&path)?, chain, path.parent().map(Path::to_path_buf)),
        other => {
            let (ending, shown) = (other.unwrap_or_default(), path.display());
            let error =
                Error::new(format!("{shown}: found a file ending in \"{ending}\", expected .toml, .urdf or .xml"));
            Err(if ending == "xacro" {
                error.help(format!("`xacro {shown} > arm.urdf` makes a URDF of it"))
            } else {
                error
            })
        }
    }
}

fn no_chain(chain: &ChainEnds, name: &str) -> Result<(), Error> {
    let given = [("base_link", &chain.base), ("tip_link", &chain.tip)];
    match given.iter().find(|(_, link)| link.is_some()) {
        Some((key, _)) => {
            let message = format!("{key} chooses a chain in a URDF or MJCF tree; \"{name}\" is a serial chain already");
            Err(Error::mismatch(message).help("a robot file over a URDF has the keys base_link and tip_link"))
        }
        None => Ok(()),
    }
}

fn unknown(name: &str, path: &Path) -> Error {
    let names: Vec<&str> = bundled().iter().map(|entry| entry.name).collect();
    let looks_like_path = name.contains(['/', '\\']) || path.extension().is_some();
    if looks_like_path {
        Error::unknown(format!("robot file not found: {}", path.display()))
            .help(Remedy::task(Task::Robot, "").say(format!(" lists the bundled robots: {}", names.join(", "))))
    } else {
        Error::unknown(format!("robot \"{name}\" is neither a bundled robot nor a file"))
            .help(suggestion::help(name, &names))
    }
}
