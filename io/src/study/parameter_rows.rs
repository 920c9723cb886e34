//! One row per run, design, estimator and parameter.

use armid::study::{Outcome, StudyResult};

use super::run_rows::truth_name;
use crate::table::{Column, ParquetTable};

/// One row per run, design, estimator and parameter.
pub(super) fn parameter_rows(result: &StudyResult, outcomes: &[Outcome]) -> ParquetTable {
    let (mut run, mut design, mut estimator, mut parameter) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut condition, mut made_of) = (Vec::new(), Vec::new());
    let (mut truth, mut estimate, mut std, mut half_width) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for outcome in outcomes {
        for scored in outcome.estimates.iter().filter(|scored| scored.score.is_some()) {
            for (i, line) in result.parameters.iter().enumerate() {
                run.push(outcome.run.cast_signed());
                design.push(i64::try_from(outcome.design).unwrap_or(i64::MAX));
                condition.push(result.conditions[outcome.condition].condition.name.clone());
                estimator.push(scored.estimator.clone());
                parameter.push(line.name.clone());
                made_of.push(truth_name(outcome));
                truth.push(Some(result.truth(outcome.truth, i)));
                estimate.push(Some(scored.beta[i]));
                std.push(Some(scored.std[i]));
                half_width.push(Some(scored.half_width[i]));
            }
        }
    }
    let rows = run.len();
    ParquetTable::default()
        .with("run", Column::Integer(run))
        .with("design", Column::Integer(design))
        .with("condition", Column::Text(condition))
        .with("estimator", Column::Text(estimator))
        .with("noise", Column::Text(vec!["robot".to_owned(); rows]))
        .with("truth", Column::Text(made_of))
        .with("parameter", Column::Text(parameter))
        .with("true", Column::Number(truth))
        .with("estimate", Column::Number(estimate))
        .with("std", Column::Number(std))
        .with("half_width", Column::Number(half_width))
}
