//! A `robot.toml` that begins from a URDF.

use std::path::{Component, Path, PathBuf};

use armid::model::format::{ChainEnds, write_robot};

use super::tree;
use crate::error::Error;
use crate::text::Text;

/// The text of a robot file at `place` over the URDF in `urdf`, with every gap marked. `ends` choose the chain.
///
/// # Errors
/// [`Error`] where the URDF cannot be read or is none, or no path leads from the robot file to it.
pub fn begin(urdf: &Path, ends: &ChainEnds, place: &Path) -> Result<String, Error> {
    let text = Text::read(urdf)?;
    if tree::is_mjcf(&text.content) {
        let message =
            format!("{} is an MJCF, expected a URDF: a robot file takes its kinematics from one", urdf.display());
        return Err(Error::new(message).help("the MJCF itself can be the robot"));
    }
    let model = tree::parse(&text, ends)?;
    Ok(write_robot(&model, &relative(urdf, place)?, ends))
}

/// The path from the folder of a file that need not be there yet to another file, with `/` between its parts.
pub(super) fn relative(to: &Path, place: &Path) -> Result<String, Error> {
    let absolute = |path: &Path| std::path::absolute(path).map_err(|error| Error::unreadable(path, &error));
    let (to, place) = (plain(&absolute(to)?), plain(&absolute(place)?));
    let from: Vec<Component<'_>> = place.parent().unwrap_or(&place).components().collect();
    let goal: Vec<Component<'_>> = to.components().collect();
    let common = from.iter().zip(&goal).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n("..", from.len() - common).map(str::to_owned);
    let down = goal[common..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    let parts: Vec<String> = if common == 0 { vec![to.display().to_string()] } else { up.chain(down).collect() };
    if to.to_str().is_none() {
        return Err(Error::new(format!("{} is not UTF-8, expected a path that a file can name", to.display())));
    }
    Ok(parts.join("/"))
}

/// A path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::relative;
    use std::path::Path;

    #[test]
    fn a_path_leads_from_the_folder_of_one_file_to_the_other() {
        for (to, place, expected) in [
            ("arm.urdf", "robot.toml", "arm.urdf"),
            ("a/arm.urdf", "robot.toml", "a/arm.urdf"),
            ("arm.urdf", "b/c/robot.toml", "../../arm.urdf"),
            ("./a/../x/arm.urdf", "x/y/robot.toml", "../arm.urdf"),
            ("/a/arm.urdf", "/a/b/robot.toml", "../arm.urdf"),
        ] {
            assert_eq!(relative(Path::new(to), Path::new(place)).unwrap(), expected, "{to} {place}");
        }
    }
}
