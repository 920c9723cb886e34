//! Tukey's biweight M-estimate by iterated weights.
//!
//! ```text
//! min Σ_r ρ((y_r − w_r β)/s_i)        ω(u) = (1 − (u/4.685)²)² up to 4.685, 0 beyond
//! ```
//! Not convex: the answer is the minimum next to weighted least squares, from which the iteration starts. Equations that are far
//! off in torque lose all influence. Assumes that wrong equations are wrong in torque, and few. Fails by one whose *row* is far
//! from all others (a leverage point): it draws the start to itself and keeps its weight: use `mm`.
//!
//! Source: A. E. Beaton, J. W. Tukey, "The fitting of power series, meaning polynomials, illustrated on band-spectroscopic
//! data", Technometrics 16(2), 1974; constant for 95 % efficiency: Holland and Welsch (1977).

use super::inference;
use super::iteration::from_least_squares;
use super::loss::Loss;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::estimator::Estimator;
use crate::estimation::problem::EstimationProblem;

/// Least squares in which residuals beyond 4.685 scales do not count.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReweightedTukey;

impl Estimator for ReweightedTukey {
    fn name(&self) -> &'static str {
        "irls-tukey"
    }

    fn summary(&self) -> &'static str {
        "residuals beyond 4.685 robust standard deviations do not count (Tukey)"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let equations = problem.factorised()?;
        let problem = problem.with_factorisation(&equations);
        let start = equations.least_squares()?.solution();
        let robust = from_least_squares(&problem, start, Loss::Tukey)?;
        inference::estimate(self.name(), &problem, &robust)
    }
}
