//! Huber's M-estimate by iterated weights.
//!
//! ```text
//! min Σ_r ρ((y_r − w_r β)/s_i)        ω(u) = min(1, 1.345/|u|)
//! ```
//! Convex for given scales: one answer. Assumes that wrong equations are wrong in torque; noise normal but for them. Fails by a
//! single equation whose *row* is far from all others (a leverage point), which moves it without bound: use `mm`.
//!
//! Source: P. J. Huber, "Robust estimation of a location parameter", Annals of Mathematical Statistics 35(1), 1964; constant
//! for 95 % efficiency: P. W. Holland, R. E. Welsch, Communications in Statistics A 6(9), 1977.

use super::inference;
use super::iteration::from_least_squares;
use super::loss::Loss;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::estimator::Estimator;
use crate::estimation::problem::EstimationProblem;

/// Least squares in which residuals beyond 1.345 scales count linearly.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReweightedHuber;

impl Estimator for ReweightedHuber {
    fn name(&self) -> &'static str {
        "irls-huber"
    }

    fn summary(&self) -> &'static str {
        "residuals beyond 1.345 robust standard deviations count linearly (Huber)"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let equations = problem.factorised()?;
        let problem = problem.with_factorisation(&equations);
        let start = equations.least_squares()?.solution();
        let robust = from_least_squares(&problem, start, Loss::Huber)?;
        inference::estimate(self.name(), &problem, &robust)
    }
}
