//! The closed-loop output error of joints that were commanded positions, by servos that are not known in full.
//!
//! ```text
//! min ‖q − q_s(β, η, s)‖_Σ        η of the servos, s the state in which each log begins
//! ```
//! No torque is measured: positions alone are compared, along the commands of the log. The steps are Gauss and Newton's on all numbers
//! together, and so are the intervals. What the motion does not show is refused before the search: a number of a servo that moves the arm
//! as others together do. With every stiffness unknown that is the case always, since twice the gains and twice the inertias move
//! alike; damping acts as viscous friction does; the zero of the last encoder turns the last link, that of a vertical first axis the room.
//!
//! Reference: F. Bjelonic and others, "Towards bridging the gap: systematic sim-to-real transfer for diverse legged robots" (PACE),
//! 2025, for the same unknowns without intervals.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::descent::{Descent, Linearised, is_rejected};
use super::error::ClosedLoopError;
use super::simulation::CommandedLoop;
use super::trial::Trial;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::{Estimate, IntervalBasis};
use crate::estimation::factorisation::Factorisation;
use crate::estimation::inference::Inference;
use crate::estimation::instruments::Instruments;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::estimation::position_servo::{ServoEstimate, ServoPart};
use crate::estimation::problem::EstimationProblem;
use crate::estimation::residual::residual_noise;
use crate::linalg::{BlockWhitening, product};
use crate::statistics::student_quantile;

/// Share by which a step may raise the sum of squares: rounding.
const RISE: f64 = 1e-9;

/// Length of a combination of columns of unit length below which it moves nothing.
const HIDDEN: f64 = 1e-5;

/// Part in a combination below which a number is not in it.
const IN_IT: f64 = 0.02;

/// Parameters of the arm and numbers of its servos for which simulated positions come nearest to measured ones.
pub(super) fn estimate(
    name: &str,
    problem: &EstimationProblem<'_>,
    trial: &Trial<'_>,
    of: &dyn CommandedLoop,
) -> Result<Estimate, EstimationError> {
    let observation = problem.observation;
    let equations = problem.factorised()?;
    let guess = LinearFit::weighted(&equations)?;
    let positions = Observation { y: trial.positions(), noise: None, torque_covariance: None, ..observation.clone() };
    let linearise = |x: &DVector<f64>| trial.commanded(of, x);
    let start = begun(trial, of, guess.fit.solution(), &linearise)?;
    check_shown(trial, of, &start, &positions)?;
    let round = |at: (DVector<f64>, Linearised)| {
        let weights = at.1.residual_weights(&positions, &at.0)?;
        let held = DMatrix::zeros(0, at.0.len());
        let descent = Descent { problem, observation: &positions, weights: &weights, rise: RISE, held, onto: None };
        let rest = descent.follow(at, &linearise)?;
        let fit = descent.solve(&rest.linearised, 0.0)?;
        Ok::<_, EstimationError>((rest, fit, weights))
    };
    let (first, ..) = round(start)?;
    let (rest, fit, weights) = round((first.beta, first.linearised))?;

    let around = rest.linearised.equations(&positions, &rest.beta);
    let around_equations = Factorisation::new(&around)?;
    let noise = residual_noise(&around, &around.residual(&rest.beta));
    let all = fit.with_solution(rest.beta.clone(), fit.inverse_information())?;
    let around_problem = EstimationProblem { observation: &around, nominal: None, robot: None, ..*problem };
    let of_positions = Inference {
        estimator: name,
        problem: &around_problem,
        fit: &all,
        instruments: Instruments::Weighted(&weights),
        noise: &noise,
        basis: IntervalBasis::Residual,
        termination: rest.termination,
    };
    let covariance = of_positions.covariance(&around_equations, &noise)?.1;

    // The same parameters beside the torque that the servos had by what was found.
    let b = observation.base.rank();
    let stated = of.servo();
    let found = stated.clone().with_unknown(&rest.beta.as_slice()[b..b + stated.unknown.len()]);
    let robot = problem.robot_for(name)?;
    let restated = stated.restated_samples(problem.samples_for(name)?, &found);
    let beside = Observation::new(robot, &observation.joint_regressor(robot), &observation.base, &restated)?;
    let beside_equations = Factorisation::new(&beside)?;
    let torque = LinearFit::weighted(&beside_equations)?;
    let beside_problem = EstimationProblem { observation: &beside, samples: Some(&restated), ..*problem };
    let beside_problem = EstimationProblem { factorisation: Some(&beside_equations), ..beside_problem };
    let of_arm = fit.with_solution(rest.beta.rows(0, b).into_owned(), torque.fit.inverse_information())?;
    let mut estimate = torque.estimate(name, &beside_problem, &of_arm, rest.termination)?;
    estimate.degrees_of_freedom = noise.degrees_of_freedom;
    estimate.motor_errors = Vec::new();
    estimate.interval_basis = IntervalBasis::Residual;
    let t = student_quantile(0.975, estimate.degrees_of_freedom);
    let number = |(at, part): (usize, &ServoPart)| {
        let (value, std) = (rest.beta[b + at], covariance[(b + at, b + at)].max(0.0).sqrt());
        let unit = part.unit(part.joint().map_or("", |joint| observation.units[joint].as_str())).to_owned();
        let ci95 = [value - t * std, value + t * std];
        ServoEstimate { name: part.to_string(), value, std, ci95, stated: stated.value(*part), unit }
    };
    estimate.servo = stated.unknown.iter().enumerate().map(number).collect();
    Ok(estimate.with_covariance(&covariance.view((0, 0), (b, b)).into_owned()))
}

