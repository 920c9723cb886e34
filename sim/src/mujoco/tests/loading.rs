//! Libraries that are not there, not whole, or not the right one.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::mujoco::library::Library;
use crate::mujoco::places::{Surroundings, files};
use crate::{MujocoError, MujocoStatus};

fn fault(path: &Path) -> MujocoError {
    Library::open(path).err().unwrap_or_else(|| panic!("{} was taken", path.display()))
}

/// A library of our own that says it is some version.
fn impostor(folder: &Path, name: &str, source: &str) -> PathBuf {
    let (code, library) = (folder.join("impostor.c"), folder.join(name));
    std::fs::write(&code, source).unwrap();
    let mut cc = Command::new("cc");
    let status = cc.args(["-shared", "-fPIC", "-o"]).arg(&library).arg(&code).status();
    assert!(status.expect("a C compiler called cc, which links Rust programs too").success());
    library
}

#[test]
fn a_library_cut_short_is_named_with_both_lengths() {
    let library = Library::get().unwrap_or_else(|fault| panic!("{fault}"));
    let whole = std::fs::read(library.path()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let name = &files()[0];
    let path = folder.path().join(name);
    for length in [70, 5000, whole.len() / 2, whole.len() - 4096] {
        std::fs::write(&path, &whole[..length]).unwrap();
        let found = fault(&path);
        assert!(
            matches!(&found, MujocoError::Truncated { path: named, found, expected }
                if *named == path && *found == length as u64 && *expected > *found),
            "{length} bytes: {found}"
        );
        let text = found.to_string();
        assert!(text.contains(name.as_str()) && text.contains("scripts/get-mujoco"), "{text}");
    }
}

#[test]
fn another_version_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (number, version) in [("3016002", "3.16.2"), ("337", "3.3.7")] {
        let path = impostor(folder.path(), version, &format!("int mj_version(void) {{ return {number}; }}"));
        let found = fault(&path);
        assert_eq!(found, MujocoError::Version { path: path.clone(), found: version.to_owned() });
        let text = found.to_string();
        assert!(
            text.contains(&format!("found MuJoCo {version}, expected 3.17.0 or 4.0.0; run scripts/get-mujoco")),
            "{text}"
        );
    }
}

#[test]
fn what_is_no_mujoco_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("libmujoco.so");
    std::fs::write(&text, "<html>Not found</html>").unwrap();
    let nameless = impostor(folder.path(), "nameless.so", "int x;");
    let bare = impostor(folder.path(), "bare.so", "int mj_version(void) { return 3017000; }");
    for (path, reason) in
        [(text, "not a shared library"), (nameless, "without mj_version"), (bare, "without mj_parseXMLString")]
    {
        let found = fault(&path).to_string();
        assert!(found.contains(reason) && found.contains("scripts/get-mujoco"), "{found}");
    }
}

#[test]
fn a_library_that_is_nowhere_names_the_command_and_the_places() {
    let folder = tempfile::tempdir().unwrap();
    let named = folder.path().join("libmujoco-of-mine.so");
    let around = Surroundings { variable: Some(named.clone().into()), ..Surroundings::default() };
    let found = Library::find(&around).err().expect("an empty folder");
    assert!(matches!(&found, MujocoError::Unreadable { path, .. } if *path == named));
    let text = found.to_string();
    assert!(text.contains("libmujoco-of-mine.so") && text.contains("scripts/get-mujoco"), "{text}");
    let found = MujocoError::NotFound { searched: vec!["/a/third_party/mujoco".into(), "/b".into()] }.to_string();
    assert_eq!(
        found,
        format!(
            "found no {} in /a/third_party/mujoco, /b, nor by the system's loader; run scripts/get-mujoco, which \
             fetches MuJoCo 3.17.0",
            files().join(" or ")
        )
    );
}

#[test]
fn the_library_is_here_and_its_status_says_so() {
    match MujocoStatus::now() {
        MujocoStatus::Found { path, version } => {
            assert_eq!(version, "3.17.0");
            assert!(!path.as_os_str().is_empty());
        }
        MujocoStatus::Missing { reason } => panic!("{reason}"),
    }
}
