//! Texts with their names, so that an error can point into them.

use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::Path;
use std::sync::Arc;

use armid::input::SizeLimit;
use armid::input::size::TEXT_BYTES;

use crate::error::Error;

/// Bytes that are read in pieces, and again from the beginning.
pub(crate) trait Source: Read + Seek {}

impl<T: Read + Seek> Source for T {}

/// Opens a file to be read in pieces, unless it is longer than a limit; a pipe or a device is held in memory.
pub(crate) fn open(path: &Path, limit: &SizeLimit) -> Result<Box<dyn Source>, Error> {
    let unreadable = |error: std::io::Error| Error::unreadable(path, &error);
    let about = std::fs::metadata(path).map_err(unreadable)?;
    if !about.is_file() {
        return Ok(Box::new(Cursor::new(read_bytes(path, limit)?)));
    }
    limit.check(&path.display().to_string(), about.len() as f64)?;
    Ok(Box::new(File::open(path).map_err(unreadable)?))
}

/// Reads a file, a pipe or a device to its end, unless that lies beyond a limit.
pub(crate) fn read_bytes(path: &Path, limit: &SizeLimit) -> Result<Vec<u8>, Error> {
    let unreadable = |error: std::io::Error| Error::unreadable(path, &error);
    let file = File::open(path).map_err(unreadable)?;
    let about = file.metadata().map_err(unreadable)?;
    let too_large = |length: u64| limit.check(&path.display().to_string(), length as f64).map_err(Error::from);
    too_large(about.len())?;
    let mut bytes = Vec::with_capacity(usize::try_from(about.len()).unwrap_or(0));
    file.take(limit.most + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    too_large(bytes.len() as u64)?;
    Ok(bytes)
}

/// A text and what it is called: a path, or a word for what was compiled in or recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// What errors call it.
    pub name: String,
    /// What is in it.
    pub content: Arc<str>,
}

impl Text {
    /// A text with a name.
    pub fn new(name: impl Into<String>, content: impl Into<Arc<str>>) -> Self {
        Self { name: name.into(), content: content.into() }
    }

    /// Reads a file as UTF-8.
    ///
    /// # Errors
    /// [`Error`] where it cannot be read, and with the line where it is no UTF-8.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::of_bytes(path, read_bytes(path, &TEXT_BYTES)?)
    }

    /// The bytes of a file as UTF-8.
    pub(crate) fn of_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, Error> {
        match String::from_utf8(bytes) {
            Ok(content) => Ok(Self::new(path.display().to_string(), content)),
            Err(error) => {
                let at = error.utf8_error().valid_up_to();
                let line = error.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count() + 1;
                Err(Error::new(format!("{}:{line}: byte {at} is not UTF-8, expected text", path.display())))
            }
        }
    }

    /// The byte at which a line and a column begin, both counted from one, the column in characters.
    pub(crate) fn offset(&self, line: usize, column: usize) -> usize {
        let mut offset = 0;
        for (number, content) in self.content.split_inclusive('\n').enumerate() {
            if number + 1 == line {
                let within = content.char_indices().nth(column.saturating_sub(1)).map_or(content.len(), |(at, _)| at);
                return offset + within;
            }
            offset += content.len();
        }
        self.content.len()
    }

    /// Line and column of a byte, both counted from one.
    pub fn line_and_column(&self, offset: usize) -> (usize, usize) {
        let mut offset = offset.min(self.content.len());
        while !self.content.is_char_boundary(offset) {
            offset -= 1;
        }
        let before = &self.content[..offset];
        let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
        (before.matches('\n').count() + 1, column)
    }
}
