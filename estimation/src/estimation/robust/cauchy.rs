//! Cauchy's M-estimate by iterated weights.
//!
//! ```text
//! min Σ_r ρ((y_r − w_r β)/s_i)        ω(u) = 1/(1 + (u/2.385)²)
//! ```
//! Not convex: the answer is the minimum next to weighted least squares, from which the iteration starts. Influence falls as 1/u
//! and never reaches zero. Assumes that wrong equations are wrong in torque, and few. Fails by an equation whose *row* is far from
//! all others (a leverage point): it draws the start to itself and keeps its weight: use `mm`.
//!
//! Source: constant for 95 % efficiency: P. W. Holland, R. E. Welsch, "Robust regression using iteratively reweighted
//! least-squares", Communications in Statistics A 6(9), 1977.

use super::inference;
use super::iteration::from_least_squares;
use super::loss::Loss;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::estimator::Estimator;
use crate::estimation::problem::EstimationProblem;

/// Maximum likelihood of noise with the tails of a Cauchy distribution, 2.385 scales wide.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReweightedCauchy;

impl Estimator for ReweightedCauchy {
    fn name(&self) -> &'static str {
        "irls-cauchy"
    }

    fn summary(&self) -> &'static str {
        "maximum likelihood for noise with the tails of a Cauchy distribution"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let equations = problem.factorised()?;
        let problem = problem.with_factorisation(&equations);
        let start = equations.least_squares()?.solution();
        let robust = from_least_squares(&problem, start, Loss::Cauchy)?;
        inference::estimate(self.name(), &problem, &robust)
    }
}
