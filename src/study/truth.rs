//! The true parameters of a simulated arm: read by the simulator and the scoring, out of reach for everything above.

use crate::experiment::Effects;
use crate::model::format::{FormatError, parse_parameters};
use crate::model::{Columns, Drive, Robot, StandardParameters};
use nalgebra::DVector;

/// The arm that a simulation has and an estimate is scored against.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Inertia, rotor, friction and offset of every link and joint.
    pub parameters: StandardParameters,
    /// Effects of the real arm, for which no estimate has a parameter.
    pub effects: Effects,
    /// The true motors, n; empty where they are those of the robot file.
    pub motors: Vec<Drive>,
}

/// The part of a `truth.toml` that is not about parameters.
#[derive(serde::Deserialize)]
struct Beside {
    #[serde(default)]
    effects: Effects,
}

impl Truth {
    /// An arm with these parameters and without effects.
    pub const fn without_effects(parameters: StandardParameters) -> Self {
        Self { parameters, effects: Effects::none(), motors: Vec::new() }
    }

    /// Reads a `truth.toml`: parameters as [`parse_parameters`] reads them, physically consistent, and `[effects]`.
    ///
    /// # Errors
    /// [`FormatError`] with line and column, for either part.
    pub fn from_toml(text: &str, robot: &Robot) -> Result<Self, FormatError> {
        let file = parse_parameters(text, robot, true)?;
        let laws = |drive: &Drive| (drive.coulomb_velocity.to_bits(), drive.shapes.clone());
        for (joint, motor) in robot.joints().iter().zip(&file.motors) {
            if laws(&joint.drive) != laws(motor) {
                let message =
                    format!("drive \"{}\" has other speeds of friction, expected those of the robot file", joint.name);
                return Err(FormatError::at_span(text, 0..0, message));
            }
        }
        let beside: Beside = toml::from_str(text).map_err(|fault| FormatError::of_toml(text, &fault))?;
        Ok(Self { parameters: file.parameters, effects: beside.effects, motors: file.motors })
    }

    /// The vector φ of these columns, length p.
    pub fn vector(&self, robot: &Robot, columns: Columns) -> DVector<f64> {
        self.parameters.vector(robot, columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::EffectKind;
    use crate::model::bundled;
    use crate::model::format::parse_robot;
    use crate::study::truth_text;

    #[test]
    fn effects_stand_beside_the_parameters_and_their_faults_have_a_place() {
        let robot = parse_robot(bundled().iter().find(|entry| entry.name == "planar-2r").unwrap().robot).unwrap();
        let plain = truth_text("planar-2r").unwrap();
        let truth = Truth::from_toml(plain, &robot).unwrap();
        assert!(truth.effects.is_none());
        let text = format!("{plain}\n[effects]\nbacklash = 0.4\nstribeck = \"severe\"\n");
        let real = Truth::from_toml(&text, &robot).unwrap();
        assert_eq!(real.parameters, truth.parameters);
        assert!(real.effects.has(EffectKind::Stribeck) && real.effects.has(EffectKind::Backlash));
        let fault = Truth::from_toml(&text.replace("backlash", "backlsh"), &robot).unwrap_err();
        assert_eq!((fault.line, fault.column), (plain.lines().count() + 3, 1), "{fault}");
        assert!(fault.message.contains("unknown effect `backlsh`"), "{fault}");
    }
}
