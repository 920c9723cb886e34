//! The rows of a study, one run after the other: `runs.parquet`, `parameters.parquet` and `timing.parquet`, and the numbers
//! that its statistics are made of.

use std::path::Path;

use armid::study::{Outcome, StudySetup};
use parquet::data_type::ByteArray;

use super::number_file::{NumberFile, NumberWriter};
use crate::error::Error;
use crate::table::{Cell, Kind, ParquetFile};

/// The files of the rows while they are written: runs in their order, each once.
pub struct RowFiles {
    runs: ParquetFile,
    parameters: ParquetFile,
    timing: ParquetFile,
    numbers: NumberWriter,
    texts: Texts,
    joints: usize,
    /// True base parameters by the index of a truth.
    truths: Vec<Vec<f64>>,
}

/// Texts that stand in many rows.
struct Texts {
    /// Name of the family of each design.
    families: Vec<ByteArray>,
    conditions: Vec<ByteArray>,
    truths: Vec<ByteArray>,
    estimators: Vec<ByteArray>,
    parameters: Vec<ByteArray>,
    ok: ByteArray,
    none: ByteArray,
    robot: ByteArray,
    run: ByteArray,
}

impl RowFiles {
    /// Begins the files in a folder; the rows of `timing.parquet` begin with the designs, which took so many seconds.
    ///
    /// # Errors
    /// [`Error`] where they cannot be made.
    pub fn create(folder: &Path, setup: &StudySetup, design_seconds: &[f64]) -> Result<Self, Error> {
        let joints = setup.robot.dof();
        let residuals: Vec<String> = (1..=joints).map(|joint| format!("residual_rms_{joint}")).collect();
        let mut columns = RUN_COLUMNS.to_vec();
        columns.extend(residuals.iter().map(|name| (name.as_str(), Kind::Number)));
        let mut timing = ParquetFile::create(&folder.join("timing.parquet"), &TIMING_COLUMNS)?;
        let design = ByteArray::from("design");
        for (index, &seconds) in design_seconds.iter().enumerate() {
            timing.add([
                Cell::Text(design.clone()),
                integer(index),
                Cell::Integer(-1),
                Cell::Integer(-1),
                Cell::Number(Some(seconds)),
            ])?;
        }
        Ok(Self {
            runs: ParquetFile::create(&folder.join("runs.parquet"), &columns)?,
            parameters: ParquetFile::create(&folder.join("parameters.parquet"), &PARAMETER_COLUMNS)?,
            timing,
            numbers: NumberWriter::create(folder, setup)?,
            texts: Texts::of(setup),
            joints,
            truths: setup.scorer.truths.iter().map(|beta| beta.as_slice().to_vec()).collect(),
        })
    }

