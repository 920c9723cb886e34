//! The work of a study as it gets done: one line of JSON per finished piece, so that a kill loses no finished run.
//!
//! The first line says which plan the pieces belong to. Each line carries a checksum ([`LineChain`]): one that was altered
//! is refused with its number. A last line that was cut short by a kill is no piece and is dropped.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use armid::remedy::{Remedy, Setting};

use super::LineChain;
use super::journal_text::{Extent, Header, Reader, piece_of, read};
use super::piece::Piece;
use crate::error::Error;
use crate::output::{make_folder, sync_folder_of};

/// So much work may be lost where the power is cut; a kill loses none.
const SYNC_EVERY: Duration = Duration::from_secs(5);

/// A journal that is open for more pieces.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    chain: LineChain,
    /// Length of all whole lines, bytes.
    whole: u64,
    synced: Instant,
    /// Where finished work that was found and is not gone on with is kept.
    put_aside: Option<PathBuf>,
}

impl Journal {
    /// What a journal is called in its folder.
    pub const NAME: &'static str = "journal.jsonl";

    /// What a new study calls the journal of an interrupted one that it found in its folder; a second one gets a number.
    pub const BEFORE: &'static str = "journal-before.jsonl";

    /// Begins a journal, or goes on with the one that is there where `resume` says so: `take` gets each finished piece in it
    /// with the byte that its line begins at. No other process may write to it then, and finished pieces that are not gone on
    /// with are kept under another name.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written, another process writes it, it is of another plan, or a line was altered, and
    /// those of `take`.
    pub fn open(
        folder: &Path,
        plan_sha256: &str,
        resume: bool,
        take: &mut dyn FnMut(Piece, u64) -> Result<(), Error>,
    ) -> Result<Self, Error> {
        let path = folder.join(Self::NAME);
        let fault = |error: std::io::Error| Error::unwritable(&path, &error);
        make_folder(folder).map_err(fault)?;
        let mut file = lock(&path)?;
        let mut found = Extent::default();
        let mut put_aside = None;
        if file.metadata().map_err(fault)?.len() > 0 {
            if resume {
                // A kill may have cut the very first line: then there is nothing to go on with.
                found = read(&file, &path.display().to_string(), &mut OfPlan { path: &path, plan_sha256, take })?;
            } else {
                let mut pieces = Count::default();
                if read(&file, "", &mut pieces).is_err() || pieces.0 > 0 {
                    // What cannot be read is not thrown away either.
                    let aside = free_name(folder)?;
                    std::fs::rename(&path, &aside).map_err(fault)?;
                    put_aside = Some(aside);
                    file = lock(&path)?;
                }
            }
        }
        // Whole lines stay where they are: what a kill cut short is written again.
        file.set_len(found.whole).and_then(|()| file.seek(SeekFrom::End(0))).map_err(fault)?;
        let Extent { chain, whole } = found;
        let mut journal = Self { path, file, chain, whole, synced: Instant::now(), put_aside };
        if journal.whole == 0 {
            journal.add_entry(&Header::of(plan_sha256))?;
            journal.sync().and_then(|()| sync_folder_of(&journal.path)).map_err(|error| journal.unwritable(&error))?;
        }
        Ok(journal)
    }

