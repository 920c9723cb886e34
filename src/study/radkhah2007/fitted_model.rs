//! What is fitted to a run, and which of its values no arm can have.

use nalgebra::DVector;

use super::table_two_comparison::MAX_LINK_MASS;
use crate::base::{BaseError, BaseReduction, Method, reduce};
use crate::estimation::{EstimationProblem, EstimatorKind, Observation};
use crate::model::Columns;
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;
use crate::statistics::Interval;
use crate::study::error::StudyError;
use crate::study::setup::StudySetup;
use crate::study::validity::feasible_ranges;

/// Columns that are fitted, with the values that a real arm's parameters can have.
pub(super) struct FittedModel {
    regressor: JointTorqueRegressor,
    pub(super) base: BaseReduction,
    pub(super) feasible: Vec<Interval>,
}

impl FittedModel {
    pub(super) fn new(setup: &StudySetup, columns: Columns) -> Result<Self, StudyError> {
        let base = reduce(&setup.robot, columns, Method::Structural, setup.plan.seed)?;
        let feasible = feasible_ranges(&setup.robot, &base, MAX_LINK_MASS);
        Ok(Self {
            regressor: JointTorqueRegressor::new(&setup.robot, columns).map_err(BaseError::from)?,
            base,
            feasible,
        })
    }

    /// Weighted least squares.
    pub(super) fn fit(&self, setup: &StudySetup, samples: &Samples) -> Option<DVector<f64>> {
        let observation = Observation::new(&setup.robot, &self.regressor, &self.base, samples).ok()?;
        Some(EstimatorKind::Wls.estimator().estimate(&EstimationProblem::new(&observation)).ok()?.beta())
    }

    /// How many of the values no arm can have.
    pub(super) fn invalid(&self, beta: &DVector<f64>) -> usize {
        beta.iter().zip(&self.feasible).filter(|(value, range)| !range.contains(**value)).count()
    }
}

/// One run, identified by either model.
pub(super) struct Fits {
    pub(super) rigid: DVector<f64>,
    pub(super) whole: DVector<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::small_results::setup;

    #[test]
    fn analytic_values_outside_of_their_range_are_counted() {
        let model = FittedModel::new(&setup(), Columns::RIGID).unwrap();
        let mut beta = DVector::zeros(model.base.rank());
        assert_eq!(model.invalid(&beta), 0);
        for row in 0..3 {
            beta[row] = 1.001 * model.feasible[row].high + 1e-9;
        }
        beta[3] = 1.001 * model.feasible[3].low - 1e-9;
        assert_eq!(model.invalid(&beta), 4);
    }
}
