//! The list of criteria.

use std::sync::Arc;

use super::a_optimal::AOptimal;
use super::condition::Condition;
use super::condition_in_units::ConditionInUnits;
use super::condition_plus_d::ConditionPlusD;
use super::condition_plus_sigma::ConditionPlusSigma;
use super::condition_scaled::ConditionScaled;
use super::d_optimal::DOptimal;
use super::definition::Criterion;
use super::e_optimal::EOptimal;
use super::i_optimal::IOptimal;
use super::model_error::ModelError;

/// Every criterion that a design can minimise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CriterionKind {
    /// Condition number of W_b.
    Condition,
    /// Condition number of W_b with each column scaled to unit length.
    ConditionScaled,
    /// −ln det of the information, weighted by the noise.
    DOptimal,
    /// Trace of the inverse of the information, weighted by the noise.
    AOptimal,
    /// Smallest eigenvalue of the information, weighted by the noise.
    EOptimal,
    /// Condition number plus the inverse of the smallest singular value of W_b per row.
    ConditionPlusSigma,
    /// Condition number minus ln det of the information of W_b per row.
    ConditionPlusD,
    /// Variance of torque predicted on evaluation motions.
    IOptimal,
    /// Variance and bias of torque predicted on evaluation motions, where effects are expected that the model lacks.
    ModelError,
    /// Condition number of Σ^−½ W_b with parameters in declared units.
    ConditionInUnits,
    /// Variance and bias of measured torque predicted on evaluation motions, over several sizes of each expected effect.
    MeasuredTorque,
}

// A new one is added at the end.
crate::input::named! { CriterionKind {
    Condition: "condition", ConditionScaled: "condition-scaled", DOptimal: "d-optimal", AOptimal: "a-optimal",
    EOptimal: "e-optimal", ConditionPlusSigma: "condition-plus-sigma", ConditionPlusD: "condition-plus-d",
    IOptimal: "i-optimal", ModelError: "model-error",
    ConditionInUnits: "condition-in-units", MeasuredTorque: "measured-torque"
} }

impl CriterionKind {
    /// The criterion itself, exact.
    pub fn criterion(self) -> Box<dyn Criterion> {
        match self {
            Self::Condition => Box::new(Condition::default()),
            Self::ConditionScaled => Box::new(ConditionScaled::default()),
            Self::DOptimal => Box::new(DOptimal),
            Self::AOptimal => Box::new(AOptimal),
            Self::EOptimal => Box::new(EOptimal::default()),
            Self::ConditionPlusSigma => Box::new(ConditionPlusSigma::default()),
            Self::ConditionPlusD => Box::new(ConditionPlusD::default()),
            Self::IOptimal => Box::new(IOptimal::default()),
            Self::ModelError => Box::new(ModelError::default()),
            Self::ConditionInUnits => Box::new(ConditionInUnits::default()),
            Self::MeasuredTorque => Box::new(ModelError::of_measured_torque()),
        }
    }
}

impl From<CriterionKind> for Arc<dyn Criterion> {
    fn from(kind: CriterionKind) -> Self {
        kind.criterion().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_names_parse_back() {
        for kind in CriterionKind::ALL {
            assert_eq!(CriterionKind::parse(kind.name()), Some(kind));
            assert!(kind.criterion().smoothed(8.0).is_none_or(|smooth| smooth.name() == kind.name()));
            assert_eq!(serde_json::to_string(&kind).unwrap(), format!("\"{}\"", kind.name()));
            let criterion = kind.criterion();
            assert_eq!(criterion.is_larger_better(), criterion.report(1.0) > criterion.report(2.0));
        }
        assert_eq!(CriterionKind::parse("best"), None);
    }
}
