//! What stands in a journal.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use armid::input::size::RECORDING_BYTES;

use super::line_chain::{Broken, LineChain};
use super::piece::Piece;
use crate::error::Error;

/// Which work the pieces are of.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Header {
    armid: String,
    plan_sha256: String,
}

/// A journal as it was read.
#[derive(Debug, Default)]
pub(super) struct Contents {
    pub(super) header: Header,
    pub(super) pieces: Vec<Piece>,
    /// Where its whole lines end.
    pub(super) chain: LineChain,
    /// Their length, bytes.
    pub(super) whole: u64,
}

impl Header {
    pub(super) fn of(plan_sha256: &str) -> Self {
        Self { armid: env!("CARGO_PKG_VERSION").to_owned(), plan_sha256: plan_sha256.to_owned() }
    }

    pub(super) fn check(&self, path: &Path, plan_sha256: &str) -> Result<(), Error> {
        if self.plan_sha256 == plan_sha256 && self.armid == env!("CARGO_PKG_VERSION") {
            return Ok(());
        }
        let message = "belongs to another plan, number of runs, arms or version of armid; begin anew without --resume, \
                       or choose another folder with -o";
        Err(Error::new(format!("{}: {message}", path.display())))
    }
}

/// Reads a journal; a last line without its end was cut short by a kill and is no part of it.
///
/// # Errors
/// [`Error`] with the number of a line that is whole and is not what was written there.
pub(super) fn read(file: &File, name: &str) -> Result<Contents, Error> {
    let fault = |error: &std::io::Error| Error::new(format!("{name} cannot be read: {error}"));
    let length = file.metadata().map_err(|error| fault(&error))?.len();
    RECORDING_BYTES.check(name, length as f64).map_err(|error| Error::new(error.to_string()))?;
    parse(BufReader::new(file), name)
}

/// The pieces in the bytes of a journal.
///
/// # Errors
/// [`Error`] with the number of a line that is whole and is not what was written there.
pub fn parse_journal(name: &str, bytes: &[u8]) -> Result<Vec<Piece>, Error> {
    Ok(parse(bytes, name)?.pieces)
}

fn parse(mut reader: impl BufRead, name: &str) -> Result<Contents, Error> {
    let mut found = Contents::default();
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        reader.read_until(b'\n', &mut line).map_err(|error| Error::new(format!("{name} cannot be read: {error}")))?;
        if line.last() != Some(&b'\n') {
            break;
        }
        let refused = |what: &str| Error::new(format!("{name}:{number}: {what}"));
        let entry = found.chain.entry(&line).map_err(|broken| match broken {
            Broken::Form if number == 1 && line.starts_with(b"{\"armid\"") => refused(
                "the journal has no checksums: an older armid wrote it",
            )
            .help("begin anew without --resume, which keeps it under another name, or choose another folder with -o"),
            Broken::Form => refused("found no line of a journal, expected a checksum and an entry").help(ALTERED),
            Broken::Checksum => {
                refused("the checksum does not fit: the line was altered, or lines before it are missing").help(ALTERED)
            }
        })?;
        let wrong = |error: serde_json::Error| refused(&format!("{error}"));
        if number == 1 {
            found.header = serde_json::from_str(entry).map_err(wrong)?;
        } else {
            found.pieces.push(serde_json::from_str(entry).map_err(wrong)?);
        }
        found.whole += line.len() as u64;
    }
    Ok(found)
}

const ALTERED: &str = "the lines before it are as they were written: cut the file off there and --resume, or begin anew \
                       without --resume, which keeps it under another name";
