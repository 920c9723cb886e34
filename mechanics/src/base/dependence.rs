//! Columns that differ from the others by less than any torque sensor resolves.
//!
//! A geometry that is nearly special, such as an arm with two axes that are parallel but for 1e-4 rad, has parameters whose
//! columns are nearly zero or nearly combinations of others. They are independent to the last bit, so they stand in the
//! base; an estimate of them is noise divided by that distance, and it spoils those of the others.
//!
//! ```text
//! zero:         ‖w_j‖ ≤ 1e-6 · max_k ‖w_k‖
//! independent:  distance of w_j from dependence > 1e-6 · ‖w_j‖          W on random states, in units of the robot's size
//! ```
//! With noise of 1 % of the torque and 10⁴ samples, a column at 1e-6 leaves its parameter a standard deviation of 100 times
//! its natural size. Which columns those are is decided here, once for all methods, on states that depend on nothing but
//! the robot: the methods say what the structure reveals, this says what of it can be seen.

use super::error::BaseError;
use super::geometry::Geometry;
use super::nearly_dependent::NearlyDependent;
use super::reduction::BaseReduction;
use super::scaled_stack::scaled_stack;
use crate::linalg::{LeftToRight, RankTolerance, RowFactor};
use crate::model::term::ROTOR;
use crate::model::{Columns, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;

/// A column at this fraction or less of the others', or of its own length from dependence, cannot be seen.
const NEARLY_DEPENDENT: f64 = 1e-6;

/// The reduction without nearly dependent columns of links and rotors; itself where there are none. Other torque terms are functions of
/// the speed that may be narrow: random states say nothing of how well a motion made for them shows them.
pub(super) fn leave_out(
    robot: &Robot,
    geometry: &Geometry,
    columns: Columns,
    structural: BaseReduction,
) -> Result<BaseReduction, BaseError> {
    let inertial = if columns.has(ROTOR) { Columns::RIGID_ROTOR } else { Columns::RIGID };
    let (all, parameters) = (columns.parameters(robot), inertial.parameters(robot));
    let places: Vec<usize> = parameters.iter().filter_map(|id| all.iter().position(|other| other == id)).collect();
    let mut rng = Seed::new(0).stream("nearly dependent columns", 0);
    let states = geometry.random_states(parameters.len(), &mut rng);
    let w = JointTorqueRegressor::new(robot, inertial)?.stack(&states);
    let w = scaled_stack(geometry, &parameters, w)?;
    // A triangular factor has the dependencies of its matrix, in a third of the rows.
    let mut factor = RowFactor::new(w.ncols());
    factor.add(w.nrows(), |row, column| w[(row, column)]);
    let seen =
        LeftToRight::new(&factor.finish(), RankTolerance { zero: NEARLY_DEPENDENT, independent: NEARLY_DEPENDENT });
    let visible: Vec<usize> = seen.kept.iter().map(|&column| places[column]).collect();
    let left_out = |column: &&usize| places.contains(*column) && !visible.contains(*column);
    if structural.kept.iter().filter(|column| places.contains(*column)).eq(&visible) {
        return Ok(structural);
    }
    let finding = NearlyDependent {
        parameters: structural.kept.iter().filter(left_out).map(|&column| all[column].to_string()).collect(),
        structural_rank: structural.rank(),
        tolerance: NEARLY_DEPENDENT,
    };
    // A coefficient below the tolerance is no more than what was left out.
    let k = seen.coefficients.map(|x| if x.abs() < NEARLY_DEPENDENT { 0.0 } else { x });
    let of_links = BaseReduction::from_echelon(&parameters, seen.kept, k, structural.method);
    let of_links = of_links.with_units(&geometry.units(&parameters));
    Ok(BaseReduction { nearly_dependent: Some(finding), ..structural.with_rows(&places, &of_links) })
}
