//! The list of estimators.

use super::closed_loop::{
    ClosedLoopInputError, ClosedLoopOutputError, DirectInverseIdentification, InstrumentalVariables,
};
use super::error::EstimationError;
use super::essential::EssentialParameters;
use super::estimate::Estimate;
use super::estimator::Estimator;
use super::law::LawException;
use super::motion::{MaximumLikelihood, TotalLeastSquares};
use super::ordinary::OrdinaryLeastSquares;
use super::physical::{
    ConsistentDirectInverse, ConsistentInstrumental, ConsistentOrdinary, ConsistentReweighted, ConsistentWeighted,
};
use super::problem::EstimationProblem;
use super::recursive::{ExtendedKalmanFilter, ParticleFilter};
use super::ridge::RidgeRegression;
use super::robust::{MmEstimator, Reweighted};
use super::weighted::WeightedLeastSquares;

/// Makes the enum, and everything that enumerates it, from one list.
macro_rules! estimators {
    ($($(#[$doc:meta])* $kind:ident => $estimator:expr,)*) => {
        /// Every estimator, listed once.
        ///
        /// ```
        /// # use armid_estimation as armid;
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
    /// Huber's M-estimate.
    IrlsHuber => Reweighted::HUBER,
    /// Tukey's biweight M-estimate.
    IrlsTukey => Reweighted::TUKEY,
    /// The M-estimate of Cauchy's distribution.
    IrlsCauchy => Reweighted::CAUCHY,
    /// The MM-estimate.
    Mm => MmEstimator,
    /// Generalised total least squares.
    Tls => TotalLeastSquares,
    /// Ridge regression.
    Ridge => RidgeRegression,
    /// Weighted least squares of the essential parameters.
    Essential => EssentialParameters,
    /// Maximum likelihood of parameters and motion.
    Ml => MaximumLikelihood,
    /// Instrumental variables from a simulated motion.
    Iv => InstrumentalVariables,
    /// Direct and inverse dynamic identification.
    Didim => DirectInverseIdentification,
    /// The closed-loop input error.
    Clie => ClosedLoopInputError,
    /// The closed-loop output error.
    Cloe => ClosedLoopOutputError,
    /// The Kalman filter of the parameters.
    Ekf => ExtendedKalmanFilter,
    /// The Gaussian particle filter.
    Pf => ParticleFilter,
    /// Ordinary least squares over physically consistent sets.
    PcOls => ConsistentOrdinary::ALONE,
    /// Weighted least squares over physically consistent sets.
    PcWls => ConsistentWeighted,
    /// Huber's M-estimate over physically consistent sets.
    PcIrls => ConsistentReweighted,
    /// Instrumental variables over physically consistent sets.
    PcIv => ConsistentInstrumental,
    /// Direct and inverse dynamic identification over physically consistent sets.
    PcDidim => ConsistentDirectInverse,
    /// Least squares over physically consistent sets near a prior, by the Euclidean distance.
    PcOlsEuclidean => ConsistentOrdinary::EUCLIDEAN,
    /// The same by the entropic distance.
    PcOlsEntropic => ConsistentOrdinary::ENTROPIC,
    /// The same by the entropic distance's curvature at the prior.
    PcOlsPullback => ConsistentOrdinary::PULLBACK,
}

impl EstimatorKind {
    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        self.estimator().name()
    }

    /// Other names that it is asked for by: algorithms of the literature that give its estimate. The equations are linear in the
    /// parameters, so that every Kalman filter has the posterior of `ekf`, and both networks come to rest at `wls`.
    pub const fn aliases(self) -> &'static [&'static str] {
        match self {
            Self::Wls => &["adaline", "hopfield-tank"],
            Self::Ekf => &["srekf", "ukf", "srukf", "cdkf", "srcdkf"],
            _ => &[],
        }
    }

    /// The estimator with this name, or with this among its [`aliases`](Self::aliases).
    ///
    /// ```
    /// # use armid_estimation as armid;
    /// use armid::estimation::EstimatorKind;
    /// assert_eq!(EstimatorKind::parse("ukf"), Some(EstimatorKind::Ekf));
    /// ```
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name || kind.aliases().contains(&name))
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