    /// Hands over the whole pieces of a journal, each with the byte that its line begins at; one that a kill cut within its
    /// first line holds none.
    ///
    /// # Errors
    /// [`Error`] where it cannot be read, is of another plan, or a line was altered, and those of `take`.
    pub fn read(
        path: &Path,
        plan_sha256: &str,
        take: &mut dyn FnMut(Piece, u64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let file = File::open(path).map_err(|error| Error::unreadable(path, &error))?;
        read(&file, &path.display().to_string(), &mut OfPlan { path, plan_sha256, take })?;
        Ok(())
    }

    /// The piece whose line begins at this byte, as it was read or added before.
    ///
    /// # Errors
    /// [`Error`] where it cannot be read, or another line stands there by now.
    pub fn piece_at(&mut self, at: u64) -> Result<Piece, Error> {
        let piece = piece_in(&mut self.file, &self.path, at);
        self.file.seek(SeekFrom::End(0)).map_err(|error| self.unwritable(&error))?;
        piece
    }

    /// The message about pieces that were not continued.
    pub fn note(&self) -> Option<String> {
        let aside = self.put_aside.as_ref()?.display();
        Some(format!("begun anew; finished work of an interrupted study, which can be resumed, is kept in {aside}"))
    }

    /// Adds a piece; it is in the file when this returns. The byte that its line begins at.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written; the journal is then as it was before.
    pub fn add(&mut self, piece: &Piece) -> Result<u64, Error> {
        let at = self.whole;
        self.add_entry(piece)?;
        if self.synced.elapsed() >= SYNC_EVERY {
            self.sync().map_err(|error| self.unwritable(&error))?;
        }
        Ok(at)
    }

    /// Ends the journal of a study whose results are stored.
    ///
    /// # Errors
    /// [`Error`] where it cannot be removed.
    pub fn remove(self) -> Result<(), Error> {
        std::fs::remove_file(&self.path)
            .map_err(|error| Error::new(format!("{} cannot be removed: {error}", self.path.display())))
    }

    fn add_entry<T: serde::Serialize>(&mut self, value: &T) -> Result<(), Error> {
        let entry = serde_json::to_string(value).map_err(|error| Error::new(format!("a piece of work: {error}")))?;
        let mut chain = self.chain.clone();
        let line = chain.line(&entry);
        if let Err(error) = self.file.write_all(line.as_bytes()) {
            // Others may still write: no line may begin behind half of this one.
            let _ = self.file.set_len(self.whole).and_then(|()| self.file.seek(SeekFrom::End(0)));
            return Err(self.unwritable(&error));
        }
        self.whole += line.len() as u64;
        self.chain = chain;
        Ok(())
    }

    fn sync(&mut self) -> std::io::Result<()> {
        self.synced = Instant::now();
        self.file.sync_data()
    }

    fn unwritable(&self, error: &std::io::Error) -> Error {
        Error::unwritable(&self.path, error)
    }
}

/// The piece whose line begins at this byte of a journal.
pub(super) fn piece_in(file: &mut File, path: &Path, at: u64) -> Result<Piece, Error> {
    let mut line = Vec::new();
    file.seek(SeekFrom::Start(at))
        .and_then(|_| BufReader::with_capacity(1 << 14, file).read_until(b'\n', &mut line))
        .map_err(|error| Error::unreadable(path, &error))?;
    piece_of(&line).ok_or_else(|| {
        Error::new(format!(
            "{}: found another line at byte {at}, expected the one that was there before",
            path.display()
        ))
    })
}

/// Pieces of one plan alone.
struct OfPlan<'a> {
    path: &'a Path,
    plan_sha256: &'a str,
    take: &'a mut dyn FnMut(Piece, u64) -> Result<(), Error>,
}

impl Reader for OfPlan<'_> {
    fn header(&mut self, header: &Header) -> Result<(), Error> {
        header.check(self.path, self.plan_sha256)
    }

    fn piece(&mut self, piece: Piece, at: u64) -> Result<(), Error> {
        (self.take)(piece, at)
    }
}

/// How many pieces there are, of whatever work.
#[derive(Default)]
struct Count(usize);

impl Reader for Count {
    fn header(&mut self, _: &Header) -> Result<(), Error> {
        Ok(())
    }

    fn piece(&mut self, _: Piece, _: u64) -> Result<(), Error> {
        self.0 += 1;
        Ok(())
    }
}

/// A name for a journal that is put aside, which none has yet.
fn free_name(folder: &Path) -> Result<PathBuf, Error> {
    let stem = Journal::BEFORE.trim_end_matches(".jsonl");
    let numbered = (2..1000).map(|number| format!("{stem}-{number}.jsonl"));
    let mut names = std::iter::once(Journal::BEFORE.to_owned()).chain(numbered).map(|name| folder.join(name));
    names.find(|path| path.symlink_metadata().is_err()).ok_or_else(|| {
        let message = format!("{} holds 1000 journals of interrupted studies, expected fewer", folder.display());
        Error::new(message)
            .help(Remedy::from("move them away, or choose another folder with ").setting(Setting::Output))
    })
}

/// Opens a journal for one writer alone.
fn lock(path: &Path) -> Result<File, Error> {
    let fault = |error: std::io::Error| Error::unwritable(path, &error);
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(Error::new(format!("{} is not a file, expected a journal or nothing", path.display())));
    }
    let file = OpenOptions::new().create(true).read(true).write(true).truncate(false).open(path).map_err(fault)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let message = format!("{} is being written by another study", path.display());
            Err(Error::new(message)
                .help(Remedy::from("wait for it, or choose another folder with ").setting(Setting::Output)))
        }
        // A file system without locks is no reason not to work.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
    }
}
