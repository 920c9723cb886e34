//! The work of a study as it gets done: one line of JSON per finished piece, so that a kill loses no finished run.
//!
//! The first line says which plan the pieces belong to. A line that was cut short by a kill is no piece and is dropped.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use armid::study::{Outcome, StudyDesign};

use crate::error::Error;

/// A finished piece of a study.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Piece {
    /// A design, with the Cramér–Rao standard deviations at its exact motion, none where there is no bound.
    Design {
        /// Its place in the list of designs.
        index: usize,
        /// The design.
        design: Box<StudyDesign>,
        /// Standard deviations of the base parameters.
        bound: Vec<Option<f64>>,
        /// Wall time, s.
        seconds: f64,
    },
    /// A run.
    Run {
        /// What came of it.
        outcome: Box<Outcome>,
        /// Wall time, s.
        seconds: f64,
    },
}

#[derive(serde::Serialize, serde::Deserialize)]
struct Header {
    armid: String,
    plan_sha256: String,
}

/// A journal that is open for more pieces.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Finished pieces of an interrupted study that were found and kept as [`Self::BEFORE`].
    put_aside: usize,
}

impl Journal {
    /// What a journal is called in its folder.
    pub const NAME: &'static str = "journal.jsonl";

    /// What a new study calls the journal of an interrupted one that it found in its folder.
    pub const BEFORE: &'static str = "journal-before.jsonl";

    /// Begins a journal, or goes on with the one that is there where `resume` says so. Nobody else may write to it then,
    /// and finished pieces that are not gone on with are kept under another name.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written, somebody else writes it, or it is of another plan.
    pub fn open(folder: &Path, plan_sha256: &str, resume: bool) -> Result<(Self, Vec<Piece>), Error> {
        let path = folder.join(Self::NAME);
        let fault = |error: std::io::Error| Error::new(format!("{} cannot be written: {error}", path.display()));
        std::fs::create_dir_all(folder).map_err(fault)?;
        let mut file = lock(&path)?;
        let (mut pieces, mut whole, mut put_aside) = (Vec::new(), 0, 0);
        if resume && file.metadata().map_err(fault)?.len() > 0 {
            let header;
            (header, pieces, whole) = read_pieces(&file, &path)?;
            header.check(&path, plan_sha256)?;
        } else if !resume {
            put_aside = read_pieces(&file, &path).map_or(0, |(_, pieces, _)| pieces.len());
            if put_aside > 0 {
                std::fs::rename(&path, folder.join(Self::BEFORE)).map_err(fault)?;
                file = lock(&path)?;
            }
        }
        // Whole lines stay where they are: what a kill cut short is written again.
        file.set_len(whole).and_then(|()| file.seek(SeekFrom::End(0))).map_err(fault)?;
        if whole == 0 {
            let header = Header { armid: env!("CARGO_PKG_VERSION").to_owned(), plan_sha256: plan_sha256.to_owned() };
            file.write_all(json_line(&header)?.as_bytes()).map_err(fault)?;
        }
        Ok((Self { path, file, put_aside }, pieces))
    }

    /// The whole pieces of a journal.
    ///
    /// # Errors
    /// [`Error`] where it cannot be read, or is of another plan.
    pub fn read(path: &Path, plan_sha256: &str) -> Result<Vec<Piece>, Error> {
        let fault = |error: std::io::Error| Error::new(format!("{} cannot be read: {error}", path.display()));
        let (header, pieces, _) = read_pieces(&File::open(path).map_err(fault)?, path)?;
        header.check(path, plan_sha256)?;
        Ok(pieces)
    }

    /// The message about pieces that were not continued.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        (self.put_aside > 0).then(|| {
            format!(
                "begun anew; {} finished pieces of an interrupted study, which --resume would have gone on with, are kept in {}",
                self.put_aside,
                Self::BEFORE
            )
        })
    }

    /// Adds a piece; it is in the file when this returns.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub fn add(&mut self, piece: &Piece) -> Result<(), Error> {
        let line = json_line(piece)?;
        self.file
            .write_all(line.as_bytes())
            .and_then(|()| self.file.flush())
            .map_err(|error| Error::new(format!("{} cannot be written: {error}", self.path.display())))
    }

    /// Ends the journal of a study whose results are stored.
    ///
    /// # Errors
    /// [`Error`] where it cannot be removed.
    pub fn remove(self) -> Result<(), Error> {
        std::fs::remove_file(&self.path)
            .map_err(|error| Error::new(format!("{} cannot be removed: {error}", self.path.display())))
    }
}

impl Header {
    fn check(&self, path: &Path, plan_sha256: &str) -> Result<(), Error> {
        if self.plan_sha256 == plan_sha256 && self.armid == env!("CARGO_PKG_VERSION") {
            return Ok(());
        }
        let message = "belongs to another plan, number of runs, arms or version of armid; begin anew without --resume, \
                       or choose another folder with -o";
        Err(Error::new(format!("{}: {message}", path.display())))
    }
}

/// Opens a journal for one writer alone.
fn lock(path: &Path) -> Result<File, Error> {
    let fault = |error: std::io::Error| Error::new(format!("{} cannot be written: {error}", path.display()));
    let file = OpenOptions::new().create(true).read(true).write(true).truncate(false).open(path).map_err(fault)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let message = format!("{} is being written by another study", path.display());
            Err(Error::new(message).help("wait for it, or choose another folder with -o"))
        }
        // A file system without locks is no reason not to work.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
    }
}

/// Header and whole pieces of a journal, and where in the file they end, bytes.
fn read_pieces(file: &File, path: &Path) -> Result<(Header, Vec<Piece>, u64), Error> {
    let fault = |reason: String| Error::new(format!("{}: {reason}", path.display()));
    let mut reader = BufReader::new(file);
    let mut line = String::new();
    reader.read_line(&mut line).map_err(|error| fault(error.to_string()))?;
    let header =
        serde_json::from_str(&line).map_err(|error| fault(format!("line 1 is no header of a journal: {error}")))?;
    let mut whole = line.len() as u64;
    let mut pieces = Vec::new();
    loop {
        line.clear();
        // A line that a kill cut short may end within a character.
        let read = reader.read_line(&mut line).unwrap_or(0);
        let Some(piece) = line.strip_suffix('\n').and_then(|line| serde_json::from_str(line).ok()) else { break };
        pieces.push(piece);
        whole += read as u64;
    }
    Ok((header, pieces, whole))
}

fn json_line<T: serde::Serialize>(value: &T) -> Result<String, Error> {
    let mut line = serde_json::to_string(value).map_err(|error| Error::new(format!("a piece of work: {error}")))?;
    line.push('\n');
    Ok(line)
}
