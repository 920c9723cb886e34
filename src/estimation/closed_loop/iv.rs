//! Instrumental variables from a simulated motion.
//!
//! ```text
//! β = (ZᵀΣ⁻¹W)⁻¹ ZᵀΣ⁻¹ y        Z = W(q_s, q̇_s, q̈_s) along the motion simulated at the last β, repeated until β is at rest
//! ```
//! Errors of the measured motion are in W and bias least squares by `E WᵀΣ⁻¹W`, which holds their squares; the simulated motion
//! has none of them, so `E ZᵀΣ⁻¹W` does not. The estimate is consistent whatever Z is, as long as Z goes with the true regressor
//! and not with the noise; an incomplete model or a servo that is not quite as stated widens the intervals more than it biases.
//! Intervals are the sandwich with B = Σ⁻¹Z.
//!
//! Assumes that the model explains torque but for noise, and that servo, reference and start are known. Fails where the simulated
//! motion hardly goes with the measured one. Whether it was needed is said by the Durbin–Wu–Hausman test
//! ([`super::endogeneity`]) in a finding: where it was not, `wls` has the shorter intervals.
//!
//! Source: A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial robot identification",
//! IEEE Trans. Control Systems Technology 22(1), 2014.

use nalgebra::{DMatrix, DVector};

use super::descent::first_simulable;
use super::endogeneity::durbin_wu_hausman;
use super::trial::Trial;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::{Estimate, IntervalBasis};
use crate::estimation::estimator::Estimator;
use crate::estimation::inference::Inference;
use crate::estimation::instruments::Instruments;
use crate::estimation::law::LawException;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::residual::{residual_noise, scatter_noise};
use crate::estimation::termination::Termination;
use crate::linalg::{LeastSquares, product, transpose_product};

/// Simulations at most.
const STEPS: usize = 30;
/// Change of the weighted torque, over the torque, at which the iteration has come to rest.
const AT_REST: f64 = 1e-9;

/// Instrumental variables with the regressor along the simulated motion as instruments.
#[derive(Clone, Copy, Debug, Default)]
pub struct InstrumentalVariables;

impl Estimator for InstrumentalVariables {
    fn name(&self) -> &'static str {
        "iv"
    }

    fn summary(&self) -> &'static str {
        "instrumental variables: the regressor along the simulated motion as instruments"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let trial = Trial::of(self.name(), problem)?;
        let (observation, equations) = (problem.observation, problem.factorised()?);
        let problem = problem.with_factorisation(&equations);
        let linear = LinearFit::weighted(&equations)?;
        let Some(weights) = &linear.weights else { return Err(EstimationError::NotDefinite) };
        let white = |matrix: &DMatrix<f64>| weights.clone().whiten(matrix, &observation.used);
        let (white_w, white_y) = (white(&observation.regressor)?, white(&column(&observation.y))?);
        let starts = [linear.fit.solution().clone(), trial.nominal()];
        let (mut beta, mut motion) = first_simulable(&starts, |beta| trial.motion(beta))?;
        let mut iterations = 0;
        let (white_z, fit, termination) = loop {
            iterations += 1;
            let white_z = white(&trial.regressor_along(&motion))?;
            let fit = solve(observation, &white_z, &white_w, &white_y, &linear.fit)?;
            let change = product(&white_w, &column(&(fit.solution() - &beta)));
            let last_step = change.norm() / white_y.norm();
            beta = fit.solution().clone();
            if last_step <= AT_REST {
                break (white_z, fit, Termination::Converged { iterations, last_step });
            }
            if iterations == STEPS {
                break (white_z, fit, Termination::IterationLimit { iterations, last_step });
            }
            motion = match trial.motion(&beta) {
                Ok(motion) => motion,
                Err(EstimationError::ClosedLoop { reason, .. }) if reason.is_of_parameters() => {
                    break (white_z, fit, Termination::Unsimulable { iterations });
                }
                Err(error) => return Err(error),
            };
        };
        let rows = weights.clone().whiten_transposed(&white_z, &observation.used)?;
        let (noise, basis) = match scatter_noise(observation) {
            Some(noise) => (noise, IntervalBasis::Scatter),
            None => (residual_noise(observation, &observation.residual(&beta)), IntervalBasis::Residual),
        };
        let mut estimate = Inference {
            estimator: self.name(),
            problem: &problem,
            fit: &fit,
            instruments: Instruments::Rows(&rows),
            noise: &noise,
            basis,
            termination,
        }
        .estimate()?;
        let white_residual = white(&column(&observation.residual(linear.fit.solution())))?;
        let test =
            durbin_wu_hausman(&white_z, &white_w, &white_y, white_residual.norm_squared(), observation.equations());
        estimate.findings.extend(test);
        Ok(estimate)
    }

    fn exceptions(&self) -> &[LawException] {
        LawException::OF_SIMULATION
    }
}

fn column(x: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_column_slice(x.len(), 1, x.as_slice())
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
    let factors = [inverse, DMatrix::identity(b, b)];
    Ok(LeastSquares::from_factors(solution, factors, linear.condition(), linear.condition_scaled())?)
}
