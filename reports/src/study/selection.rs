//! What figures show where a study holds more than one figure can.

use armid::study::ReportInput;

/// Families of designs that a figure can distinguish by colour.
pub(super) const GROUPS: usize = 8;

/// The estimator that figures show: the last of the plan that gave an estimate under the first condition.
pub(super) fn shown_estimator(input: &ReportInput) -> &str {
    let estimators = &input.result.plan.identification.estimators;
    let families = &input.result.findings().families;
    let gave = |name: &&String| families.iter().any(|score| score.estimator == **name && score.runs > 0);
    estimators.iter().rev().find(gave).or(estimators.last()).map_or("", String::as_str)
}
