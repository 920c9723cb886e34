//! Methods from outside, which a plan may name beside those of the lists.

use std::sync::Arc;

use super::plan_error::{StudyPlanError, name};
use crate::estimation::{Estimator, EstimatorKind};
use crate::excitation::{Criterion, CriterionKind};

/// Estimators and criteria from outside. Where one has the name of a listed one, the plan means it.
#[derive(Clone, Debug, Default)]
pub struct OwnMethods {
    /// Beside those of [`EstimatorKind`].
    pub estimators: Vec<Arc<dyn Estimator>>,
    /// Beside those of [`CriterionKind`].
    pub criteria: Vec<Arc<dyn Criterion>>,
}

impl OwnMethods {
    /// The estimator of this name.
    ///
    /// # Errors
    /// [`StudyPlanError::Name`] where there is none.
    pub(super) fn estimator(&self, found: &str) -> Result<Arc<dyn Estimator>, StudyPlanError> {
        let own = self.estimators.iter().find(|estimator| estimator.name() == found).cloned();
        own.or_else(|| Some(Arc::new(EstimatorKind::parse(found)?) as Arc<dyn Estimator>)).ok_or_else(|| {
            let own = self.estimators.iter().map(|estimator| estimator.name());
            let all: Vec<&str> = own.chain(EstimatorKind::ALL.iter().map(|listed| listed.name())).collect();
            name("identification.estimators", found, all)
        })
    }

    /// The criterion of this name.
    ///
    /// # Errors
    /// [`StudyPlanError::Name`] where there is none.
    pub(super) fn criterion(&self, found: &str) -> Result<Arc<dyn Criterion>, StudyPlanError> {
        let own = self.criteria.iter().find(|criterion| criterion.name() == found).cloned();
        own.or_else(|| Some(CriterionKind::parse(found)?.into())).ok_or_else(|| {
            let own = self.criteria.iter().map(|criterion| criterion.name());
            let all: Vec<&str> = own.chain(CriterionKind::ALL.iter().map(|listed| listed.name())).collect();
            name("design.criterion", found, all)
        })
    }
}
