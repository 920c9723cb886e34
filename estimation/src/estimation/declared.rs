//! What an estimate owes to what no residual shows, as the robot file declares it: uncertainty of type B.
//!
//! ```text
//! δβ̂ = A⁻¹ Bᵀ G ε        cov ε = 1        cov β̂ += A⁻¹ (BᵀG)(BᵀG)ᵀ A⁻ᵀ
//! ```
//! A column of G, (n·M) × k, is the torque that one standard deviation of one quantity adds to what is measured:
//!
//! ```text
//! torque constant of motor m      s C_mᵀ τ_m        τ_motor = C⁻ᵀ τ
//! lag of motor m behind it        s C_mᵀ τ̇_m
//! coefficient j of a term         s W_j β̂_j, or s W_j where s is an amount
//! ```
//! For the second, `A⁻¹ Bᵀ W_j` is the unit vector: the coefficient that the recording shows is one thing, the one that is meant another.
//! For the first on a single joint, `δβ̂ = s β̂`: everything that is estimated through the motor scales.
//!
//! Reference: JCGM 100:2008, *Guide to the Expression of Uncertainty in Measurement*, 4.3 and 5.1.

use nalgebra::{DMatrix, DVector};

use super::error::EstimationError;
use super::instruments::Instruments;
use super::observation::Observation;
use super::problem::EstimationProblem;
use crate::linalg::{LeastSquares, product};
use crate::model::term::PriorOf;
use crate::model::{DeclaredUncertainty, ParameterKind, Robot};

/// What the robot of a problem declares, in β̂.
pub(super) struct Declared {
    /// cov β̂ by all of it, b × b.
    pub(super) covariance: DMatrix<f64>,
    /// The shifts of β̂ by one standard deviation of each quantity of the motors, b × as many: they are the same in every log.
    pub(super) of_motors: DMatrix<f64>,
}

/// What the robot of the problem declares; `None` where it declares nothing.
pub(super) fn declared(
    problem: &EstimationProblem<'_>,
    fit: &LeastSquares,
    instruments: Instruments<'_>,
) -> Result<Option<Declared>, EstimationError> {
    let (observation, Some(robot)) = (problem.observation, problem.robot) else { return Ok(None) };
    let declared = robot.uncertainty();
    if declared.is_none() || robot.dof() != observation.dof {
        return Ok(None);
    }
    let mut columns = of_motors(problem, robot, declared)?;
    let motors = columns.len();
    columns.extend(coefficients(declared, observation, fit.solution()));
    if columns.is_empty() {
        return Ok(None);
    }
    let shifts = fit.moved_by(&instruments.transposed_product(observation, &DMatrix::from_columns(&columns))?);
    let covariance = product(&shifts, &shifts.transpose());
    Ok(Some(Declared { covariance, of_motors: shifts.columns(0, motors).into_owned() }))
}

/// Torque by one standard deviation of the torque constant of each motor, and of its lag behind the current.
fn of_motors(
    problem: &EstimationProblem<'_>,
    robot: &Robot,
    declared: &DeclaredUncertainty,
) -> Result<Vec<DVector<f64>>, EstimationError> {
    let (constant, lag) =
        (declared.std(DeclaredUncertainty::TORQUE_CONSTANT), declared.std(DeclaredUncertainty::CURRENT_LAG));
    if constant == 0.0 && lag == 0.0 {
        return Ok(Vec::new());
    }
    let (observation, n) = (problem.observation, problem.observation.dof);
    let samples = problem.samples_for("an estimate with a declared uncertainty of motors")?;
    let coupling = robot.coupling().cloned().unwrap_or_else(|| DMatrix::identity(n, n));
    let inverse = coupling.clone().try_inverse().ok_or(EstimationError::NotDefinite)?;
    // From the samples, which have the torque of joints in rows that are no equation of theirs too.
    let tau = samples.block_means(&samples.tau, n);
    let (count, step_s) = (observation.samples(), samples.block as f64 / samples.rate_hz);
    let mut columns = Vec::new();
    for m in 0..n {
        let of_motor = |row: &[f64]| row.iter().enumerate().map(|(j, tau)| inverse[(j, m)] * tau).sum();
        let motor: Vec<f64> = tau.chunks_exact(n).take(count).map(of_motor).collect();
        let rate = |k: usize| {
            let last = count - 1;
            let (before, after) = match (k, observation.periodic) {
                (0, true) => (last, k + 1),
                (k, true) if k == last => (k - 1, 0),
                (k, _) => (k.saturating_sub(1), (k + 1).min(last)),
            };
            let steps = if observation.periodic { 2.0 } else { (after - before).max(1) as f64 };
            (motor[after] - motor[before]) / (steps * step_s)
        };
        let column = |of: &dyn Fn(usize) -> f64| {
            DVector::from_fn(count * n, |row, _| {
                let (k, j) = (row / n, row % n);
                if observation.used[row] { coupling[(m, j)] * of(k) } else { 0.0 }
            })
        };
        if constant > 0.0 {
            columns.push(column(&|k| constant * motor[k]));
        }
        if lag > 0.0 && count > 2 {
            columns.push(column(&|k| lag * rate(k)));
        }
    }
    Ok(columns)
}

/// Torque by one standard deviation of each coefficient that is a base parameter by itself.
fn coefficients(declared: &DeclaredUncertainty, observation: &Observation, beta: &DVector<f64>) -> Vec<DVector<f64>> {
    let mut columns = Vec::new();
    for (j, &value) in beta.iter().enumerate() {
        let [(id, _)] = observation.base.terms(j)[..] else { continue };
        let ParameterKind::Term(term) = id.kind else { continue };
        let prior = term.entry().prior;
        let std = declared.std(prior.key);
        if std > 0.0 {
            let size = match prior.of {
                PriorOf::Value => value.abs(),
                PriorOf::Unit => 1.0,
            };
            columns.push(observation.regressor.column(j) * (std * size));
        }
    }
    columns
}
