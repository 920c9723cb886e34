//! Generalised total least squares: noise of the torque and noise of the motion.
//!
//! ```text
//! min ‖[ΔW Δy]‖ in units of its noise, (W + ΔW) β = y + Δy
//! [ A  m ]       [ C  0 ]                A = WᵀPW, m = WᵀPy, s = yᵀPy, P = Σ⁻¹
//! [ mᵀ s ] v = λ [ 0  E ] v, λ least     C = E Σ_k ΔW_kᵀ P ΔW_k, E equations            β̂ = (A − λC)⁻¹ m
//! ```
//! C follows from the noise of positions through derivatives and regressor ([`super::noise`]): columns of acceleration have much of
//! it, offsets none. λ is 1 or so where the noise of both sides is known as it is. Removes, to first order, the bias that errors of
//! the motion give least squares. Assumes that these errors are noise of the measured size. Fails where they are none (a delay, an
//! elastic link), and where they are not small: what is left out is of second order. Where no scatter over periods was measured,
//! nothing is known of either noise: the estimate is that of `wls`, and a finding says so.
//!
//! Source: S. Van Huffel, J. Vandewalle, "Analysis and properties of the generalized total least squares problem AX ≈ B
//! when some or all columns in A are subject to error", SIAM J. Matrix Analysis and Applications 10(3), 1989.

use nalgebra::{DMatrix, DVector};

use super::noise::MotionNoise;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::{Estimate, IntervalBasis};
use crate::estimation::finding::Finding;
use crate::estimation::inference::Inference;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::residual::residual_noise;
use crate::estimation::termination::Termination;
use crate::linalg::LeastSquares;

/// Iterations at most; they converge cubically.
const ITERATIONS: usize = 50;

/// Relative change of λ at which it is found.
const FOUND: f64 = 1e-13;

/// Least squares with the noise of torque and of motion.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let observation = problem.observation;
    let linear = LinearFit::weighted(&*problem.factorised()?)?;
    let (Some(motion), Some(weights)) = (MotionNoise::of(problem), &linear.weights) else {
        let mut estimate = linear.estimate(name, problem, &linear.fit, Termination::Direct)?;
        estimate.findings.push(Finding::MotionTakenAsExact);
        return Ok(estimate);
    };
    let errors = motion.error_products(observation, weights)?;
    let count = observation.equations();
    let freedom = count.saturating_sub(linear.fit.solution().len()).max(1) as f64;
    let rest = linear.residual_variance(observation)? * freedom;
    let total = Total::of(&linear.fit, &errors, rest, count as f64).ok_or(EstimationError::NotDefinite)?;
    let fit = linear.fit.with_solution(total.beta, total.inverse)?;
    let noise = residual_noise(observation, &observation.residual(fit.solution()));
    Inference {
        estimator: name,
        problem,
        fit: &fit,
        instruments: linear.instruments(),
        noise: &noise,
        basis: IntervalBasis::Residual,
        termination: total.termination,
    }
    .with_residual_noise(observation)
}

/// The solution of the eigenvalue problem.
struct Total {
    beta: DVector<f64>,
    /// `(A − λC)⁻¹`.
    inverse: DMatrix<f64>,
    termination: Termination,
}

impl Total {
    /// From the solution without errors of the motion, whose weighted residual has the sum of squares `rest`; by Rayleigh
    /// quotients. `None` where A is not positive definite.
    fn of(plain: &LeastSquares, errors: &DMatrix<f64>, rest: f64, equations: f64) -> Option<Self> {
        let (beta, inverse) = (plain.solution(), plain.inverse_information());
        let b = beta.len();
        let unit: DVector<f64> = inverse.diagonal().map(f64::sqrt);
        let a = DMatrix::from_fn(b, b, |i, j| inverse[(i, j)] / (unit[i] * unit[j])).cholesky()?.inverse();
        let c = DMatrix::from_fn(b, b, |i, j| errors[(i, j)] * unit[i] * unit[j]);
        let start = beta.component_div(&unit);
        let mut now = start.clone();
        let (mut lambda, mut last_step) = (0.0, f64::INFINITY);
        let mut solved = a.clone().cholesky()?.inverse();
        let mut termination = None;
        for iterations in 1..=ITERATIONS {
            let moved = &now - &start;
            let quotient = (rest + moved.dot(&(&a * &moved))) / (equations + now.dot(&(&c * &now)));
            last_step = if quotient > 0.0 { (quotient - lambda).abs() / quotient } else { 0.0 };
            lambda = quotient;
            let Some(factor) = (&a - &c * lambda).cholesky() else {
                termination = Some(Termination::Singular { iterations });
                break;
            };
            solved = factor.inverse();
            now = &start + &solved * (&c * &start) * lambda;
            if last_step <= FOUND {
                termination = Some(Termination::Converged { iterations, last_step });
                break;
            }
        }
        Some(Self {
            beta: now.component_mul(&unit),
            inverse: DMatrix::from_fn(b, b, |i, j| solved[(i, j)] * unit[i] * unit[j]),
            termination: termination.unwrap_or(Termination::IterationLimit { iterations: ITERATIONS, last_step }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use nalgebra::SymmetricEigen;
    use rand::RngExt;

    #[test]
    fn identity_the_smallest_generalised_eigenvector() {
        let mut rng = Seed::new(81).stream("total", 0);
        let w = DMatrix::from_fn(80, 4, |_, _| rng.random_range(-1.0..1.0));
        let y = &w * DVector::from_vec(vec![1.0, -2.0, 0.5, 3.0])
            + DVector::from_fn(80, |_, _| rng.random_range(-0.3..0.3));
        let noisy = w.map(|x| x + 0.2 * rng.random_range(-1.0..1.0));
        let root = DMatrix::from_fn(4, 4, |i, j| f64::from(u8::from(i == j)) + 0.2 * rng.random_range(-1.0..1.0));
        let errors = &root * root.transpose();
        let plain = LeastSquares::solve(&noisy, &y).unwrap();
        let rest = (&y - &noisy * plain.solution()).norm_squared();
        let total = Total::of(&plain, &errors, rest, 2.0).unwrap();
        assert!(matches!(total.termination, Termination::Converged { iterations: 2..20, .. }));
        // C^(-½) [W y]ᵀ[W y] C^(-½) by nalgebra.
        let whole = DMatrix::from_fn(80, 5, |k, j| if j < 4 { noisy[(k, j)] } else { y[k] });
        let mut all = DMatrix::zeros(5, 5);
        all.view_mut((0, 0), (4, 4)).copy_from(&errors);
        all[(4, 4)] = 2.0;
        let back = all.cholesky().unwrap().l().try_inverse().unwrap();
        let eigen = SymmetricEigen::new(&back * whole.tr_mul(&whole) * back.transpose());
        let v = back.transpose() * eigen.eigenvectors.column(eigen.eigenvalues.imin());
        for j in 0..4 {
            assert!((total.beta[j] + v[j] / v[4]).abs() < 1e-9, "{} {}", total.beta[j], -v[j] / v[4]);
        }
        // Without errors of the motion it is least squares itself.
        let exact = Total::of(&plain, &DMatrix::zeros(4, 4), rest, 2.0).unwrap();
        assert!((exact.beta - plain.solution()).norm() < 1e-14);
    }
}
