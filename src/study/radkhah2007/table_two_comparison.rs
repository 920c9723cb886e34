//! Table II of `radkhah2007` beside the truth of the simulation and what armid estimates.

use super::table_two::table_two;
use crate::base::BaseReduction;
use crate::model::JointKind;
use crate::statistics::Interval;
use nalgebra::DVector;

/// One of the 36 base parameters of the rigid arm.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TableLine {
    /// Name of the parameter that stands for the combination.
    pub name: String,
    /// The combination.
    pub expression: String,
    /// Its unit.
    pub unit: String,
    /// What `radkhah2007` printed; `None` for the four that it leaves out.
    pub printed: Option<f64>,
    /// Whether any arm of this shape can have the printed value.
    pub printed_valid: Option<bool>,
    /// The truth of the simulation.
    pub truth: f64,
    /// Mean of the estimates of the rigid columns alone, as in `radkhah2007`.
    pub rigid: f64,
    /// In how many of the runs no arm of this shape can have the estimate.
    pub rigid_invalid: usize,
    /// Runs behind it.
    pub runs: usize,
    /// The values that links of at most 10 kg inside their shapes can have.
    pub feasible: Interval,
}

/// Largest mass of a link in the test of validity, kg: the arm weighs less than 31 kg in all.
pub(super) const MAX_LINK_MASS: f64 = 10.0;

/// Puts estimates of the rigid base parameters beside Table II. `estimates` holds one β̂ per run.
pub fn compare_with_table_two(
    base: &BaseReduction,
    expressions: &[String],
    truth: &DVector<f64>,
    estimates: &[DVector<f64>],
    feasible: &[Interval],
) -> Vec<TableLine> {
    let printed = table_two();
    let line = |(i, &column): (usize, &usize)| {
        let id = base.parameters[column];
        let row = printed.iter().find(|row| row.parameter == id);
        TableLine {
            name: id.to_string(),
            expression: expressions[i].clone(),
            unit: id.kind.unit(JointKind::Revolute).to_owned(),
            printed: row.map(|row| row.value),
            printed_valid: row.map(|row| feasible[i].contains(row.value)),
            truth: truth[i],
            rigid: estimates.iter().map(|beta| beta[i]).sum::<f64>() / estimates.len().max(1) as f64,
            rigid_invalid: estimates.iter().filter(|beta| !feasible[i].contains(beta[i])).count(),
            runs: estimates.len(),
            feasible: feasible[i],
        }
    };
    base.kept.iter().enumerate().map(line).collect()
}
