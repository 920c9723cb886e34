//! Which terms a plant can simulate by itself.

use crate::model::{Robot, StandardParameters};

/// Why a plant cannot simulate a set of parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum TermError {
    /// The law jumps: its velocity scale is zero.
    #[error(
        "joint \"{joint}\": {term} {value} {unit} with a velocity scale of 0 in {key}, expected one above zero, since a \
         law that jumps is not simulated"
    )]
    Jump { joint: String, term: &'static str, value: f64, unit: &'static str, key: &'static str },
    /// The law depends on what a plant does not have.
    #[error(
        "joint \"{joint}\": {term} depends on the transmitted torque or the temperature, expected an arm around the plant \
         that has them"
    )]
    Channel { joint: String, term: &'static str },
}

/// Checks that a plant can simulate every term of which a set of parameters has a coefficient.
///
/// # Errors
/// [`TermError`] for the first that it cannot.
pub fn check_simulable(robot: &Robot, parameters: &StandardParameters) -> Result<(), TermError> {
    for (joint, drive) in robot.joints().iter().zip(&parameters.drives) {
        for (term, value) in drive.iter() {
            let entry = term.entry();
            let (joint_name, meaning) = (joint.name.clone(), entry.meaning);
            if !entry.needs.is_motion() {
                return Err(TermError::Channel { joint: joint_name, term: meaning });
            }
            if let Some(shape) = entry.shapes.iter().find(|shape| shape.smooths && joint.drive.shape(shape) == 0.0) {
                let unit = term.unit(joint.kind);
                return Err(TermError::Jump { joint: joint_name, term: meaning, value, unit, key: shape.key });
            }
        }
    }
    Ok(())
}
