//! The numbers of all runs in a file without a name, column by column: more of them than memory holds.
//!
//! ```text
//! runs of one design under one condition, 1024 at a time: all their first numbers, then all their second ones, …
//! ```
//! in the order of the runs, 8 bytes each. The file goes away with the process.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;
use std::sync::Mutex;

use armid::study::{Outcome, RunNumber, RunOrder, RunTable, StatusCount, StudyError, StudySetup};
use nalgebra::DVector;

use crate::error::Error;

/// Runs whose numbers are written together.
const PIECE: usize = 1024;

/// Bytes of a number.
const BYTES: usize = 8;

/// What stands for no number: one that is none and that no arithmetic gives.
const NONE: u64 = 0x7ff8_0000_0a5d_0000;

/// Numbers of runs that are being written.
#[derive(Debug)]
pub(super) struct NumberWriter {
    file: File,
    order: RunOrder,
    numbers: Vec<RunNumber>,
    truths: Vec<DVector<f64>>,
    /// Position of the next run.
    next: usize,
    /// Numbers of the runs that are not in the file yet, column by column.
    piece: Vec<Vec<u64>>,
    statuses: Vec<BTreeMap<&'static str, usize>>,
}

/// Numbers of all runs.
#[derive(Debug)]
pub struct NumberFile {
    file: Mutex<File>,
    order: RunOrder,
    numbers: Vec<RunNumber>,
    statuses: Vec<BTreeMap<&'static str, usize>>,
}

impl NumberWriter {
    /// Begins a file in a folder.
    ///
    /// # Errors
    /// [`Error`] where it cannot be made.
    pub(super) fn create(folder: &Path, setup: &StudySetup) -> Result<Self, Error> {
        let numbers = setup.run_numbers();
        let order = setup.run_order();
        Ok(Self {
            file: tempfile::tempfile_in(folder).map_err(|error| Error::unwritable(folder, &error))?,
            piece: vec![Vec::with_capacity(PIECE); numbers.len()],
            statuses: vec![BTreeMap::new(); order.conditions()],
            truths: setup.scorer.truths.clone(),
            next: 0,
            order,
            numbers,
        })
    }

    /// Adds the next run.
    ///
    /// # Errors
    /// [`io::Error`] where it cannot be written.
    pub(super) fn add(&mut self, outcome: &Outcome) -> io::Result<()> {
        for (number, column) in self.numbers.iter().zip(&mut self.piece) {
            column.push(number.value(outcome, &self.truths).map_or(NONE, f64::to_bits));
        }
        *self.statuses[outcome.condition].entry(outcome.status()).or_insert(0) += 1;
        self.next += 1;
        let of_block = outcome.run as usize + 1;
        if of_block.is_multiple_of(PIECE) || of_block == self.order.runs(outcome.design) {
            let mut bytes = Vec::with_capacity(self.piece.len() * self.piece[0].len() * BYTES);
            for column in &mut self.piece {
                bytes.extend(column.drain(..).flat_map(u64::to_le_bytes));
            }
            self.file.write_all(&bytes)?;
        }
        Ok(())
    }

    /// The numbers of all runs.
    pub(super) fn finish(self) -> NumberFile {
        NumberFile { file: Mutex::new(self.file), order: self.order, numbers: self.numbers, statuses: self.statuses }
    }
}

impl NumberFile {
    /// How many runs ended before there was an estimate.
    pub fn failed(&self) -> usize {
        self.statuses.iter().flatten().filter(|(status, _)| **status != "ok").map(|(_, runs)| runs).sum()
    }

    fn read(&self, first: usize, range: Range<usize>, runs: usize, column: usize) -> io::Result<Vec<Option<f64>>> {
        let mut values = Vec::with_capacity(range.len());
        let mut file = self.file.lock().map_err(|_| io::Error::other("another thread failed while it read"))?;
        let mut bytes = vec![0; PIECE * BYTES];
        let mut from = range.start;
        while from < range.end {
            let begin = from / PIECE * PIECE;
            let of_piece = PIECE.min(runs - begin);
            let to = range.end.min(begin + of_piece);
            let place = (first + begin) * self.numbers.len() + column * of_piece + (from - begin);
            file.seek(SeekFrom::Start((place * BYTES) as u64))?;
            let bytes = &mut bytes[..(to - from) * BYTES];
            file.read_exact(bytes)?;
            values.extend(bytes.chunks_exact(BYTES).map(|bytes| {
                let bits = bytes.iter().rev().fold(0, |bits, &byte| bits << 8 | u64::from(byte));
                (bits != NONE).then(|| f64::from_bits(bits))
            }));
            from = to;
        }
        Ok(values)
    }
}

impl RunTable for NumberFile {
    fn runs(&self, design: usize, _: usize) -> usize {
        self.order.runs(design)
    }

    fn numbers(
        &self,
        design: usize,
        condition: usize,
        range: Range<usize>,
        number: RunNumber,
    ) -> Result<Vec<Option<f64>>, StudyError> {
        let column = self.numbers.iter().position(|&other| other == number);
        let column = column.ok_or_else(|| StudyError::Runs(format!("{number:?} is not among them")))?;
        let first = self.order.position(armid::study::RunId { design, condition, run: 0 });
        self.read(first, range, self.order.runs(design), column).map_err(|error| StudyError::Runs(error.to_string()))
    }

