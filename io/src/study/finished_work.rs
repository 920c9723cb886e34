//! The finished work of a study: its designs, and where each finished run stands in which journal.

use std::fs::File;
use std::path::{Path, PathBuf};

use armid::study::{Outcome, RunOrder, StudyDesign, StudySetup};

use super::journal::{Journal, piece_in};
use super::piece::Piece;
use crate::error::Error;

/// No run is finished at this position.
const NOWHERE: u64 = u64::MAX;

/// Low bits of a place: the byte that a line begins at. The journal's number is above them.
const BYTE_BITS: u32 = 44;

/// The journal of the study itself, the others being those that are merged.
const OWN: usize = 0;

/// So many journals are open at a time.
const OPEN: usize = 128;

/// A design with its Cramér–Rao standard deviations, and the wall time that it took.
#[derive(Clone, Debug)]
pub struct MadeDesign {
    /// The design.
    pub design: StudyDesign,
    /// Standard deviations of the base parameters, infinite where there is no bound.
    pub bound: Vec<f64>,
    /// Wall time, s.
    pub seconds: f64,
}

/// The finished work of a study, in its own journal and in those that are merged. Runs stay on the disk: 8 bytes are held
/// of each that is planned.
#[derive(Debug)]
pub struct FinishedWork {
    identity: String,
    order: RunOrder,
    designs: Vec<Option<MadeDesign>>,
    places: Vec<u64>,
    finished: usize,
    own: Option<Journal>,
    others: Vec<PathBuf>,
    open: Vec<(usize, File)>,
}

impl FinishedWork {
    /// No work yet, of the study whose plan has this hash.
    #[must_use]
    pub fn new(setup: &StudySetup, identity: &str) -> Self {
        let order = setup.run_order();
        Self {
            identity: identity.to_owned(),
            designs: vec![None; order.designs()],
            places: vec![NOWHERE; order.len()],
            finished: 0,
            own: None,
            others: Vec::new(),
            open: Vec::new(),
            order,
        }
    }

    /// Adds the designs of a journal.
    ///
    /// # Errors
    /// [`Error`] as that of [`Journal::read`], and where a piece does not belong to this study.
    pub fn include_designs(&mut self, journal: &Path, setup: &StudySetup) -> Result<(), Error> {
        let identity = self.identity.clone();
        Journal::read(journal, &identity, &mut |piece, _| match piece {
            Piece::Design { .. } => self.take(OWN, piece, 0, setup),
            Piece::Run { .. } => Ok(()),
        })
    }

    /// Adds designs and runs of a journal that is to be merged.
    ///
    /// # Errors
    /// As [`FinishedWork::include_designs`], and where a run is in another journal already.
    pub fn include(&mut self, journal: &Path, setup: &StudySetup) -> Result<(), Error> {
        // One that is given twice is one.
        if self.others.iter().any(|other| other == journal) {
            return Ok(());
        }
        self.others.push(journal.to_path_buf());
        let (identity, number) = (self.identity.clone(), self.others.len());
        if number >= 1 << (64 - BYTE_BITS) {
            return Err(Error::new(format!("found {number} journals, expected fewer")));
        }
        Journal::read(journal, &identity, &mut |piece, at| self.take(number, piece, at, setup))
    }

    /// Begins the study's own journal, or goes on with it.
    ///
    /// # Errors
    /// As [`Journal::open`], and where a piece does not belong to this study.
    pub fn begin(&mut self, folder: &Path, resume: bool, setup: &StudySetup) -> Result<(), Error> {
        let identity = self.identity.clone();
        let journal = Journal::open(folder, &identity, resume, &mut |piece, at| self.take(OWN, piece, at, setup))?;
        self.own = Some(journal);
        Ok(())
    }

    /// The message about work that was found and is not gone on with.
    pub fn note(&self) -> Option<String> {
        self.own.as_ref()?.note()
    }

    /// The designs that are made.
    pub fn designs(&self) -> &[Option<MadeDesign>] {
        &self.designs
    }

