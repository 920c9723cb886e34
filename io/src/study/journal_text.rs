//! What stands in a journal.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use armid::input::size::RECORDING_BYTES;
use armid::remedy::{Remedy, Setting};

use super::line_chain::{Broken, LineChain, entry_of};
use super::piece::Piece;
use crate::error::Error;

/// Which work the pieces are of.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Header {
    armid: String,
    plan_sha256: String,
    /// By which motions and metrics its runs are scored.
    #[serde(default)]
    scores: u32,
}

/// The scores of this version: 0 on random motions alone, 1 on four kinds of motion, all inside the torque ratings.
const SCORES: u32 = 1;

/// Where the whole lines of a journal end.
#[derive(Debug, Default)]
pub(super) struct Extent {
    pub(super) chain: LineChain,
    /// Their length, bytes.
    pub(super) whole: u64,
}

/// What is done with the entries of a journal as they are read.
pub(super) trait Reader {
    /// The first line says which work the pieces are of.
    fn header(&mut self, header: &Header) -> Result<(), Error>;

    /// A piece, and the byte that its line begins at.
    fn piece(&mut self, piece: Piece, at: u64) -> Result<(), Error>;
}

impl Header {
    pub(super) fn of(plan_sha256: &str) -> Self {
        Self { armid: env!("CARGO_PKG_VERSION").to_owned(), plan_sha256: plan_sha256.to_owned(), scores: SCORES }
    }

    pub(super) fn check(&self, path: &Path, plan_sha256: &str) -> Result<(), Error> {
        if self.plan_sha256 == plan_sha256 && self.armid == env!("CARGO_PKG_VERSION") && self.scores == SCORES {
            return Ok(());
        }
        let message = "belongs to another plan, number of runs, arms or version of armid";
        Err(Error::new(format!("{}: {message}", path.display())).help(anew("")))
    }
}

/// Reads a journal piece by piece; a last line without its end was cut short by a kill and is no part of it.
///
/// # Errors
/// [`Error`] with the number of a line that is whole and is not what was written there, and those of the reader.
pub(super) fn read(file: &File, name: &str, reader: &mut dyn Reader) -> Result<Extent, Error> {
    let fault = |error: &std::io::Error| Error::new(format!("{name} cannot be read: {error}"));
    let length = file.metadata().map_err(|error| fault(&error))?.len();
    RECORDING_BYTES.check(name, length as f64).map_err(Error::new)?;
    parse(BufReader::with_capacity(1 << 16, file), name, reader)
}

/// The pieces in the bytes of a journal.
///
/// # Errors
/// [`Error`] with the number of a line that is whole and is not what was written there.
pub fn parse_journal(name: &str, bytes: &[u8]) -> Result<Vec<Piece>, Error> {
    let mut pieces = Pieces::default();
    parse(bytes, name, &mut pieces)?;
    Ok(pieces.0)
}

/// Every piece of whatever work.
#[derive(Default)]
struct Pieces(Vec<Piece>);

impl Reader for Pieces {
    fn header(&mut self, _: &Header) -> Result<(), Error> {
        Ok(())
    }

    fn piece(&mut self, piece: Piece, _: u64) -> Result<(), Error> {
        self.0.push(piece);
        Ok(())
    }
}

fn parse(mut bytes: impl BufRead, name: &str, reader: &mut dyn Reader) -> Result<Extent, Error> {
    let mut found = Extent::default();
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        bytes.read_until(b'\n', &mut line).map_err(|error| Error::new(format!("{name} cannot be read: {error}")))?;
        if line.last() != Some(&b'\n') {
            break;
        }
        let refused = |what: &str| Error::new(format!("{name}:{number}: {what}"));
        let entry = found.chain.entry(&line).map_err(|broken| match broken {
            Broken::Form if number == 1 && line.starts_with(b"{\"armid\"") => {
                refused("the journal has no checksums: an older armid wrote it").help(anew(""))
            }
            Broken::Form => refused("found no line of a journal, expected a checksum and an entry").help(anew(ALTERED)),
            Broken::Checksum => {
                refused("the checksum does not fit: the line was altered, or lines before it are missing")
                    .help(anew(ALTERED))
            }
        })?;
        let wrong = |error: serde_json::Error| refused(&format!("{error}"));
        if number == 1 {
            reader.header(&serde_json::from_str(entry).map_err(wrong)?)?;
        } else {
            reader.piece(serde_json::from_str(entry).map_err(wrong)?, found.whole)?;
        }
        found.whole += line.len() as u64;
    }
    Ok(found)
}

/// The piece in a line that was read and found whole before.
pub(super) fn piece_of(line: &[u8]) -> Option<Piece> {
    serde_json::from_str(entry_of(line).ok()?).ok()
}

const ALTERED: &str = "the lines before it are as they were written: cut the file off there and resume, or ";

/// How a study begins where its folder has another journal.
fn anew(before: &str) -> Remedy {
    let help = Remedy::from(format!("{before}begin anew without ")).setting(Setting::Resume);
    help.say(", which keeps it under another name, or choose another folder with ").setting(Setting::Output)
}
