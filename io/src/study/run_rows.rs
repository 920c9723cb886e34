//! One row per run, design and estimator.

use armid::study::{Outcome, StudyResult};

use crate::table::{Column, ParquetTable};

/// One row per run, design and estimator.
pub(super) fn run_rows(result: &StudyResult, outcomes: &[Outcome]) -> ParquetTable {
    let (mut family, mut design, mut run, mut estimator) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut condition, mut made_of) = (Vec::new(), Vec::new());
    let (mut status, mut reason) = (Vec::new(), Vec::new());
    let (mut prediction, mut of_rating, mut reference) = (Vec::new(), Vec::new(), Vec::new());
    let (mut si, mut measured) = (Vec::new(), Vec::new());
    let mut residual: Vec<Vec<Option<f64>>> = vec![Vec::new(); result.joints.len()];
    for outcome in outcomes {
        for (e, name) in result.plan.identification.estimators.iter().enumerate() {
            let estimate = outcome.estimates.get(e);
            let score = estimate.and_then(|estimate| estimate.score.as_ref());
            let failure = outcome.failure.as_ref().or_else(|| estimate.and_then(|estimate| estimate.failure.as_ref()));
            family.push(result.plan.designs[result.designs[outcome.design].family].name.clone());
            design.push(i64::try_from(outcome.design).unwrap_or(i64::MAX));
            run.push(outcome.run.cast_signed());
            estimator.push(name.clone());
            condition.push(result.conditions[outcome.condition].condition.name.clone());
            made_of.push(truth_name(outcome));
            status.push(failure.map_or("ok", |failure| failure.kind.name()).to_owned());
            reason.push(failure.map_or_else(String::new, |failure| failure.reason.clone()));
            prediction.push(score.map(|s| s.prediction_rmse_nm));
            of_rating.push(score.map(|s| s.prediction_rmse_of_rating));
            reference.push(score.map(|s| s.reference_rmse));
            si.push(score.map(|s| s.si_rmse));
            measured.push(score.and_then(|s| s.measured_rmse_nm));
            for (j, column) in residual.iter_mut().enumerate() {
                column.push(estimate.and_then(|estimate| estimate.residual_rms.get(j).copied()));
            }
        }
    }
    let table = ParquetTable::default()
        .with("family", Column::Text(family))
        .with("design", Column::Integer(design))
        .with("run", Column::Integer(run))
        .with("condition", Column::Text(condition))
        .with("truth", Column::Text(made_of))
        .with("estimator", Column::Text(estimator))
        .with("status", Column::Text(status))
        .with("reason", Column::Text(reason))
        .with("prediction_rmse_nm", Column::Number(prediction))
        .with("prediction_rmse_of_rating", Column::Number(of_rating))
        .with("reference_rmse", Column::Number(reference))
        .with("si_rmse", Column::Number(si))
        .with("measured_rmse_nm", Column::Number(measured));
    residual
        .into_iter()
        .enumerate()
        .fold(table, |table, (joint, column)| table.with(format!("residual_rms_{}", joint + 1), Column::Number(column)))
}

/// What the arm of a run was made of.
pub(super) fn truth_name(outcome: &Outcome) -> String {
    if outcome.truth == 0 { "robot".to_owned() } else { format!("draw {}", outcome.truth) }
}
