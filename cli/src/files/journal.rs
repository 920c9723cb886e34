//! The work of a study as it gets done: one line of JSON per finished piece, so that a kill loses no finished run.
//!
//! The first line says which plan the pieces belong to. A line that was cut short by a kill is no piece and is dropped.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Lines, Write};
use std::path::{Path, PathBuf};

use armid::study::{Outcome, StudyDesign};
use miette::Result;

use crate::fault::Fault;

/// A finished piece of a study.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Piece {
    /// A design, with the Cramér–Rao standard deviations at its exact motion, none where there is no bound, and the seconds that it took.
    Design { index: usize, design: Box<StudyDesign>, bound: Vec<Option<f64>>, seconds: f64 },
    /// A run, with the seconds that it took.
    Run { outcome: Box<Outcome>, seconds: f64 },
}

#[derive(serde::Serialize, serde::Deserialize)]
struct Header {
    armid: String,
    plan_sha256: String,
}

/// A journal that is open for more pieces.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    pub(crate) const NAME: &'static str = "journal.jsonl";

    /// Begins a journal, or goes on with the one that is there where `resume` says so.
    pub(crate) fn open(folder: &Path, plan_sha256: &str, resume: bool) -> Result<(Self, Vec<Piece>)> {
        let path = folder.join(Self::NAME);
        let fault = |error: std::io::Error| Fault::new(format!("{} cannot be written: {error}", path.display()));
        std::fs::create_dir_all(folder).map_err(fault)?;
        let pieces = if resume && path.is_file() { Self::read(&path, plan_sha256)? } else { Vec::new() };
        // Whole lines only: what a kill cut short is written again.
        let mut file = OpenOptions::new().create(true).write(true).truncate(true).open(&path).map_err(fault)?;
        let header = Header { armid: env!("CARGO_PKG_VERSION").to_owned(), plan_sha256: plan_sha256.to_owned() };
        let mut text = json_line(&header)?;
        for piece in &pieces {
            text.push_str(&json_line(piece)?);
        }
        file.write_all(text.as_bytes()).and_then(|()| file.flush()).map_err(fault)?;
        Ok((Self { path, file }, pieces))
    }

    /// The whole pieces of a journal.
    pub(crate) fn read(path: &Path, plan_sha256: &str) -> Result<Vec<Piece>> {
        let fault = |reason: String| Fault::new(format!("{}: {reason}", path.display()));
        let (header, lines) = Self::begin(path)?;
        if header.plan_sha256 != plan_sha256 || header.armid != env!("CARGO_PKG_VERSION") {
            let message = "belongs to another plan, number of runs, arms or version of armid; begin anew without --resume, \
                           or choose another folder with -o";
            return Err(fault(message.to_owned()).into());
        }
        Ok(lines.map_while(|line| serde_json::from_str(&line.ok()?).ok()).collect())
    }

    fn begin(path: &Path) -> Result<(Header, Lines<BufReader<File>>)> {
        let fault = |reason: String| Fault::new(format!("{}: {reason}", path.display()));
        let file = File::open(path).map_err(|error| fault(format!("cannot be read: {error}")))?;
        let mut lines = BufReader::new(file).lines();
        let first = lines.next().transpose().map_err(|error| fault(error.to_string()))?.unwrap_or_default();
        let header = serde_json::from_str(&first)
            .map_err(|error| fault(format!("line 1 is no header of a journal: {error}")))?;
        Ok((header, lines))
    }

    /// Adds a piece; it is in the file when this returns.
    pub(crate) fn add(&mut self, piece: &Piece) -> Result<()> {
        let line = json_line(piece)?;
        self.file
            .write_all(line.as_bytes())
            .and_then(|()| self.file.flush())
            .map_err(|error| Fault::new(format!("{} cannot be written: {error}", self.path.display())).into())
    }

    /// Ends the journal of a study whose results are stored.
    pub(crate) fn remove(self) -> Result<()> {
        std::fs::remove_file(&self.path)
            .map_err(|error| Fault::new(format!("{} cannot be removed: {error}", self.path.display())).into())
    }
}

fn json_line<T: serde::Serialize>(value: &T) -> Result<String> {
    let mut line = serde_json::to_string(value).map_err(|error| Fault::new(format!("a piece of work: {error}")))?;
    line.push('\n');
    Ok(line)
}
