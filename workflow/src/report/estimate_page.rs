//! The page of an estimate: torque measured and predicted, residuals, parameters, and a verdict with its reason.

use std::path::{Path, PathBuf};

use armid::estimation::{Estimate, TorqueResidual};
use armid::observer::{Observer, Work};
use armid_io::log::LogResidual;
use armid_io::{Error, Inputs, ProcessedLog, Text};
use armid_reports::{EstimateInput, ParameterRow, Sheet, estimate_document};
use serde::Deserialize;
use serde_json::Value;

use super::log_figures::LogFigures;
use super::page::write_document;
use super::torque_comparison::{rows, shares};
use crate::counter::Counter;
use crate::identification::grouped;
use crate::numbers::percent;

/// Share of the torque that a model may leave unexplained to be called good on rows that it has not seen.
const GOOD: f64 = 0.1;

/// What the page of an estimate shows beside the estimate. The estimate's file holds all of it.
#[derive(Clone, Debug, Deserialize)]
pub struct EstimatePage {
    joints: Vec<String>,
    base: Vec<Expressed>,
    residual: TorqueResidual,
    held_out: Option<TorqueResidual>,
    inputs: Inputs,
    figures: LogFigures,
}

/// A base parameter, by what it stands for.
#[derive(Clone, Debug, Deserialize)]
struct Expressed {
    expression: String,
}

impl EstimatePage {
    /// The page that the file of an estimate holds; `None` where it holds no figures of its logs.
    ///
    /// # Errors
    /// [`Error`] where a part of it is missing or is something else.
    pub fn of_file(text: &Text) -> Result<Option<Self>, Error> {
        let value: Value = serde_json::from_str(&text.content).map_err(|error| Error::of_json(text, &error))?;
        if value.get("figures").is_none_or(Value::is_null) {
            return Ok(None);
        }
        serde_json::from_str(&text.content).map(Some).map_err(|error| Error::of_json(text, &error))
    }

    /// The page of an estimate, which errors call `name`, from the logs that it was made from.
    ///
    /// # Errors
    /// [`Error`] where the estimate is of another robot or of other parameters; of [`armid_io::ErrorKind::Interrupted`] where the observer
    /// ended the work.
    pub fn of_log(
        estimate: &Estimate,
        name: &str,
        log: &ProcessedLog,
        inputs: Inputs,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        let steps = Counter::new(observer, Work::Steps, 3);
        steps.begin(name)?;
        let residual = log.residual(estimate, name)?;
        steps.begin(name)?;
        let expressions = log.expressions(estimate, name)?;
        steps.begin(name)?;
        let trends = log.residual_trends(std::slice::from_ref(estimate), name)?.swap_remove(0);
        let figures = LogFigures::new(estimate, name, log, &residual, &trends)?;
        let LogResidual { used: residual, held_out } = residual;
        let base = expressions.into_iter().map(|expression| Expressed { expression }).collect();
        Ok(Self { joints: log.joint_names(), base, residual, held_out, inputs, figures })
    }

    /// Writes the page of the estimate into a folder; returns the page.
    ///
    /// # Errors
    /// [`Error`] where it cannot be drawn or written.
    pub fn write(self, folder: &Path, estimate: &Estimate, sheet: Sheet) -> Result<PathBuf, Error> {
        write_document(folder, estimate_document(&self.input(estimate)), sheet)
    }

    fn input(self, estimate: &Estimate) -> EstimateInput {
        let parameters =
            estimate.base.iter().zip(&self.base).map(|(parameter, Expressed { expression })| ParameterRow {
                name: parameter.name.clone(),
                expression: expression.clone(),
                value: parameter.value,
                std: parameter.std,
                interval: parameter.ci95,
                unit: parameter.unit.clone(),
            });
        let mut provenance = vec![("robot file, SHA-256".to_owned(), self.inputs.robot.sha256.clone())];
        provenance.extend(self.inputs.files.iter().map(|file| (file.path.clone(), file.sha256.clone())));
        provenance.extend(self.inputs.mapping.clone().map(|mapping| ("mapping".to_owned(), mapping)));
        EstimateInput {
            robot: estimate.robot.clone(),
            subtitle: format!(
                "{} base parameters ({}) by {} from {}",
                estimate.base.len(),
                estimate.columns,
                estimate.estimator,
                self.figures.log
            ),
            verdict: self.verdict(estimate),
            unit: estimate.units.first().cloned().unwrap_or_default(),
            bandwidth_hz: self.residual.bandwidth_hz,
            shares: shares(&self.residual, self.held_out.as_ref()),
            traces_of: rows(self.figures.is_held_out).to_owned(),
            parameters: parameters.collect(),
            findings: grouped(&estimate.findings)
                .into_iter()
                .flat_map(|(sentences, advice)| {
                    sentences.into_iter().map(move |sentence| format!("{sentence} → {advice}"))
                })
                .collect(),
            provenance,
            joints: self.joints,
            traces: self.figures.torque,
            diagnostics: self.figures.residual,
            left_out: self.figures.left_out,
        }
    }

    /// The verdict with its reason.
    fn verdict(&self, estimate: &Estimate) -> Vec<String> {
        let used = &self.residual;
        let bandwidth = used.bandwidth_hz;
        let poor = estimate.base.iter().filter(|p| 3.0 * p.std > p.value.abs()).count();
        let first = match self.held_out.as_ref().and_then(|residual| residual.all.total) {
            Some(total) if total <= GOOD => format!(
                "The model **predicts** held-out torque: {} of it is left unexplained below {bandwidth} Hz, {} on \
                 the rows of the fit.",
                percent(Some(total)),
                percent(used.all.total)
            ),
            Some(total) => format!(
                "The model does **not predict** held-out torque well: {} of it is left unexplained below \
                 {bandwidth} Hz, more than {:.0} %; {} on the rows of the fit.",
                percent(Some(total)),
                100.0 * GOOD,
                percent(used.all.total)
            ),
            None => format!(
                "Nothing was held out, so **its prediction is not validated**; {} of the torque of the fit is left \
                 unexplained below {bandwidth} Hz.",
                percent(used.all.total)
            ),
        };
        let second = format!(
            "{poor} of {} parameters have a standard deviation of more than a third of their value; the condition number with \
             columns of unit length is {:.0}.",
            estimate.base.len(),
            estimate.condition_scaled
        );
        vec![first, second]
    }
}
