//! Where `-o` points: checked before the work begins, so that no result is lost at its end.

use std::fmt;
use std::path::{Path, PathBuf};

use armid::input::check_file_name;
use armid_io::Error;
use armid_io::output::{folder, regular_file};

/// What a command writes, and so what `-o` may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Writes {
    /// Its answer: `-o` is a file, or `-`.
    Answer,
    /// One text beside its answer: `-o` is a file, or `-`, and then the answer does not go there.
    Text,
    /// A recording, which grows beside its place: `-o` is a file.
    Recording,
    /// Files that begin alike: `-o` is a file, whose ending is replaced.
    Several,
    /// Files in a folder of their own.
    Folder,
}

/// Where one text goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Destination {
    /// Standard output.
    StandardOutput,
    /// Into a file.
    File(PathBuf),
}

impl Destination {
    /// The file, where it is one.
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Self::StandardOutput => None,
            Self::File(path) => Some(path),
        }
    }
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StandardOutput => f.write_str("standard output"),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

impl Writes {
    /// What `-o` means for such a command.
    ///
    /// # Errors
    /// [`Error`] where something is there that cannot be written so, or standard output is wanted twice or by many files.
    pub(crate) fn destination(self, path: &Path, json: bool) -> Result<Destination, Error> {
        if path == Path::new("-") {
            return match self {
                Self::Answer => Ok(Destination::StandardOutput),
                Self::Text if json => Err(Error::new("-o - and --json both use standard output, expected one of them")),
                Self::Text => Ok(Destination::StandardOutput),
                Self::Recording => Err(Error::new(
                    "-o is -, expected a file: a recording grows beside its place and takes its name at the end",
                )),
                Self::Several | Self::Folder => {
                    Err(Error::new("-o is -, expected a path: this command writes several files"))
                }
            };
        }
        let place = match self {
            Self::Folder => folder(path)?,
            Self::Answer | Self::Text | Self::Recording | Self::Several => regular_file(path)?,
        };
        Ok(Destination::File(place))
    }
}

/// The folder below `reports/` of something with a name, which stays inside of it.
///
/// # Errors
/// [`Error`] where the name is no part of a path.
pub(crate) fn report_folder(key: &str, name: &str) -> Result<PathBuf, Error> {
    check_file_name(key, name).map_err(|error| Error::new(error).help("-o chooses the place"))?;
    Ok(Path::new("reports").join(name))
}
