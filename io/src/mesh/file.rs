//! A file of a mesh, by the ending of its name.

use std::path::Path;

use armid::input::size::{MESH_BYTES, MESH_POINTS};
use nalgebra::Vector3;

use super::{collada, obj, stl};
use crate::error::Error;
use crate::text::read_bytes;

/// The points of a mesh file, by the ending of its name: `.stl` (binary or text), `.obj` or `.dae`.
///
/// # Errors
/// [`Error`] where it cannot be read, ends otherwise, is too large, or is not as such a file is written.
pub fn read(path: &Path) -> Result<Vec<Vector3<f64>>, Error> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !["stl", "obj", "dae"].contains(&ending.as_str()) {
        let message = format!("{} ends in \"{ending}\", expected .stl, .obj or .dae", path.display());
        return Err(Error::new(message));
    }
    let bytes = read_bytes(path, &MESH_BYTES)?;
    parse(&ending, &bytes).map_err(|fault| Error::new(format!("{}: {fault}", path.display())))
}

/// The points of a mesh in memory; `ending` is `stl`, `obj` or `dae`.
///
/// # Errors
/// What was found and what was expected.
pub fn parse(ending: &str, bytes: &[u8]) -> Result<Vec<Vector3<f64>>, String> {
    let points = match ending {
        "stl" => stl::points(bytes)?,
        "obj" => obj::points(&String::from_utf8_lossy(bytes))?,
        "dae" => collada::points(std::str::from_utf8(bytes).map_err(|fault| format!("{fault}, expected UTF-8"))?)?,
        other => return Err(format!("\"{other}\" is no format of meshes that is read, expected stl, obj or dae")),
    };
    MESH_POINTS.check_count("number of points", points.len()).map_err(|fault| fault.to_string())?;
    if points.is_empty() {
        return Err("the mesh has no points, expected at least one".to_owned());
    }
    match points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        Some(index) => Err(format!("point {} is not finite, expected three finite numbers", index + 1)),
        None => Ok(points),
    }
}
