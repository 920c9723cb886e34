//! The command under test.
#![allow(dead_code, reason = "each test file uses its own share")]

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use assert_cmd::assert::Assert;

/// The binary.
pub(crate) fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin!("armid").to_path_buf()
}

/// Runs `armid` with some arguments.
pub(crate) fn armid<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Assert {
    assert_cmd::Command::new(program()).args(arguments).assert()
}

/// Runs `armid` in a folder.
pub(crate) fn armid_in<A: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = A>) -> Assert {
    assert_cmd::Command::new(program()).current_dir(folder).args(arguments).assert()
}

/// What it wrote to standard output.
pub(crate) fn stdout(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).expect("text")
}

/// What it wrote to standard error.
pub(crate) fn stderr(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stderr.clone()).expect("text")
}

/// Standard output as one JSON value.
pub(crate) fn json(assert: &Assert) -> serde_json::Value {
    let text = stdout(assert);
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error} in {text}"))
}

/// A folder that goes away with the test.
pub(crate) fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Writes a file into a folder and returns its path.
pub(crate) fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("a file in a temporary folder");
    path.to_str().expect("a path in UTF-8").to_owned()
}

/// An experiment named "first": Table I on the A460, with this many periods that count.
pub(crate) fn experiment(folder: &Path, periods: usize) -> String {
    let text = format!("name = \"first\"\nrobot = \"crs-a460\"\ntrajectory = \"table-one\"\nperiods = {periods}\n");
    write(folder, "experiment.toml", &text)
}

/// Every file below a folder but those that hold wall times and dates.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let (mut found, mut open) = (BTreeMap::new(), vec![folder.to_path_buf()]);
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(&next).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path);
            } else if !["timing.parquet", "provenance.json"].iter().any(|name| path.ends_with(name)) {
                let name = path.strip_prefix(folder).expect("a path below it").display().to_string();
                found.insert(name, std::fs::read(&path).expect("a file"));
            }
        }
    }
    found
}

/// The stored summary of a study.
pub(crate) fn summary(folder: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(folder.join("summary.json")).expect("a summary");
    serde_json::from_str(&text).expect("JSON")
}
