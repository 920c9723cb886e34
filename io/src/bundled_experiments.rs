//! The experiments and studies that are compiled in, so that `armid` works from any folder.

/// A file of `experiments/`.
#[derive(Clone, Copy, Debug)]
pub struct BundledFile {
    /// Its folder, as `00-paper`.
    pub folder: &'static str,
    /// Its name, as `study.toml`.
    pub file: &'static str,
    /// What is in it.
    pub text: &'static str,
}

include!(concat!(env!("OUT_DIR"), "/bundled_experiments.rs"));

/// The file of this name in the folder that is called so, with or without its number, with or without `experiments/`.
pub fn find(name: &str, file: &str) -> Option<&'static BundledFile> {
    let name = name.trim_end_matches('/').trim_start_matches("./");
    let name = name.strip_prefix("experiments/").unwrap_or(name);
    FILES.iter().filter(|entry| entry.file == file).find(|entry| {
        entry.folder == name || entry.folder.split_once('-').is_some_and(|(_, without_number)| without_number == name)
    })
}

/// The folders that hold a file of this name.
pub fn names(file: &str) -> Vec<&'static str> {
    FILES.iter().filter(|entry| entry.file == file).map(|entry| entry.folder).collect()
}
