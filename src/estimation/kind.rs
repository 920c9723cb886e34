//! The list of estimators.

use super::{
    Estimate, EstimationError, EstimationProblem, Estimator, LawException, OrdinaryLeastSquares, WeightedLeastSquares,
};

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
