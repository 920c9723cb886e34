//! Parameters for which simulated torque comes nearest to measured torque.

use nalgebra::DMatrix;

use super::descent::{Descent, Linearised, Onto, Rest};
use super::shooting::Output;
use super::starting_point::{Descended, descend};
use super::trial::Trial;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::finding::Finding;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::linalg::BlockWhitening;

/// What stands for ∂τ_s/∂β.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::estimation) enum TorqueSlope {
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

/// Where a search ended.
pub(in crate::estimation) struct TorqueSearch {
    /// Linear equations around that point.
    pub(in crate::estimation) around: Observation,
    /// Their weights.
    pub(in crate::estimation) weights: BlockWhitening,
    pub(in crate::estimation) rest: Rest,
    /// What is to be said of where the search began.
    pub(super) finding: Option<Finding>,
}

/// The estimate where `min ‖y − τ_s(β)‖_Σ`.
pub(super) fn estimate(
    estimator: &str,
    problem: &EstimationProblem<'_>,
    slope: TorqueSlope,
) -> Result<Estimate, EstimationError> {
    let TorqueSearch { around, weights, rest, finding } = search(estimator, problem, slope, None)?;
    let equations = Factorisation::new(&around)?;
    let linear = LinearFit::with_weights(&equations, weights)?;
    let problem = EstimationProblem { observation: &around, factorisation: Some(&equations), ..*problem };
    let mut estimate = linear.estimate(estimator, &problem, &rest.fit(linear.fit.clone())?, rest.termination)?;
    estimate.findings.extend(finding);
    Ok(estimate)
}

/// `min ‖y − τ_s(β)‖_Σ`, over a set where there is one, from the weighted linear fit, or from what [`starting_point`] finds where
/// that cannot be simulated.
pub(in crate::estimation) fn search(
    estimator: &str,
    problem: &EstimationProblem<'_>,
    slope: TorqueSlope,
    onto: Option<&Onto<'_>>,
) -> Result<TorqueSearch, EstimationError> {
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
    let first = onto.map_or_else(|| Ok(linear.fit.solution().clone()), |onto| onto(&linear.fit))?;
    // Intervals need the exact slope, and would end outside of a set.
    let output = match (slope, onto) {
        (TorqueSlope::Exact, None) => Some(Output::Torque),
        (TorqueSlope::Exact | TorqueSlope::Regressor, _) => None,
    };
    let held = DMatrix::zeros(0, first.len());
    let follow = |start: (nalgebra::DVector<f64>, Linearised)| {
        let weights = match &linear.weights {
            // The noise that was measured.
            Some(weights) if observation.noise.is_some() => weights.clone(),
            // The residual of the simulated torque, which errors of the measured motion are not in.
            _ => {
                let around = start.1.equations(observation, &start.0);
                let around = Factorisation::new(&around)?;
                around.residual_weights(around.least_squares()?.solution())?
            }
        };
        let descent = Descent { problem, observation, weights: &weights, rise: slope.rise(), held: held.clone(), onto };
        Ok((descent.follow(start, &linearise)?, weights))
    };
    let Descended { rest, beside: weights, finding, .. } = descend(&trial, &first, output, &linearise, follow)?;
    let around = rest.linearised.equations(observation, &rest.beta);
    Ok(TorqueSearch { around, weights, rest, finding })
}