/// β by the stated servos, or the nominal one where that arm runs away; the stated numbers; the measured states.
fn begun(
    trial: &Trial<'_>,
    of: &dyn CommandedLoop,
    by_guess: &DVector<f64>,
    linearise: &dyn Fn(&DVector<f64>) -> Result<Linearised, EstimationError>,
) -> Result<(DVector<f64>, Linearised), EstimationError> {
    let servo = of.servo();
    let stated = servo.unknown.iter().map(|part| servo.value(*part));
    let rest: Vec<f64> = stated.chain(of.starts()).collect();
    let mut last = EstimationError::NotDefinite;
    for beta in trial.beginnings(by_guess.clone()) {
        let x = DVector::from_iterator(beta.len() + rest.len(), beta.iter().chain(&rest).copied());
        match linearise(&x) {
            Ok(found) => return Ok((x, found)),
            Err(error) if is_rejected(&error) => last = error,
            Err(error) => return Err(error),
        }
    }
    Err(last)
}

/// Every unknown number of the servos moves the arm as no combination of others does.
fn check_shown(
    trial: &Trial<'_>,
    of: &dyn CommandedLoop,
    at: &(DVector<f64>, Linearised),
    positions: &Observation,
) -> Result<(), EstimationError> {
    let base = positions.base.names();
    let unknown = &of.servo().unknown;
    let hidden = |part: ServoPart, with: Vec<String>| {
        Err(trial.failed(ClosedLoopError::ServoHidden { part: part.to_string(), with }))
    };
    let mut weights = BlockWhitening::new(&DMatrix::identity(positions.dof, positions.dof))?;
    let mut columns = weights.whiten(&at.1.jacobian, &positions.used)?;
    let lengths: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
    for (mut column, length) in columns.column_iter_mut().zip(&lengths) {
        column /= length.max(f64::MIN_POSITIVE);
    }
    let b = base.len();
    // A column without length moves nothing; rounding of the motion is far below this.
    let longest = |part: ServoPart| match part {
        ServoPart::Zero(_) => 1e-9,
        ServoPart::Stiffness(_) | ServoPart::Damping(_) | ServoPart::Delay => f64::MIN_POSITIVE,
    };
    for (at, &part) in unknown.iter().enumerate() {
        if lengths[b + at] <= longest(part) {
            return hidden(part, Vec::new());
        }
    }
    let eigen = SymmetricEigen::new(product(&columns.transpose(), &columns));
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > HIDDEN * HIDDEN {
            continue;
        }
        let servo = (0..unknown.len()).max_by(|&i, &j| vector[b + i].abs().total_cmp(&vector[b + j].abs()));
        let Some(at) = servo.filter(|&at| vector[b + at].abs() > IN_IT) else { continue };
        let is_in_it = |&j: &usize| j != b + at && vector[j].abs() > IN_IT;
        let name = |j: usize| base.get(j).cloned().or_else(|| unknown.get(j - b).map(ToString::to_string));
        return hidden(unknown[at], (0..vector.len()).filter(is_in_it).filter_map(name).collect());
    }
    Ok(())
}
