//! Maximum likelihood with noise of torque and of the motion.
//!
//! ```text
//! min_{β, ξ} Σ_k (y_k − W(x̂_k + ξ_k) β)ᵀ Σ⁻¹ (…) + ξ_kᵀ G⁻¹ ξ_k
//! ξ eliminated:   Σ_k = Σ + J_k G J_kᵀ, J_k = ∂(Wβ)/∂x        β ← (Σ W̃_kᵀ Σ_k⁻¹ W̃_k)⁻¹ Σ W̃_kᵀ Σ_k⁻¹ (y_k + J_k ξ_k)
//! ξ_k ← G J_kᵀ Σ_k⁻¹ (y_k + J_k ξ_k − W̃_k β)                  W̃_k = W(x̂_k) + ξ_k ∂W/∂x
//! ```
//! The true motion is estimated beside the parameters, so their bias by noisy states goes, and a sample counts by what its own
//! motion makes of that noise. Olsen and Swevers keep the motion a Fourier series over a period; here the band of the processed
//! positions does that, through G ([`super::noise`]). Assumes normal noise of known covariance, unrelated between neighbouring
//! samples. Where no scatter over periods was measured the estimate is that of `wls`, and a finding says so. Slopes are taken over
//! a standard deviation of the motion's noise, so that Coulomb friction has some. Fails where errors of the motion are not small
//! beside its curvature, or are not noise.
//!
//! Source: M. M. Olsen, J. Swevers, W. Verdonck, "Maximum likelihood identification of a dynamic robot model:
//! implementation issues", International Journal of Robotics Research 21(2), 2002.

use nalgebra::{DMatrix, DVector};

use super::noise::MotionNoise;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::{Estimate, IntervalBasis};
use crate::estimation::finding::Finding;
use crate::estimation::inference::Inference;
use crate::estimation::instruments::Instruments;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::residual::residual_noise;
use crate::estimation::termination::Termination;
use crate::linalg::{LeastSquares, RowFactor};

/// Iterations at most.
const ITERATIONS: usize = 60;

/// Relative change of the weighted torque at which the iteration has come to rest.
const AT_REST: f64 = 1e-9;

/// Parameters and motion of the largest likelihood.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let observation = problem.observation;
    let linear = LinearFit::weighted(&*problem.factorised()?)?;
    let (Some(motion), Some(noise)) = (MotionNoise::of(problem), observation.noise.as_ref()) else {
        let mut estimate = linear.estimate(name, problem, &linear.fit, Termination::Direct)?;
        estimate.findings.push(Finding::MotionTakenAsExact);
        return Ok(estimate);
    };
    let mut search = Search {
        observation,
        motion: &motion,
        covariance: noise.covariance(),
        corrections: vec![DVector::zeros(observation.y.len()); 3],
    };
    let mut beta = linear.fit.solution().clone();
    let mut last_step = f64::INFINITY;
    let mut step = search.step(&beta)?;
    let mut termination = None;
    for iterations in 1..=ITERATIONS {
        last_step = step.size_of(&(step.fit.solution() - &beta));
        beta = step.fit.solution().clone();
        if last_step <= AT_REST {
            termination = Some(Termination::Converged { iterations, last_step });
            break;
        }
        termination = problem.ended_after(iterations, ITERATIONS);
        if termination.is_some() {
            break;
        }
        step = search.step(&beta)?;
    }
    let termination = termination.unwrap_or(Termination::IterationLimit { iterations: ITERATIONS, last_step });
    let residual = residual_noise(observation, &step.residual);
    Inference {
        estimator: name,
        problem,
        fit: &step.fit,
        instruments: Instruments::Rows(&step.instruments),
        noise: &residual,
        basis: IntervalBasis::Residual,
        termination,
    }
    .with_residual_noise(observation)
}

/// The motion as it is estimated so far.
struct Search<'a> {
    observation: &'a Observation,
    motion: &'a MotionNoise<'a>,
    /// Σ, n × n.
    covariance: &'a DMatrix<f64>,
    /// ξ of q, q̇ and q̈, n·M each.
    corrections: Vec<DVector<f64>>,
}

