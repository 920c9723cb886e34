//! The list of estimators.

use std::fmt;

use super::{Estimate, EstimationError, EstimationProblem, LawException, OrdinaryLeastSquares, WeightedLeastSquares};

/// A rule that turns measurements into parameters.
///
/// It obeys every [`EstimatorLaw`](super::EstimatorLaw) but those that it names in [`Estimator::exceptions`];
/// [`crate::conformance::estimator_laws`] shows it.
pub trait Estimator: fmt::Debug + Send + Sync {
    /// Its name on the command line and in files.
    fn name(&self) -> &'static str;

    /// What it minimises or solves, in one line.
    fn summary(&self) -> &'static str;

    /// Estimates the base parameters.
    ///
    /// # Errors
    /// [`EstimationError`] where the equations have no answer or something that it needs is missing.
    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError>;

    /// The laws that it does not obey, each with the reason.
    fn exceptions(&self) -> &[LawException] {
        &[]
    }
}

/// Makes the enum, and everything that enumerates it, from one list.
macro_rules! estimators {
    ($($(#[$doc:meta])* $kind:ident => $estimator:expr,)*) => {
        /// Every estimator, listed once.
        ///
        /// ```
        /// use armid::estimation::EstimatorKind;
        /// assert_eq!(EstimatorKind::parse("wls"), Some(EstimatorKind::Wls));
        /// assert!(EstimatorKind::ALL.iter().all(|kind| EstimatorKind::parse(kind.name()) == Some(*kind)));
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum EstimatorKind {
            $($(#[$doc])* $kind,)*
        }

        impl EstimatorKind {
            /// Every estimator.
            pub const ALL: &'static [Self] = &[$(Self::$kind,)*];

            /// The estimator itself.
            #[must_use]
            pub fn estimator(self) -> &'static dyn Estimator {
                match self {
                    $(Self::$kind => &$estimator,)*
                }
            }
        }
    };
}

estimators! {
    /// Ordinary least squares.
    Ols => OrdinaryLeastSquares,
    /// Least squares weighted with the noise of each joint: `radkhah2007` eq. 6.
    Wls => WeightedLeastSquares,
}

impl EstimatorKind {
    /// Its name on the command line and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.estimator().name()
    }

    /// The estimator with this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }
}

/// A listed estimator is the one that it names.
impl Estimator for EstimatorKind {
    fn name(&self) -> &'static str {
        self.estimator().name()
    }

    fn summary(&self) -> &'static str {
        self.estimator().summary()
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        self.estimator().estimate(problem)
    }

    fn exceptions(&self) -> &[LawException] {
        self.estimator().exceptions()
    }
}
