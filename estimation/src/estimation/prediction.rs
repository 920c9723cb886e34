//! Torque prediction by an estimate, and its validation.

use super::error::EstimationError;
use super::estimate::Estimate;
use super::residual::joint_rms;
use crate::dynamics::{Dynamics, States};
use crate::model::{Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;
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
    let (n, p) = (regressor.rows(), regressor.cols());
    EstimationError::unless_equal("joints of the states", states.dof, n)?;
    let names: Vec<String> = regressor.parameters().iter().map(ToString::to_string).collect();
    let mut columns = Vec::with_capacity(estimate.base.len());
    for parameter in &estimate.base {
        let column = names
            .iter()
            .position(|name| *name == parameter.name)
            .ok_or_else(|| EstimationError::UnknownParameter { parameter: parameter.name.clone() })?;
        columns.push((column, parameter.value));
    }
    let mut rows = vec![0.0; n * p];
    let mut torque = Vec::with_capacity(n * states.len());
    for k in 0..states.len() {
        regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut rows);
        torque.extend(rows.chunks_exact(p).map(|row| columns.iter().map(|&(c, value)| row[c] * value).sum::<f64>()));
    }
    Ok(torque)
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
        for (k, tau) in torque.chunks_exact_mut(n).enumerate() {
            dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
        }
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
