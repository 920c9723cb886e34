//! Names that become parts of paths: those of studies, families of designs, experiments, robots, joints.

/// Longest name, bytes: every file system takes 255, and endings are added.
const LONGEST: usize = 120;

/// A name that cannot be a part of a path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{key} is \"{found}\", expected a name that a file can have: {expected}")]
pub struct FileNameError {
    /// What is called so.
    pub key: String,
    /// The name, or its beginning.
    pub found: String,
    /// What is wrong with it.
    pub expected: &'static str,
}

/// Checks that a name stays inside its folder: that it is one part of a path, on any system, and not a hidden one.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::input::check_file_name;
/// assert!(check_file_name("name", "first run, 10 %").is_ok());
/// assert!(check_file_name("name", "../../x").is_err());
/// ```
///
/// # Errors
/// [`FileNameError`] with the name and the rule.
pub fn check_file_name(key: &str, name: &str) -> Result<(), FileNameError> {
    let expected = if name.trim().is_empty() {
        "at least one letter or digit"
    } else if name.starts_with('.') {
        "no point at its beginning"
    } else if name.contains(['/', '\\', ':']) {
        "none of / \\ :"
    } else if name.chars().any(char::is_control) {
        "no control characters"
    } else if name.len() > LONGEST {
        "at most 120 bytes"
    } else {
        return Ok(());
    };
    let found = name.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    Err(FileNameError { key: key.to_owned(), found, expected })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_one_part_of_a_path() {
        for good in ["a", "condition fourier 5", "Lösung (2)", "x..y", "a".repeat(LONGEST).as_str()] {
            assert_eq!(check_file_name("name", good), Ok(()), "{good}");
        }
        for bad in [
            "",
            " ",
            ".",
            "..",
            "../../x",
            "/etc/x",
            "a/b",
            "a\\b",
            "C:x",
            ".x",
            "a\0b",
            "a\nb",
            &"a".repeat(LONGEST + 1),
        ] {
            let fault = check_file_name("name", bad).unwrap_err().to_string();
            assert!(fault.starts_with("name is \"") && fault.len() < 400 && !fault.contains(['\n', '\0']), "{fault}");
        }
    }
}
