//! Torque prediction by an estimate, and its validation.

use super::error::EstimationError;
use super::estimate::{BaseEstimate, Estimate};
use super::residual::joint_rms;
use crate::dynamics::{Dynamics, States};
use crate::model::{Robot, StandardParameters};
use crate::regressor::{BLOCKS_OF_PART, JointTorqueRegressor, StackPart};
use crate::signal::Samples;

/// Torque that an estimate predicts for states, N × n row-major, N·m: `Y_b β̂`.
///
/// Columns are found by the names of the base parameters, so the reduction itself is not needed.
///
/// # Errors
/// [`EstimationError::UnknownParameter`] where the regressor lacks a parameter of the estimate; [`EstimationError::Count`]
/// where the states are of another arm.
pub fn predict(
    estimate: &Estimate,
    regressor: &JointTorqueRegressor,
    states: &States,
) -> Result<Vec<f64>, EstimationError> {
    Ok(predict_each(std::slice::from_ref(estimate), regressor, states)?.swap_remove(0))
}

/// [`predict`] for several estimates that share a regressor, which is evaluated once; each has the bits that it has alone.
///
/// # Errors
/// As [`predict`].
pub(super) fn predict_each(
    estimates: &[Estimate],
    regressor: &JointTorqueRegressor,
    states: &States,
) -> Result<Vec<Vec<f64>>, EstimationError> {
    let n = regressor.rows();
    EstimationError::unless_equal("joints of the states", states.dof, n)?;
    let names: Vec<String> = regressor.parameters().iter().map(ToString::to_string).collect();
    let mut columns = Vec::new();
    // A column's place among those that are evaluated, and the parameter's value.
    let mut place_of = |parameter: &BaseEstimate| {
        let column = names
            .iter()
            .position(|name| *name == parameter.name)
            .ok_or_else(|| EstimationError::UnknownParameter { parameter: parameter.name.clone() })?;
        let place = columns.iter().position(|own| *own == column).unwrap_or_else(|| {
            columns.push(column);
            columns.len() - 1
        });
        Ok((place, parameter.value))
    };
    let values = |estimate: &Estimate| estimate.base.iter().map(&mut place_of).collect::<Result<Vec<_>, _>>();
    let values: Vec<Vec<(usize, f64)>> = estimates.iter().map(values).collect::<Result<_, EstimationError>>()?;
    let mut torques = vec![vec![0.0; n * states.len()]; estimates.len()];
    regressor.stack_in_parts(states, &columns, 1, |part| {
        for (torque, values) in torques.iter_mut().zip(&values) {
            for joint in 0..n {
                let sums = joint_torque(part, joint, values);
                let own = torque[n * part.first + joint..].iter_mut().step_by(n);
                own.zip(&sums[..part.count]).for_each(|(tau, sum)| *tau = *sum);
            }
        }
    });
    Ok(torques)
}

/// Torque of a joint at the samples of a part, N·m (N), by columns and their parameters; beyond the last sample it means nothing.
#[inline(always)]
fn joint_torque(part: &StackPart<'_>, joint: usize, values: &[(usize, f64)]) -> [f64; BLOCKS_OF_PART] {
    let mut sums = [0.0; BLOCKS_OF_PART];
    for &(column, value) in values {
        sums.iter_mut().zip(part.line(joint, column)).for_each(|(sum, entry)| *sum += entry * value);
    }
    sums
}

/// A robot with all of its parameters, as a file of it says: what predicts torque without an estimate.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// Its parameters.
    pub parameters: &'a StandardParameters,
}

impl Model<'_> {
    /// Torque of its inverse dynamics for states, N × n row-major, N·m (N).
    ///
    /// # Errors
    /// [`EstimationError::Count`] where the states or the parameters are of another arm.
    pub fn predict(&self, states: &States) -> Result<Vec<f64>, EstimationError> {
        let n = self.robot.dof();
        EstimationError::unless_equal("joints of the states", states.dof, n)?;
        EstimationError::unless_equal("links of the parameters", self.parameters.links.len(), n)?;
        let mut dynamics = Dynamics::new(self.robot, self.parameters);
        let mut torque = vec![0.0; n * states.len()];
        dynamics.inverse_of_samples(states.arrays(), &mut torque);
        Ok(torque)
    }
}

/// How well an estimate predicts torque that was not used to make it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Validation {
    /// RMS difference between measured and predicted torque, n.
    pub rms: Vec<f64>,
    /// Its unit, n.
    pub units: Vec<String>,
    /// RMS difference over the RMS of the measured torque, n; zero where that is zero.
    pub relative_rms: Vec<f64>,
}

impl Validation {
    /// Compares the torque of a model with samples, as [`validate`] does that of an estimate.
    ///
    /// # Errors
    /// As [`Model::predict`].
    pub fn of_model(model: &Model<'_>, samples: &Samples) -> Result<Self, EstimationError> {
        Ok(Self::of_predicted(&model.predict(&samples.states)?, samples))
    }

    fn of_predicted(predicted: &[f64], samples: &Samples) -> Self {
        let n = samples.dof();
        let (measured, predicted) = (samples.block_means(&samples.tau, n), samples.block_means(predicted, n));
        let difference: Vec<f64> = measured.iter().zip(&predicted).map(|(measured, model)| measured - model).collect();
        let (rms, measured) = (joint_rms(&difference, &samples.used, n), joint_rms(&measured, &samples.used, n));
        let relative_rms = rms.iter().zip(&measured).map(|(&r, &m)| if m > 0.0 { r / m } else { 0.0 }).collect();
        Self { rms, units: samples.units.clone(), relative_rms }
    }

    /// Whether every joint's relative difference is at most `limit`.
    pub fn is_within(&self, limit: f64) -> bool {
        self.relative_rms.iter().all(|&r| r <= limit)
    }
}

/// Compares an estimate's prediction with samples, mean over block against mean over block, where friction does not
/// reverse.
///
/// # Errors
/// As [`predict`].
pub fn validate(
    estimate: &Estimate,
    regressor: &JointTorqueRegressor,
    samples: &Samples,
) -> Result<Validation, EstimationError> {
    Ok(Validation::of_predicted(&predict(estimate, regressor, &samples.states)?, samples))
}
