//! Parameters and simulated instruments that belong together.
//!
//! ```text
//! β ← (ZᵀΣ⁻¹W)⁻¹ ZᵀΣ⁻¹ y,  or the point of a set nearest to it by its covariance        Z = W(q_s, q̇_s, q̈_s) at the β before
//! ```

use nalgebra::{DMatrix, DVector};

use super::descent::{AT_REST, AT_REST_IN_A_SET, Onto};
use super::endogeneity::durbin_wu_hausman;
use super::starting_point::{StartingPoint, starting_point};
use super::trial::Trial;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::inference::Inference;
use crate::estimation::instruments::Instruments;
use crate::estimation::linear_fit::{LinearFit, noise_of};
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;
use crate::linalg::{BlockWhitening, LeastSquares, product, transpose_product};

/// Simulations at most.
const STEPS: usize = 30;

/// The last instruments, and the solution by them.
pub(in crate::estimation) struct InstrumentalFit {
    /// β by the instruments alone, with `(ZᵀΣ⁻¹W)⁻¹`.
    pub(in crate::estimation) fit: LeastSquares,
    /// How the iteration ended.
    pub(in crate::estimation) termination: Termination,
    weights: BlockWhitening,
    white_z: DMatrix<f64>,
    white_w: DMatrix<f64>,
    white_y: DMatrix<f64>,
    /// β of weighted least squares.
    linear: DVector<f64>,
}

impl InstrumentalFit {
    /// Iterates to rest, in a set where there is one. The problem holds the factorisation of its equations.
    ///
    /// # Errors
    /// [`EstimationError`] where the closed loop cannot be simulated at the first β, or its motion is no instrument.
    pub(in crate::estimation) fn find(
        estimator: &str,
        problem: &EstimationProblem<'_>,
        onto: Option<&Onto<'_>>,
    ) -> Result<Self, EstimationError> {
        let trial = Trial::of(estimator, problem)?;
        let (observation, equations) = (problem.observation, problem.factorised()?);
        let linear = LinearFit::weighted(&equations)?;
        let Some(weights) = linear.weights else { return Err(EstimationError::NotDefinite) };
        let white = |matrix: &DMatrix<f64>| weights.clone().whiten(matrix, &observation.used);
        let (white_w, white_y) = (white(&observation.regressor)?, white(&column(&observation.y))?);
        let at_rest = if onto.is_some() { AT_REST_IN_A_SET } else { AT_REST };
        let solution = |fit: &LeastSquares| Ok(fit.solution().clone());
        let first = onto.map_or_else(|| solution(&linear.fit), |onto| onto(&linear.fit))?;
        let StartingPoint { mut beta, found: mut motion, .. } =
            starting_point(&trial, &first, None, |beta| trial.motion(beta))?;
        let mut iterations = 0;
        let (white_z, fit, termination) = loop {
            iterations += 1;
            let white_z = white(&trial.regressor_along(&motion))?;
            let fit = solve(observation, &white_z, &white_w, &white_y, &linear.fit)?;
            let next = onto.map_or_else(|| solution(&fit), |onto| onto(&with_own_covariance(&fit, &white_z)?))?;
            let change = product(&white_w, &column(&(&next - &beta)));
            let last_step = change.norm() / white_y.norm();
            beta = next;
            if last_step <= at_rest {
                break (white_z, fit, Termination::Converged { iterations, last_step });
            }
            if let Some(termination) = problem.ended_after(iterations, STEPS) {
                break (white_z, fit, termination);
            }
            if iterations == STEPS {
                break (white_z, fit, Termination::IterationLimit { iterations, last_step });
            }
            motion = match trial.motion(&beta) {
                Ok(motion) => motion,
                Err(EstimationError::ClosedLoop { reason, .. }) if reason.is_of_parameters() => {
                    break (white_z, fit, Termination::Unsimulable { iterations });
                }
                Err(EstimationError::Interrupted) => break (white_z, fit, Termination::Interrupted { iterations }),
                Err(error) => return Err(error),
            };
        };
        let linear = linear.fit.solution().clone();
        Ok(Self { fit, termination, weights, white_z, white_w, white_y, linear })
    }

    /// The solution by the instruments alone, with its covariance under the noise of the weights for its inverse information.
    ///
    /// # Errors
    /// As [`LeastSquares::from_factors`].
    pub(in crate::estimation) fn in_own_covariance(&self) -> Result<LeastSquares, EstimationError> {
        with_own_covariance(&self.fit, &self.white_z)
    }

    /// The estimate whose solution is `fit`, this one's own or one near it, with the test whether instruments were needed.
    ///
    /// # Errors
    /// As [`Inference::estimate`].
    pub(in crate::estimation) fn estimate(
        &self,
        estimator: &str,
        problem: &EstimationProblem<'_>,
        fit: &LeastSquares,
        termination: Termination,
    ) -> Result<Estimate, EstimationError> {
        let observation = problem.observation;
        let rows = self.weights.clone().whiten_transposed(&self.white_z, &observation.used)?;
        let (noise, basis) = noise_of(observation, fit);
        let instruments = Instruments::Rows(&rows);
        let mut estimate =
            Inference { estimator, problem, fit, instruments, noise: &noise, basis, termination }.estimate()?;
        let restricted = observation.white(&self.weights, &observation.residual(&self.linear))?.norm_squared();
        let (z, w, y) = (&self.white_z, &self.white_w, &self.white_y);
        let changes = estimate.base.iter().zip(&self.linear).map(|(p, linear)| ((p.value - linear) / p.std).abs());
        let largest = changes.fold(0.0, f64::max);
        estimate.findings.extend(durbin_wu_hausman(z, w, y, restricted, observation.equations(), largest));
        Ok(estimate)
    }
}

fn column(x: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_column_slice(x.len(), 1, x.as_slice())
}

/// A solution by instruments, with `(ZᵀW)⁻¹ ZᵀZ (WᵀZ)⁻¹` for its inverse information.
fn with_own_covariance(fit: &LeastSquares, z: &DMatrix<f64>) -> Result<LeastSquares, EstimationError> {
    Ok(fit.with_solution(fit.solution().clone(), fit.sandwich(&transpose_product(z, z)))?)
}

/// `(ZᵀW)⁻¹ Zᵀ y` of weighted equations, solved with columns of unit length; conditions are those of the linear fit.
fn solve(
    observation: &Observation,
    z: &DMatrix<f64>,
    w: &DMatrix<f64>,
    y: &DMatrix<f64>,
    linear: &LeastSquares,
) -> Result<LeastSquares, EstimationError> {
    let b = w.ncols();
    let lengths = |matrix: &DMatrix<f64>| -> Vec<f64> { matrix.column_iter().map(|column| column.norm()).collect() };
    let (of_z, of_w) = (lengths(z), lengths(w));
    if let Some(j) = (0..b).find(|&j| of_z[j] == 0.0) {
        return Err(EstimationError::NoInstrument { parameter: observation.base.names()[j].clone() });
    }
    let mut a = transpose_product(z, w);
    for j in 0..b {
        for i in 0..b {
            a[(i, j)] /= of_z[i] * of_w[j];
        }
    }
    let Some(mut inverse) = a.try_inverse() else { return Err(EstimationError::WeakInstruments) };
    for j in 0..b {
        for i in 0..b {
            inverse[(i, j)] /= of_w[i] * of_z[j];
        }
    }
    let solution = product(&inverse, &transpose_product(z, y)).column(0).into_owned();
    Ok(linear.with_solution(solution, inverse)?)
}
