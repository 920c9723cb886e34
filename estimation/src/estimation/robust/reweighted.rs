//! M-estimates by iterated weights.
//!
//! ```text
//! min Σ_r ρ((y_r − w_r β)/s_i)        irls-huber     ω(u) = min(1, 1.345/|u|)
//!                                     irls-tukey     ω(u) = (1 − (u/4.685)²)² up to 4.685, 0 beyond
//!                                     irls-cauchy    ω(u) = 1/(1 + (u/2.385)²)
//! ```
//! Huber's is convex for given scales: one answer. The other two are not: the answer is the minimum next to weighted least squares, from
//! which the iteration starts. Equations that are far off in torque lose all influence by Tukey's biweight; by Cauchy's weights
//! influence falls as 1/u and never reaches zero. Assumes that wrong equations are wrong in torque, and for the latter two that they are
//! few; noise normal but for them. Fails by a single equation whose *row* is far from all others (a leverage point), which draws the start
//! to itself and keeps its weight: use `mm`.
//!
//! Sources: P. J. Huber, "Robust estimation of a location parameter", Annals of Mathematical Statistics 35(1), 1964; A. E. Beaton, J. W.
//! Tukey, "The fitting of power series, meaning polynomials, illustrated on band-spectroscopic data", Technometrics 16(2), 1974;
//! constants for 95 % efficiency: P. W. Holland, R. E. Welsch, "Robust regression using iteratively reweighted least-squares",
//! Communications in Statistics A 6(9), 1977.

use super::inference;
use super::iteration::from_least_squares;
use super::loss::Loss;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::estimator::Estimator;
use crate::estimation::problem::EstimationProblem;

/// Least squares in which far residuals count less, by one loss.
#[derive(Clone, Copy, Debug)]
pub struct Reweighted(Loss);

impl Reweighted {
    /// Residuals beyond 1.345 scales count linearly.
    pub const HUBER: Self = Self(Loss::Huber);
    /// Residuals beyond 4.685 scales do not count.
    pub const TUKEY: Self = Self(Loss::Tukey);
    /// Maximum likelihood of noise with the tails of a Cauchy distribution, 2.385 scales wide.
    pub const CAUCHY: Self = Self(Loss::Cauchy);
}

impl Estimator for Reweighted {
    fn name(&self) -> &'static str {
        match self.0 {
            Loss::Huber => "irls-huber",
            Loss::Tukey => "irls-tukey",
            Loss::Cauchy => "irls-cauchy",
        }
    }

    fn summary(&self) -> &'static str {
        match self.0 {
            Loss::Huber => "residuals beyond 1.345 robust standard deviations count linearly (Huber)",
            Loss::Tukey => "residuals beyond 4.685 robust standard deviations do not count (Tukey)",
            Loss::Cauchy => "maximum likelihood for noise with the tails of a Cauchy distribution",
        }
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let equations = problem.factorised()?;
        let problem = problem.with_factorisation(&equations);
        let start = equations.least_squares()?.solution();
        inference::estimate(self.name(), &problem, &from_least_squares(&problem, start, self.0)?)
    }
}
