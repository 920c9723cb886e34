//! The closed-loop output error.
//!
//! ```text
//! min ‖q − q_s(β)‖_Σ        J = ∂q_s/∂β of the simulation, exact        β ← β + (JᵀΣ⁻¹J)⁻¹ JᵀΣ⁻¹ (q − q_s(β))
//! ```
//! Positions alone are compared: torque is not read, so torque constants and what biases a current do not matter, but those of
//! the servo's own model do. Σ is found from the residual in two rounds, and with its correlation in time the intervals; torque of
//! the estimate is compared with the measured one all the same, and findings say where it does not fit.
//!
//! Combinations that positions do not show, such as the offsets that an integral in the servo takes up, keep the value and the
//! interval that weighted least squares gives them by torque; a finding names them. Where an arm with the parameters of weighted least
//! squares runs away the search begins by multiple shooting, in intervals too short for that; where it cannot be simulated at all it
//! begins with nominal parameters, which these combinations keep. Findings say both.
//!
//! Assumes servo, reference and start known and the model complete. Fails where the encoders' zeros are off by more than the
//! servo's errors, and where the motion runs away from every start at hand; it finds the minimum beside its start.
//!
//! Joints that were commanded positions by a servo that is not known in full: [`commanded`].
//!
//! Sources: E. Walter, L. Pronzato, *Identification of Parametric Models from Experimental Data*, Springer, 1997; Q. Leboutet et
//! al., "Inertial parameter identification in robotics: a survey", Applied Sciences 11(9), 2021.

use nalgebra::DVector;

use super::commanded;
use super::descent::{Descent, Linearised};
use super::hidden::Hidden;
use super::shooting::Output;
use super::starting_point::{Descended, descend};
use super::trial::Trial;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::{Estimate, IntervalBasis};
use crate::estimation::factorisation::Factorisation;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::residual::residual_noise;
use crate::estimation::termination::Termination;

/// Share by which a step may raise the sum of squares: rounding.
const RISE: f64 = 1e-9;
/// Simulated against measured positions, with the exact slope of the simulation.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let trial = Trial::of_any_servo(name, problem)?;
    if let Some(of) = trial.unknown_servo() {
        return commanded::estimate(name, problem, &trial, of);
    }
    let observation = problem.observation;
    let torque = LinearFit::weighted(&*problem.factorised()?)?;
    // The equations of this estimator: positions, whose noise is that of their residual.
    let positions = Observation { y: trial.positions(), noise: None, torque_covariance: None, ..observation.clone() };
    let linearise = |beta: &DVector<f64>| {
        let (motion, slopes) = trial.slopes(beta)?;
        Ok(Linearised { residual: trial.position_error(&motion), jacobian: slopes.q })
    };
    let by_torque = torque.estimate(name, problem, &torque.fit, Termination::Direct)?.covariance_matrix();
    let round = |at: (DVector<f64>, Linearised)| {
        let weights = at.1.residual_weights(&positions, &at.0)?;
        let hidden = Hidden::at(&at.1.jacobian, &positions, &weights, by_torque.clone())?;
        let held = hidden.held();
        let descent = Descent { problem, observation: &positions, weights: &weights, rise: RISE, held, onto: None };
        let rest = descent.follow(at, &linearise)?;
        let around = descent.solve(&rest.linearised, 0.0)?;
        Ok::<_, EstimationError>((rest, around, weights, hidden))
    };
    let output = Some(Output::Positions);
    let Descended { rest, is_nominal, finding, .. } =
        descend(&trial, torque.fit.solution(), output, &linearise, |start| Ok((round(start)?.0, ())))?;
    let (rest, fit, weights, hidden) = round((rest.beta, rest.linearised))?;
    let around = rest.linearised.equations(&positions, &rest.beta);
    let around_equations = Factorisation::new(&around)?;
    let around_problem = EstimationProblem {
        observation: &around,
        nominal: None,
        robot: None,
        factorisation: Some(&around_equations),
        ..*problem
    };
    let linear = LinearFit {
        fit: fit.with_solution(rest.beta.clone(), fit.inverse_information())?,
        weights: Some(weights),
        noise: residual_noise(&around, &around.residual(&rest.beta)),
        basis: IntervalBasis::Residual,
    };
    let of_positions = linear.estimate(name, &around_problem, &linear.fit, rest.termination)?;
    // The same parameters beside measured torque.
    let beside = fit.with_solution(rest.beta.clone(), torque.fit.inverse_information())?;
    let mut estimate = torque.estimate(name, problem, &beside, rest.termination)?;
    estimate.degrees_of_freedom = of_positions.degrees_of_freedom;
    estimate.motor_errors.clone_from(&of_positions.motor_errors);
    estimate.interval_basis = IntervalBasis::Residual;
    estimate.findings.extend(hidden.finding(observation, is_nominal));
    estimate.findings.extend(finding);
    Ok(estimate.with_covariance(&(of_positions.covariance_matrix() + hidden.covariance())))
}