    fn statuses(&self, condition: usize) -> Vec<StatusCount> {
        let counts = self.statuses[condition].iter();
        counts.map(|(&status, &runs)| StatusCount { status: status.to_owned(), runs }).collect()
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::robot;
    use armid::study::{Metric, OutcomeTable, RunError, RunErrorKind, Score, ScoredEstimate, StudyPlan};

    /// A family of two designs, with 1500 runs each under two conditions.
    const PLAN: &str = r#"
name = "numbers"
question = "Do numbers come back?"
robot = "planar-2r"
seed = 3
runs = 1500

[experiment]
period_s = 2.0
harmonics = 2
rate_hz = 100.0
periods = 2
discarded_periods = 1

[identification]
columns = "rigid"
derivatives = "fourier"
samples_per_period = 50
estimators = ["ols", "wls"]

[validation]
trajectories = 1
samples = 20

[reference]
mass_kg = 0.1
first_moment_kg_m = 0.02
inertia_kg_m2 = 0.01
viscous_nm_s_rad = 0.1
torque_nm = 0.1

[[design]]
name = "random"
making = "random"
criterion = "condition"
starts = 2
evaluations = 2
"#;

    pub(in crate::study) fn setup() -> StudySetup {
        let mut plan = StudyPlan::from_toml(PLAN).unwrap();
        plan.engines = vec!["analytic".to_owned(), "rapier".to_owned()];
        let loaded = robot::find(&plan.robot).unwrap();
        let (truth, nominal) = (loaded.truth().unwrap(), loaded.nominal.unwrap());
        StudySetup::new(plan, loaded.robot, nominal, &truth).unwrap()
    }

    /// An outcome whose numbers all differ; some runs fail.
    pub(in crate::study) fn outcome(setup: &StudySetup, position: usize) -> Outcome {
        let id = setup.run_order().id(position);
        let b = setup.base.rank();
        let value = |k: usize| 1.0 + ((position * 31 + k * 7) % 1009) as f64 / 1009.0;
        let failure = (position % 50 == 3)
            .then(|| RunError { kind: RunErrorKind::DivergedSpeed, reason: format!("run {position} was too fast") });
        let estimate = |(e, name): (usize, &String)| ScoredEstimate {
            estimator: name.clone(),
            failure: None,
            beta: (0..b).map(|i| value(i + e)).collect(),
            std: (0..b).map(|i| value(i + e + 100)).collect(),
            half_width: (0..b).map(|i| value(i + e + 200)).collect(),
            residual_rms: vec![value(e + 300); setup.robot.dof()],
            score: Some(Score {
                prediction_rmse_nm: value(e + 400),
                prediction_rmse_of_rating: value(e + 500),
                joint_rmse_nm: vec![value(e + 600); setup.robot.dof()],
                reference_rmse: value(e + 700),
                si_rmse: value(e + 800),
                measured_rmse_nm: None,
                slow_rmse_nm: value(e + 900),
                point_to_point_rmse_nm: value(e + 1000),
                static_rmse_nm: (e > 0).then(|| value(e + 1100)),
            }),
        };
        let estimators = &setup.plan.identification.estimators;
        let estimates =
            if failure.is_some() { Vec::new() } else { estimators.iter().enumerate().map(estimate).collect() };
        let truth = setup.plan.truth_of(id.run);
        Outcome { design: id.design, condition: id.condition, truth, run: id.run, failure, estimates }
    }

    #[test]
    fn identity_of_numbers_in_a_file_and_in_memory() {
        let setup = setup();
        let folder = tempfile::tempdir().unwrap();
        let outcomes: Vec<Outcome> = (0..setup.run_order().len()).map(|position| outcome(&setup, position)).collect();
        let mut writer = NumberWriter::create(folder.path(), &setup).unwrap();
        outcomes.iter().for_each(|outcome| writer.add(outcome).unwrap());
        let file = writer.finish();
        let memory = OutcomeTable { outcomes: &outcomes, truths: &setup.scorer.truths };
        assert_eq!(file.failed(), outcomes.iter().filter(|outcome| outcome.failure.is_some()).count());
        for design in 0..setup.designs().len() {
            for condition in 0..2 {
                assert_eq!(file.statuses(condition), memory.statuses(condition));
                let runs = file.runs(design, condition);
                assert_eq!(runs, memory.runs(design, condition));
                for range in [0..runs, 0..1, 1000..1100, 1024..runs, runs - 1..runs] {
                    for number in setup.run_numbers() {
                        let read = file.numbers(design, condition, range.clone(), number).unwrap();
                        assert_eq!(
                            read,
                            memory.numbers(design, condition, range.clone(), number).unwrap(),
                            "{number:?}"
                        );
                    }
                }
            }
        }
        let volume = RunNumber::Metric { estimator: 0, metric: Metric::LogVolume };
        assert!(file.numbers(0, 0, 0..1, volume).unwrap_err().to_string().contains("is not among them"));
    }
}
