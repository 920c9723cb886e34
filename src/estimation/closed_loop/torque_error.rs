//! Parameters for which simulated torque comes nearest to measured torque.

use nalgebra::DMatrix;

use super::descent::{Descent, Linearised, first_simulable};
use super::trial::Trial;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::problem::EstimationProblem;
use crate::linalg::BlockWhitening;

/// What stands for ∂τ_s/∂β.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TorqueSlope {
    /// The regressor along the simulated motion: what the motion owes to β is left out.
    Regressor,
    /// The derivative of the simulation.
    Exact,
}

impl TorqueSlope {
    /// Share by which a step may raise the sum of squares. The regressor is not its exact slope, and where it is at rest
    /// need not be its minimum.
    const fn rise(self) -> f64 {
        match self {
            Self::Regressor => 1e-2,
            Self::Exact => 1e-9,
        }
    }
}

/// `min ‖y − τ_s(β)‖_Σ` from the weighted linear fit, or from the nominal set where that cannot be simulated.
pub(super) fn estimate(
    estimator: &'static str,
    problem: &EstimationProblem<'_>,
    slope: TorqueSlope,
) -> Result<Estimate, EstimationError> {
    let trial = Trial::of(estimator, problem)?;
    let observation = problem.observation;
    let equations = problem.factorised()?;
    let linear = LinearFit::weighted(&equations)?;
    let linearise = |beta: &nalgebra::DVector<f64>| {
        let (motion, jacobian) = match slope {
            TorqueSlope::Regressor => {
                let motion = trial.motion(beta)?;
                let z = trial.regressor_along(&motion);
                (motion, z)
            }
            TorqueSlope::Exact => {
                let (motion, slopes) = trial.slopes(beta)?;
                (motion, slopes.tau)
            }
        };
        Ok(Linearised { residual: trial.torque_error(&motion), jacobian })
    };
    let start = first_simulable(&[linear.fit.solution().clone(), trial.nominal()], linearise)?;
    let weights = match &linear.weights {
        // The noise that was measured.
        Some(weights) if observation.noise.is_some() => weights.clone(),
        // The residual of the simulated torque, which errors of the measured motion are not in.
        _ => {
            let around = start.1.equations(observation, &start.0);
            let around = Factorisation::new(&around)?;
            BlockWhitening::new(&around.residual_covariance(around.least_squares()?.solution()))?
        }
    };
    let rest = Descent { observation, weights: &weights, rise: slope.rise(), held: DMatrix::zeros(0, start.0.len()) }
        .follow(start, &linearise)?;
    let around = rest.linearised.equations(observation, &rest.beta);
    let equations = Factorisation::new(&around)?;
    let linear = LinearFit::with_weights(&equations, weights)?;
    let problem = EstimationProblem { observation: &around, ..*problem }.with_factorisation(&equations);
    linear.estimate(estimator, &problem, &rest.fit(linear.fit.clone())?, rest.termination)
}
