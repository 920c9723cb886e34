//! Lists the TOML files of `experiments/`, so that they are compiled in.

#![allow(clippy::print_stdout, reason = "this is how a build script passes settings to cargo")]

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let manifest = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    // In a package they lie inside it; in the workspace, beside this crate: a link leads there.
    let experiments =
        manifest.join("experiments").canonicalize().or_else(|_| manifest.join("../experiments").canonicalize())?;
    println!("cargo::rerun-if-changed={}", experiments.display());
    let mut files = Vec::new();
    for folder in entries(&experiments)?.iter().filter(|path| path.is_dir()) {
        files.extend(entries(folder)?.into_iter().filter(|path| path.extension().is_some_and(|ext| ext == "toml")));
    }
    let mut list = "static FILES: &[BundledFile] = &[\n".to_owned();
    for path in &files {
        println!("cargo::rerun-if-changed={}", path.display());
        let name = |path: Option<&Path>| {
            path.and_then(Path::file_name).map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        };
        let (folder, file) = (name(path.parent()), name(Some(path)));
        let path = path.canonicalize()?;
        let _ = writeln!(
            list,
            "    BundledFile {{ folder: {folder:?}, file: {file:?}, text: include_str!({:?}) }},",
            path.display().to_string()
        );
    }
    list.push_str("];\n");
    fs::write(PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default()).join("bundled_experiments.rs"), list)
}

/// What a folder holds, in the order of the names; nothing where there is no folder.
fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut paths = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}
