//! Ridge regression: parameters that the motion hardly shows are drawn towards zero.
//!
//! ```text
//! β̂ = (WᵀPW + k D)⁻¹ WᵀP y        D = diag(WᵀPW)        k = b σ̂² / (β₀ᵀ D β₀), β₀ and σ̂² of weighted least squares
//! ```
//! Assumes what `wls` does, whose P this is. With D in place of 1 the answer does not depend on the units of the parameters.
//! k is the choice of Hoerl, Kennard and Baldwin, from the data alone; exact equations give k = 0. For poorly conditioned
//! equations: less scatter for some bias. Standard deviations are roots of the mean squared error, `cov + bias biasᵀ` with the bias
//! `−k (WᵀPW + kD)⁻¹ D β̂` at the estimate. Fails where zero is far from the truth in the weak directions: bias then outweighs
//! what is won.
//!
//! Sources: A. E. Hoerl, R. W. Kennard, "Ridge regression", Technometrics 12(1), 1970; A. E. Hoerl, R. W. Kennard, K. F.
//! Baldwin, "Ridge regression: some simulations", Communications in Statistics 4(2), 1975, for k.

use nalgebra::{DMatrix, DVector};

use super::error::EstimationError;
use super::estimate::Estimate;
use super::linear_fit::LinearFit;
use super::problem::EstimationProblem;
use super::termination::Termination;
use crate::linalg::LeastSquares;

/// Weighted least squares with a penalty on large parameters.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let observation = problem.observation;
    let linear = LinearFit::weighted(&*problem.factorised()?)?;
    let shrunk = Shrunk::of(&linear.fit, linear.residual_variance(observation)?).ok_or(EstimationError::NotDefinite)?;
    let fit = linear.fit.with_solution(shrunk.beta, shrunk.inverse)?;
    let estimate = linear.estimate(name, problem, &fit, Termination::Direct)?;
    let covariance = estimate.covariance_matrix() + &shrunk.bias * shrunk.bias.transpose();
    Ok(estimate.with_covariance(&covariance))
}

/// The solution with its penalty.
pub(super) struct Shrunk {
    pub(super) beta: DVector<f64>,
    /// `(A + k D)⁻¹`.
    pub(super) inverse: DMatrix<f64>,
    pub(super) bias: DVector<f64>,
}

impl Shrunk {
    /// From the solution without: `β₀ − β̂ = k (A + k D)⁻¹ D β₀`, small where k is. `None` where A is not positive definite.
    pub(super) fn of(plain: &LeastSquares, variance: f64) -> Option<Self> {
        let (beta, inverse) = (plain.solution(), plain.inverse_information());
        let b = beta.len();
        // Units in which A⁻¹ has a unit diagonal, and then those in which A has.
        let first: DVector<f64> = inverse.diagonal().map(f64::sqrt);
        let unit = DMatrix::from_fn(b, b, |i, j| inverse[(i, j)] / (first[i] * first[j]));
        let a = unit.cholesky()?.inverse();
        let lengths = DVector::from_fn(b, |j, _| a[(j, j)].sqrt() / first[j]);
        let mut penalised = DMatrix::from_fn(b, b, |i, j| a[(i, j)] / (a[(i, i)] * a[(j, j)]).sqrt());
        let scaled = beta.component_mul(&lengths);
        let k = b as f64 * variance / scaled.norm_squared();
        let k = if k.is_finite() { k } else { 0.0 };
        for j in 0..b {
            penalised[(j, j)] += k;
        }
        let penalised = penalised.cholesky()?.inverse();
        let drawn = |beta: &DVector<f64>| (&penalised * beta.component_mul(&lengths) * k).component_div(&lengths);
        let shrunk = beta - drawn(beta);
        Some(Self {
            bias: -drawn(&shrunk),
            beta: shrunk,
            inverse: DMatrix::from_fn(b, b, |i, j| penalised[(i, j)] / (lengths[i] * lengths[j])),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn frozen_ridge_is_that_of_numpy() {
        // NumPy 2.4.6: X = D⁻½, k = 3 s²/|D½ b|², np.linalg.solve(X'X + k diag(X'X), X'y).
        let w = dmatrix![
            1.0, 2.0, 2.9; 2.0, 1.0, 3.1; 3.0, 5.0, 8.2; 4.0, 1.0, 4.9; 5.0, 3.0, 8.1; 6.0, 2.0, 7.8; 7.0, 8.0, 15.1
        ];
        let y = dvector![8.1, 9.3, 23.7, 15.2, 24.4, 24.0, 45.1];
        let plain = LeastSquares::solve(&w, &y).unwrap();
        let variance = (&y - &w * plain.solution()).norm_squared() / 4.0;
        let shrunk = Shrunk::of(&plain, variance).unwrap();
        for (found, expected) in shrunk.beta.iter().zip(EXPECTED) {
            assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
        }
        // Without noise nothing is drawn anywhere.
        let exact = Shrunk::of(&plain, 0.0).unwrap();
        assert_eq!((exact.beta, exact.bias.norm()), (plain.solution().clone(), 0.0));
    }

    const EXPECTED: [f64; 3] = [1.059_194_805_709_773, 0.717_646_453_441_515_2, 2.094_728_676_806_888_7];
}