    /// Is the run at this position of the order finished?
    pub fn holds(&self, position: usize) -> bool {
        self.places[position] != NOWHERE
    }

    /// How many runs are finished.
    pub const fn finished(&self) -> usize {
        self.finished
    }

    /// Keeps a design; it is in the journal when this returns.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub fn keep_design(&mut self, index: usize, made: MadeDesign) -> Result<(), Error> {
        let bound = made.bound.iter().map(|&std| std.is_finite().then_some(std)).collect();
        let piece = Piece::Design { index, design: Box::new(made.design.clone()), bound, seconds: made.seconds };
        self.own()?.add(&piece)?;
        self.designs[index] = Some(made);
        Ok(())
    }

    /// Keeps a run; it is in the journal when this returns.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub fn keep_run(&mut self, outcome: Outcome, seconds: f64) -> Result<(), Error> {
        let position = self.order.position(outcome.id());
        let at = self.own()?.add(&Piece::Run { outcome: Box::new(outcome), seconds })?;
        self.put(position, OWN, at);
        Ok(())
    }

    /// The finished run at this position of the order, and its wall time in s; `None` where it is not finished.
    ///
    /// # Errors
    /// [`Error`] where it cannot be read again.
    pub fn run(&mut self, position: usize) -> Result<Option<(Outcome, f64)>, Error> {
        let place = self.places[position];
        if place == NOWHERE {
            return Ok(None);
        }
        let (journal, at) = ((place >> BYTE_BITS) as usize, place & ((1 << BYTE_BITS) - 1));
        let piece = match journal {
            OWN => self.own()?.piece_at(at)?,
            other => self.piece_of_other(other, at)?,
        };
        match piece {
            Piece::Run { outcome, seconds } if self.order.position(outcome.id()) == position => {
                Ok(Some((*outcome, seconds)))
            }
            Piece::Run { .. } | Piece::Design { .. } => {
                Err(Error::new("a journal was written to by somebody else while it was read"))
            }
        }
    }

    /// Ends the journal of a study whose results are stored.
    ///
    /// # Errors
    /// [`Error`] where it cannot be removed.
    pub fn remove(self) -> Result<(), Error> {
        self.own.map_or(Ok(()), Journal::remove)
    }

    fn own(&mut self) -> Result<&mut Journal, Error> {
        self.own.as_mut().ok_or_else(|| Error::new("the journal of the study is not begun"))
    }

    fn piece_of_other(&mut self, number: usize, at: u64) -> Result<Piece, Error> {
        let path = &self.others[number - 1];
        let place = match self.open.iter().position(|(open, _)| *open == number) {
            Some(place) => place,
            None => {
                if self.open.len() == OPEN {
                    self.open.remove(0);
                }
                self.open.push((number, File::open(path).map_err(|error| Error::unreadable(path, &error))?));
                self.open.len() - 1
            }
        };
        piece_in(&mut self.open[place].1, path, at)
    }

    /// Takes a piece that stands at this byte of a journal.
    fn take(&mut self, journal: usize, piece: Piece, at: u64, setup: &StudySetup) -> Result<(), Error> {
        piece.check(setup).map_err(|error| Error::new(format!("{}: {error}", Journal::NAME)))?;
        match piece {
            Piece::Design { index, design, bound, seconds } => {
                let bound = bound.into_iter().map(|std| std.unwrap_or(f64::INFINITY)).collect();
                self.designs[index] = Some(MadeDesign { design: *design, bound, seconds });
            }
            Piece::Run { outcome, .. } => {
                let position = self.order.position(outcome.id());
                let before = self.places[position];
                if before != NOWHERE && (before >> BYTE_BITS) as usize != journal {
                    return Err(self.overlap(&outcome, (before >> BYTE_BITS) as usize, journal));
                }
                self.put(position, journal, at);
            }
        }
        Ok(())
    }

    fn put(&mut self, position: usize, journal: usize, at: u64) {
        self.finished += usize::from(self.places[position] == NOWHERE);
        self.places[position] = (journal as u64) << BYTE_BITS | at;
    }

    fn overlap(&self, outcome: &Outcome, one: usize, other: usize) -> Error {
        let folder = |journal: usize| match journal.checked_sub(1).map(|index| self.others[index].as_path()) {
            Some(path) => path.parent().unwrap_or(path).display().to_string(),
            None => "the output folder".to_owned(),
        };
        Error::new(format!(
            "run {} of design {} is in {} and in {}, expected parts that do not overlap",
            outcome.run,
            outcome.design,
            folder(one),
            folder(other)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::number_file::tests::{outcome, setup};

    #[test]
    fn a_journal_that_was_cut_anywhere_is_gone_on_with() {
        let setup = setup();
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mut work = FinishedWork::new(&setup, "plan");
        work.begin(&at("whole"), false, &setup).unwrap();
        let positions = [7, 3, 1501];
        for position in positions {
            work.keep_run(outcome(&setup, position), 0.5).unwrap();
        }
        // Runs are read again in any order, between others that are added.
        for position in [3, 1501, 7] {
            assert_eq!(work.run(position).unwrap(), Some((outcome(&setup, position), 0.5)));
        }
        assert_eq!(work.run(8).unwrap(), None);
        drop(work);
        let bytes = std::fs::read(at("whole").join(Journal::NAME)).unwrap();
        let lines: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i] == b'\n').map(|i| i + 1).collect();
        assert_eq!(lines.len(), 4);
        let mut cuts: Vec<usize> = (0..=lines[0]).collect();
        cuts.extend(lines.iter().flat_map(|&end| [end - 1, end]));
        std::fs::create_dir(at("cut")).unwrap();
        for cut in cuts {
            let journal = at("cut").join(Journal::NAME);
            std::fs::write(&journal, &bytes[..cut]).unwrap();
            let kept = lines.iter().filter(|&&end| end <= cut).count().saturating_sub(1);
            // Somebody who only looks sees the same.
            let mut seen = FinishedWork::new(&setup, "plan");
            seen.include(&journal, &setup).unwrap();
            assert_eq!(seen.finished(), kept, "cut at {cut}");
            let mut work = FinishedWork::new(&setup, "plan");
            work.begin(&at("cut"), true, &setup).unwrap();
            assert_eq!(work.finished(), kept, "cut at {cut}");
            for &position in &positions[kept..] {
                work.keep_run(outcome(&setup, position), 0.5).unwrap();
            }
            drop(work);
            assert!(std::fs::read(&journal).unwrap() == bytes, "cut at {cut}");
        }
        let mut other = FinishedWork::new(&setup, "another plan");
        assert!(other.begin(&at("whole"), true, &setup).unwrap_err().to_string().contains("another plan"));
    }

    #[test]
    fn parts_that_overlap_are_refused() {
        let setup = setup();
        let folder = tempfile::tempdir().unwrap();
        for (name, positions) in [("a", [1, 2]), ("b", [3, 4]), ("c", [5, 2])] {
            let mut work = FinishedWork::new(&setup, "plan");
            work.begin(&folder.path().join(name), false, &setup).unwrap();
            positions.iter().for_each(|&position| work.keep_run(outcome(&setup, position), 1.0).unwrap());
        }
        let mut work = FinishedWork::new(&setup, "plan");
        for name in ["a", "b", "a"] {
            work.include(&folder.path().join(name).join(Journal::NAME), &setup).unwrap();
        }
        assert_eq!(work.finished(), 4);
        assert_eq!(work.run(4).unwrap(), Some((outcome(&setup, 4), 1.0)));
        let fault = work.include(&folder.path().join("c").join(Journal::NAME), &setup).unwrap_err().to_string();
        assert!(fault.contains("run 2 of design 0 is in") && fault.contains("do not overlap"), "{fault}");
    }
}
