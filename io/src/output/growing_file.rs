//! A file that grows under another name beside its place, and takes its name when it is whole.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::file_system::name_file;
use super::place::regular_file;
use super::whole_file::make_folder;
use crate::error::Error;

/// `R.parquet.part` until it is `R.parquet`. Where it never becomes whole, the part is removed; a kill leaves it, and the
/// next one that is begun there takes its place.
#[derive(Debug)]
pub(crate) struct GrowingFile {
    place: PathBuf,
    part: PathBuf,
    out: BufWriter<File>,
    whole: bool,
}

impl GrowingFile {
    /// Begins a file.
    ///
    /// # Errors
    /// [`Error`] where it cannot be made, or something else than a file is at its place.
    pub(crate) fn create(path: &Path) -> Result<Self, Error> {
        let place = regular_file(path)?;
        let fault = |error: io::Error| Error::unwritable(path, &error);
        if let Some(folder) = place.parent() {
            make_folder(folder).map_err(fault)?;
        }
        let mut part = place.as_os_str().to_owned();
        part.push(".part");
        let part = PathBuf::from(part);
        let out = BufWriter::new(File::create(regular_file(&part)?).map_err(fault)?);
        Ok(Self { place, part, out, whole: false })
    }

    /// Gives it its name; it is on the disk then.
    ///
    /// # Errors
    /// [`io::Error`] where that fails.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.out.flush()?;
        name_file(self.out.get_ref(), &self.part, &self.place)?;
        self.whole = true;
        Ok(())
    }
}

impl Write for GrowingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl Drop for GrowingFile {
    fn drop(&mut self) {
        if !self.whole {
            // What cannot be removed is written over by the next one.
            let _ = std::fs::remove_file(&self.part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_at_its_place_when_it_is_whole_and_not_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/rows.parquet");
        let names = || -> Vec<String> {
            let entries = std::fs::read_dir(folder.path().join("new")).unwrap();
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
        };
        let mut file = GrowingFile::create(&path).unwrap();
        file.write_all(b"half").unwrap();
        assert_eq!(names(), ["rows.parquet.part"]);
        drop(file);
        assert!(names().is_empty());
        std::fs::write(folder.path().join("new/rows.parquet.part"), "what a kill left, longer than the next one")
            .unwrap();
        let mut file = GrowingFile::create(&path).unwrap();
        file.write_all(b"whole").unwrap();
        file.finish().unwrap();
        assert_eq!(
            (names(), std::fs::read_to_string(&path).unwrap()),
            (vec!["rows.parquet".to_owned()], "whole".to_owned())
        );
    }
}