/// One weighted fit.
struct Step {
    fit: LeastSquares,
    /// `Σ_k⁻¹ W̃_k`, (n·M) × b.
    instruments: DMatrix<f64>,
    /// `Σ_k^{-½} [W̃_k  y_k]`.
    white: DMatrix<f64>,
    /// `y + J ξ − W̃ β`, n·M.
    residual: DVector<f64>,
}

impl Step {
    /// The torque that a change of parameters makes, over the torque, both weighted.
    fn size_of(&self, change: &DVector<f64>) -> f64 {
        let b = change.len();
        let moved = (self.white.columns(0, b) * change).norm();
        if moved > 0.0 { moved / self.white.column(b).norm() } else { 0.0 }
    }
}

impl Search<'_> {
    /// Solves with weights and motion at `beta`, and corrects the motion.
    fn step(&mut self, beta: &DVector<f64>) -> Result<Step, EstimationError> {
        let (observation, n) = (self.observation, self.observation.dof);
        let (rows, b) = observation.regressor.shape();
        let mut w = observation.regressor.clone();
        // Columns of J: joint after joint, and q, q̇, q̈ of each.
        let mut slopes = Vec::with_capacity(3 * n);
        for c in 0..3 * n {
            let slope = self.motion.slope(observation, c / 3, c % 3);
            slopes.push(&slope * beta);
            for (row, mut entries) in w.row_iter_mut().enumerate() {
                let xi = self.corrections[c % 3][row / n * n + c / 3];
                if xi != 0.0 {
                    entries += slope.row(row) * xi;
                }
            }
        }
        let mut whole = DMatrix::zeros(rows, b + 1);
        whole.columns_mut(0, b).copy_from(&w);
        let mut moved = observation.y.clone();
        let mut white = DMatrix::zeros(rows, b + 1);
        let mut instruments = DMatrix::zeros(rows, b);
        let mut gains = Vec::with_capacity(rows / n);
        for k in 0..rows / n {
            let at = k * n;
            let j = DMatrix::from_fn(n, 3 * n, |i, c| slopes[c][at + i]);
            let xi = DVector::from_fn(3 * n, |c, _| self.corrections[c % 3][at + c / 3]);
            let shift = &j * xi;
            for i in (0..n).filter(|&i| observation.used[at + i]) {
                moved[at + i] += shift[i];
                whole[(at + i, b)] = moved[at + i];
            }
            let spread = &j * self.motion_covariance();
            let mut covariance = self.covariance + &spread * j.transpose();
            for i in (0..n).filter(|&i| !observation.used[at + i]) {
                covariance.row_mut(i).fill(0.0);
                covariance.column_mut(i).fill(0.0);
                covariance[(i, i)] = 1.0;
            }
            let Some(factor) = covariance.cholesky() else { return Err(EstimationError::NotDefinite) };
            let block = whole.rows(at, n).into_owned();
            instruments.rows_mut(at, n).copy_from(&factor.solve(&block.columns(0, b).into_owned()));
            let half = factor.l().solve_lower_triangular(&block).ok_or(EstimationError::NotDefinite)?;
            white.rows_mut(at, n).copy_from(&half);
            gains.push((spread, factor));
        }
        let mut factor = RowFactor::new(b + 1);
        factor.add(rows, |row, column| white[(row, column)]);
        let fit = LeastSquares::from_triangle(&factor.finish()).map_err(|error| observation.named(error))?;
        let mut residual = moved - &w * fit.solution();
        for (row, _) in observation.used.iter().enumerate().filter(|(_, used)| !**used) {
            residual[row] = 0.0;
        }
        for (k, (spread, factor)) in gains.iter().enumerate() {
            let xi = spread.tr_mul(&factor.solve(&residual.rows(k * n, n).into_owned()));
            for c in 0..3 * n {
                self.corrections[c % 3][k * n + c / 3] = xi[c];
            }
        }
        Ok(Step { fit, instruments, white, residual })
    }

    /// G of all joints, 3n × 3n.
    fn motion_covariance(&self) -> DMatrix<f64> {
        let n = self.observation.dof;
        let entry = |r: usize, c: usize| if r / 3 == c / 3 { self.motion.joints[r / 3][(r % 3, c % 3)] } else { 0.0 };
        DMatrix::from_fn(3 * n, 3 * n, entry)
    }
}
