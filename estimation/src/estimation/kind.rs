//! The list of estimators.

use super::consistent_set::Prior;
use super::error::EstimationError;
use super::estimate::Estimate;
use super::estimator::Estimator;
use super::law::LawException;
use super::physical::{PRIOR_IN_SI, STATED_IN_SI};
use super::problem::EstimationProblem;
use super::robust::Loss;
use super::{closed_loop, essential, motion, ordinary, physical, recursive, ridge, robust, weighted};

/// What belongs to one estimator.
struct Entry {
    name: &'static str,
    /// By its name, from a problem that holds the factorisation of its equations.
    estimate: fn(&str, &EstimationProblem<'_>) -> Result<Estimate, EstimationError>,
    exceptions: &'static [LawException],
    summary: &'static str,
}

/// Makes the enum, and everything that enumerates it, from one list.
macro_rules! estimators {
    ($($(#[$doc:meta])* $kind:ident: $name:literal, $estimate:expr, $exceptions:expr, $summary:literal;)*) => {
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
                    $(Self::$kind => &Self::$kind,)*
                }
            }

            fn entry(self) -> Entry {
                match self {
                    $(Self::$kind => {
                        Entry { name: $name, estimate: $estimate, exceptions: $exceptions, summary: $summary }
                    })*
                }
            }
        }
    };
}

estimators! {
    /// Ordinary least squares.
    Ols: "ols", ordinary::estimate, &[],
        "ordinary least squares: every joint's residual counts the same";
    /// Least squares weighted with the noise of each joint: `radkhah2007` eq. 6.
    Wls: "wls", weighted::estimate, &[],
        "least squares weighted with the measured noise of each joint";
    /// Huber's M-estimate.
    IrlsHuber: "irls-huber", |name, problem| robust::reweighted::estimate(name, problem, Loss::Huber), &[],
        "residuals beyond 1.345 robust standard deviations count linearly (Huber)";
    /// Tukey's biweight M-estimate.
    IrlsTukey: "irls-tukey", |name, problem| robust::reweighted::estimate(name, problem, Loss::Tukey), &[],
        "residuals beyond 4.685 robust standard deviations do not count (Tukey)";
    /// The M-estimate of Cauchy's distribution.
    IrlsCauchy: "irls-cauchy", |name, problem| robust::reweighted::estimate(name, problem, Loss::Cauchy), &[],
        "maximum likelihood for noise with the tails of a Cauchy distribution";
    /// The MM-estimate.
    Mm: "mm", robust::mm::estimate, &[],
        "a fit of the better half of the equations, then Tukey's weights: withstands wrong states too";
    /// Generalised total least squares.
    Tls: "tls", motion::total::estimate, &[],
        "generalised total least squares: the noise of torque and of motion";
    /// Ridge regression.
    Ridge: "ridge", ridge::estimate, &[],
        "weighted least squares that draws what the motion hardly shows towards zero";
    /// Weighted least squares of the essential parameters.
    Essential: "essential", essential::estimate, essential::EXCEPTIONS,
        "weighted least squares without the parameters that the data do not tell from zero";
    /// Maximum likelihood of parameters and motion.
    Ml: "ml", motion::maximum_likelihood::estimate, &[],
        "maximum likelihood of parameters and motion, with the noise of both";
    /// Instrumental variables from a simulated motion.
    Iv: "iv", closed_loop::iv::estimate, LawException::OF_SIMULATION,
        "instrumental variables: the regressor along the simulated motion as instruments";
    /// Direct and inverse dynamic identification.
    Didim: "didim", closed_loop::didim::estimate, LawException::OF_SIMULATION,
        "measured against simulated torque of the closed loop, by the regressor along the simulated motion";
    /// The closed-loop input error.
    Clie: "clie", closed_loop::clie::estimate, LawException::OF_SIMULATION,
        "measured against simulated torque of the closed loop, by the simulation's exact slope";
    /// The closed-loop output error.
    Cloe: "cloe", closed_loop::cloe::estimate, LawException::OF_POSITIONS,
        "measured against simulated positions of the closed loop, by the simulation's exact slope";
    /// The Kalman filter of the parameters.
    Ekf: "ekf", recursive::ekf::estimate, &[],
        "Kalman filter of parameters that walk at random";
    /// The Gaussian particle filter.
    Pf: "pf", recursive::pf::estimate, &[],
        "Gaussian particle filter of parameters that walk at random";
    /// Ordinary least squares over physically consistent sets.
    PcOls: "pc-ols", |name, problem| physical::ordinary::estimate(name, problem, Prior::None), STATED_IN_SI,
        "ordinary least squares over physically consistent sets";
    /// Weighted least squares over physically consistent sets.
    PcWls: "pc-wls", physical::weighted::estimate, STATED_IN_SI,
        "weighted least squares over physically consistent sets";
    /// Huber's M-estimate over physically consistent sets.
    PcIrls: "pc-irls", physical::reweighted::estimate, STATED_IN_SI,
        "Huber's M-estimate over physically consistent sets";
    /// Instrumental variables over physically consistent sets.
    PcIv: "pc-iv", physical::instrumental::estimate, LawException::OF_SIMULATION,
        "instrumental variables over physically consistent sets";
    /// Direct and inverse dynamic identification over physically consistent sets.
    PcDidim: "pc-didim", physical::direct_inverse::estimate, LawException::OF_SIMULATION,
        "measured against simulated torque of the closed loop, over physically consistent sets";
    /// Least squares over physically consistent sets near a prior, by the Euclidean distance.
    PcOlsEuclidean: "pc-ols-euclidean",
        |name, problem| physical::ordinary::estimate(name, problem, Prior::Euclidean), PRIOR_IN_SI,
        "consistent least squares near the nominal set, by the Euclidean distance in SI";
    /// Least squares over physically consistent sets near a prior, by the entropic distance.
    PcOlsEntropic: "pc-ols-entropic",
        |name, problem| physical::ordinary::estimate(name, problem, Prior::Entropic), PRIOR_IN_SI,
        "consistent least squares near the nominal set, by the entropic distance";
    /// Least squares over physically consistent sets near a prior, by the entropic distance's curvature at it.
    PcOlsPullback: "pc-ols-pullback",
        |name, problem| physical::ordinary::estimate(name, problem, Prior::Pullback), PRIOR_IN_SI,
        "consistent least squares near the nominal set, by the constant pullback distance";
}

impl EstimatorKind {
    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        self.entry().name
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
        self.entry().name
    }

    fn summary(&self) -> &'static str {
        self.entry().summary
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let equations = problem.factorised()?;
        (self.entry().estimate)(self.entry().name, &EstimationProblem { factorisation: Some(&equations), ..*problem })
    }

    fn exceptions(&self) -> &[LawException] {
        self.entry().exceptions
    }
}
