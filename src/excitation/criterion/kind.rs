//! The list of criteria.

use super::{Condition, ConditionScaled, Criterion, DOptimal};

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
}

impl CriterionKind {
    /// Every criterion.
    pub const ALL: [Self; 3] = [Self::Condition, Self::ConditionScaled, Self::DOptimal];

    /// Its name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Condition => "condition",
            Self::ConditionScaled => "condition-scaled",
            Self::DOptimal => "d-optimal",
        }
    }

    /// The criterion with this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The criterion itself, exact.
    #[must_use]
    pub fn criterion(self) -> Box<dyn Criterion> {
        match self {
            Self::Condition => Box::new(Condition::exact()),
            Self::ConditionScaled => Box::new(ConditionScaled::exact()),
            Self::DOptimal => Box::new(DOptimal),
        }
    }

    /// A smooth stand-in for the optimiser, the closer the larger `sharpness`; the criterion itself where it is
    /// smooth already.
    #[must_use]
    pub fn smooth(self, sharpness: f64) -> Box<dyn Criterion> {
        match self {
            Self::Condition => Box::new(Condition::smooth(sharpness)),
            Self::ConditionScaled => Box::new(ConditionScaled::smooth(sharpness)),
            Self::DOptimal => Box::new(DOptimal),
        }
    }

    /// Whether it is smooth wherever M is positive definite.
    #[must_use]
    pub const fn is_smooth(self) -> bool {
        matches!(self, Self::DOptimal)
    }

    /// Whether the noise of the joints weights the rows: the condition numbers are the paper's, of W_b itself.
    #[must_use]
    pub const fn is_weighted(self) -> bool {
        matches!(self, Self::DOptimal)
    }

    /// The number that people read, from the value that is minimised: κ from ln κ, and ln det M from −ln det M.
    #[must_use]
    pub fn report(self, value: f64) -> f64 {
        match self {
            Self::Condition | Self::ConditionScaled => libm::exp(value),
            Self::DOptimal => -value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_names_parse_back() {
        for kind in CriterionKind::ALL {
            assert_eq!(CriterionKind::parse(kind.name()), Some(kind));
            assert_eq!(kind.criterion().kind(), kind);
            assert_eq!(serde_json::to_string(&kind).unwrap(), format!("\"{}\"", kind.name()));
        }
        assert_eq!(CriterionKind::parse("best"), None);
    }
}