    /// Adds the next run in the order of the study, which took so many seconds.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub fn add(&mut self, outcome: &Outcome, seconds: f64) -> Result<(), Error> {
        self.add_run(outcome)?;
        self.add_parameters(outcome)?;
        self.timing.add([
            Cell::Text(self.texts.run.clone()),
            integer(outcome.design),
            integer(outcome.condition),
            Cell::Integer(outcome.run.cast_signed()),
            Cell::Number(Some(seconds)),
        ])?;
        self.numbers.add(outcome).map_err(|error| Error::new(format!("the numbers of a run cannot be kept: {error}")))
    }

    /// Ends the files and gives them their names; the numbers of all runs.
    ///
    /// # Errors
    /// [`Error`] where they cannot be written.
    pub fn finish(self) -> Result<NumberFile, Error> {
        self.runs.finish()?;
        self.parameters.finish()?;
        self.timing.finish()?;
        Ok(self.numbers.finish())
    }

    fn add_run(&mut self, outcome: &Outcome) -> Result<(), Error> {
        let texts = &self.texts;
        for (e, name) in texts.estimators.iter().enumerate() {
            let estimate = outcome.estimates.get(e);
            let score = estimate.and_then(|estimate| estimate.score.as_ref());
            let failure = outcome.failure.as_ref().or_else(|| estimate.and_then(|estimate| estimate.failure.as_ref()));
            let status = failure.map_or_else(|| texts.ok.clone(), |failure| ByteArray::from(failure.kind.name()));
            let reason = failure.map_or_else(|| texts.none.clone(), |failure| failure.reason.as_str().into());
            let cells = [
                Cell::Text(texts.families[outcome.design].clone()),
                integer(outcome.design),
                Cell::Integer(outcome.run.cast_signed()),
                Cell::Text(texts.conditions[outcome.condition].clone()),
                Cell::Text(texts.truths[outcome.truth].clone()),
                Cell::Text(name.clone()),
                Cell::Text(status),
                Cell::Text(reason),
                Cell::Number(score.map(|s| s.prediction_rmse_nm)),
                Cell::Number(score.map(|s| s.prediction_rmse_of_rating)),
                Cell::Number(score.map(|s| s.reference_rmse)),
                Cell::Number(score.map(|s| s.si_rmse)),
                Cell::Number(score.and_then(|s| s.measured_rmse_nm)),
                Cell::Number(score.map(|s| s.slow_rmse_nm)),
                Cell::Number(score.map(|s| s.point_to_point_rmse_nm)),
                Cell::Number(score.and_then(|s| s.static_rmse_nm)),
            ];
            let residual =
                |joint| Cell::Number(estimate.and_then(|estimate| estimate.residual_rms.get(joint).copied()));
            self.runs.add(cells.into_iter().chain((0..self.joints).map(residual)))?;
        }
        Ok(())
    }

    fn add_parameters(&mut self, outcome: &Outcome) -> Result<(), Error> {
        let texts = &self.texts;
        let truth = &self.truths[outcome.truth];
        for (estimate, estimator) in outcome.estimates.iter().zip(&texts.estimators) {
            if estimate.score.is_none() {
                continue;
            }
            for (i, parameter) in texts.parameters.iter().enumerate() {
                self.parameters.add([
                    Cell::Integer(outcome.run.cast_signed()),
                    integer(outcome.design),
                    Cell::Text(texts.conditions[outcome.condition].clone()),
                    Cell::Text(estimator.clone()),
                    Cell::Text(texts.robot.clone()),
                    Cell::Text(texts.truths[outcome.truth].clone()),
                    Cell::Text(parameter.clone()),
                    Cell::Number(Some(truth[i])),
                    Cell::Number(Some(estimate.beta[i])),
                    Cell::Number(Some(estimate.std[i])),
                    Cell::Number(Some(estimate.half_width[i])),
                ])?;
            }
        }
        Ok(())
    }
}

impl Texts {
    fn of(setup: &StudySetup) -> Self {
        let plan = &setup.plan;
        let text = |name: &str| ByteArray::from(name);
        let truth = |index: usize| match index {
            0 => text("robot"),
            drawn => ByteArray::from(format!("draw {drawn}").as_str()),
        };
        Self {
            families: setup.designs().iter().map(|design| text(&plan.designs[design.family].name)).collect(),
            conditions: plan.conditions().iter().map(|condition| text(&condition.name)).collect(),
            truths: (0..setup.scorer.truths.len()).map(truth).collect(),
            estimators: plan.identification.estimators.iter().map(|name| text(name)).collect(),
            parameters: setup.base.names().iter().map(|name| text(name)).collect(),
            ok: text("ok"),
            none: text(""),
            robot: text("robot"),
            run: text("run"),
        }
    }
}

/// One row per run, design and estimator; residuals of the joints follow.
const RUN_COLUMNS: [(&str, Kind); 16] = [
    ("family", Kind::Text),
    ("design", Kind::Integer),
    ("run", Kind::Integer),
    ("condition", Kind::Text),
    ("truth", Kind::Text),
    ("estimator", Kind::Text),
    ("status", Kind::Text),
    ("reason", Kind::Text),
    ("prediction_rmse_nm", Kind::Number),
    ("prediction_rmse_of_rating", Kind::Number),
    ("reference_rmse", Kind::Number),
    ("si_rmse", Kind::Number),
    ("measured_rmse_nm", Kind::Number),
    ("slow_rmse_nm", Kind::Number),
    ("point_to_point_rmse_nm", Kind::Number),
    ("static_rmse_nm", Kind::Number),
];

/// One row per run, design, estimator and parameter.
const PARAMETER_COLUMNS: [(&str, Kind); 11] = [
    ("run", Kind::Integer),
    ("design", Kind::Integer),
    ("condition", Kind::Text),
    ("estimator", Kind::Text),
    ("noise", Kind::Text),
    ("truth", Kind::Text),
    ("parameter", Kind::Text),
    ("true", Kind::Number),
    ("estimate", Kind::Number),
    ("std", Kind::Number),
    ("half_width", Kind::Number),
];

/// One row per design and run.
const TIMING_COLUMNS: [(&str, Kind); 5] = [
    ("kind", Kind::Text),
    ("design", Kind::Integer),
    ("condition", Kind::Integer),
    ("run", Kind::Integer),
    ("seconds", Kind::Number),
];

fn integer(value: usize) -> Cell {
    Cell::Integer(i64::try_from(value).unwrap_or(i64::MAX))
}
