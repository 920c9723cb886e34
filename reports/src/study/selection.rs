//! What figures show where a study holds more than one figure can.

use armid::study::ReportInput;

/// Families of designs that a figure can distinguish by colour.
pub(super) const GROUPS: usize = 8;

/// The estimator that figures show: the last of the plan, which is the one with the most information.
pub(super) fn shown_estimator(input: &ReportInput) -> &str {
    input.result.plan.identification.estimators.last().map_or("", String::as_str)
}
