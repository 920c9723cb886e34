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
use crate::estimation::problem::EstimationProblem;

/// Least squares in which far residuals count less, by one loss.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>, loss: Loss) -> Result<Estimate, EstimationError> {
    let equations = problem.factorised()?;
    let start = equations.least_squares()?.solution();
    inference::estimate(name, problem, &from_least_squares(problem, start, loss)?)
}
