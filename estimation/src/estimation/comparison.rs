//! Two estimates of one arm side by side.
//!
//! ```text
//! z = (β_b − β_a) / √(std_a² + std_b²)          standard normal where both are right and independent
//! ```

use super::error::EstimationError;
use super::estimate::Estimate;

/// One base parameter in two estimates.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ComparedParameter {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Values of the two estimates.
    pub value: [f64; 2],
    /// Their standard deviations.
    pub std: [f64; 2],
    /// Difference, second less first, in standard deviations of the difference.
    pub difference_std: f64,
}

/// Two estimates side by side.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Comparison {
    /// Name of the robot.
    pub robot: String,
    /// Estimators of the two.
    pub estimators: [String; 2],
    /// The parameters that both have.
    pub parameters: Vec<ComparedParameter>,
    /// Names that only one of them has.
    pub alone: [Vec<String>; 2],
    /// Share of parameters that differ by more than 1.96 standard deviations; 0.05 is expected of noise.
    pub beyond: f64,
    /// Root mean square of the differences in standard deviations; 1 is expected of noise.
    pub rms_difference_std: f64,
    /// RMS residual of each joint in both, n.
    pub residual_rms: [Vec<f64>; 2],
    /// Standard deviation of the noise in the equations of each joint in both, n.
    pub noise_std: [Vec<f64>; 2],
    /// Unit of residuals and noise, n.
    pub units: Vec<String>,
}

/// Compares two estimates of one robot.
///
/// # Errors
/// [`EstimationError::OtherRobot`] where they are of two robots, [`EstimationError::NothingShared`] where they share no
/// parameter.
pub fn compare(first: &Estimate, second: &Estimate) -> Result<Comparison, EstimationError> {
    if first.robot != second.robot {
        let (first, second) = (first.robot.clone(), second.robot.clone());
        return Err(EstimationError::OtherRobot { first, second });
    }
    let mut parameters = Vec::new();
    for a in &first.base {
        let Some(b) = second.base.iter().find(|b| b.name == a.name) else { continue };
        let spread = (a.std * a.std + b.std * b.std).sqrt();
        parameters.push(ComparedParameter {
            name: a.name.clone(),
            unit: a.unit.clone(),
            value: [a.value, b.value],
            std: [a.std, b.std],
            difference_std: (b.value - a.value) / spread,
        });
    }
    if parameters.is_empty() {
        return Err(EstimationError::NothingShared);
    }
    let count = parameters.len() as f64;
    let beyond = parameters.iter().filter(|p| p.difference_std.abs() > 1.96).count() as f64 / count;
    let square = parameters.iter().map(|p| p.difference_std * p.difference_std).sum::<f64>() / count;
    let alone = |one: &Estimate, other: &Estimate| -> Vec<String> {
        one.names().into_iter().filter(|name| other.base.iter().all(|p| p.name != *name)).collect()
    };
    Ok(Comparison {
        robot: first.robot.clone(),
        estimators: [first.estimator.clone(), second.estimator.clone()],
        alone: [alone(first, second), alone(second, first)],
        parameters,
        beyond,
        rms_difference_std: square.sqrt(),
        residual_rms: [first.residual_rms.clone(), second.residual_rms.clone()],
        noise_std: [first.noise_std.clone(), second.noise_std.clone()],
        units: first.units.clone(),
    })
}
