//! The motor, gear, encoder and current sensor of one joint.

use std::collections::BTreeMap;

use super::motor_circuit::MotorCircuit;
use super::term::{Scale, ShapeParameter, Shapes, Term};

/// One drive. Everything here is either on a data sheet or measured by an experiment of its own; where it is neither,
/// the robot's README marks it as assumed.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Gear ratio: motor turns per joint turn (rad per m for a prismatic joint); positive.
    pub gear: f64,
    /// Torque constant of the motor, N·m/A.
    pub torque_constant: f64,
    /// Largest current, A.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub current_limit: f64,
    /// Largest root mean square of the current over a period, A; infinite where it is not stated.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub continuous_current: f64,
    /// Encoder counts per joint revolution (per m for a prismatic joint).
    pub counts_per_revolution: f64,
    /// Sign of the encoder against the joint: +1 or −1.
    pub encoder_sign: f64,
    /// White noise of the current sensor, standard deviation of one sample, A.
    pub current_noise: f64,
    /// Full scale of the current's converter: it reads −range to +range, A.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub adc_range: f64,
    /// Bits of that converter; 0 means that it does not quantise.
    pub adc_bits: u32,
    /// Velocity scale of the smooth sign in Coulomb friction, rad/s; see [`super::smooth_sign`].
    pub coulomb_velocity: f64,
    /// Other shape parameters of torque laws that the robot file states, by their keys.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub shapes: BTreeMap<String, f64>,
    /// The motor's circuit, where the robot file has it.
    pub circuit: Option<MotorCircuit>,
    /// White noise of the voltage that the controller reports, standard deviation of one sample, V.
    pub voltage_noise: f64,
}

impl Drive {
    /// An ideal drive: 1 N·m of joint torque per ampere, no noise, no quantisation, plain sign. For closed forms.
    #[must_use]
    pub const fn ideal() -> Self {
        Self {
            gear: 1.0,
            torque_constant: 1.0,
            current_limit: f64::INFINITY,
            continuous_current: f64::INFINITY,
            counts_per_revolution: 0.0,
            encoder_sign: 1.0,
            current_noise: 0.0,
            adc_range: f64::INFINITY,
            adc_bits: 0,
            coulomb_velocity: 0.0,
            shapes: BTreeMap::new(),
            circuit: None,
            voltage_noise: 0.0,
        }
    }

    /// A shape parameter of a torque law: as the robot file states it, or its default.
    pub fn shape(&self, parameter: &ShapeParameter) -> f64 {
        if *parameter == ShapeParameter::COULOMB_VELOCITY {
            self.coulomb_velocity
        } else {
            self.shapes.get(parameter.key).copied().unwrap_or(parameter.default)
        }
    }

    /// Sets a shape parameter of a torque law.
    pub fn set_shape(&mut self, parameter: &ShapeParameter, value: f64) {
        if *parameter == ShapeParameter::COULOMB_VELOCITY {
            self.coulomb_velocity = value;
        } else {
            self.shapes.insert(parameter.key.to_owned(), value);
        }
    }

    /// All shape parameters of a term's law, in the order of its entry.
    pub fn shapes_of(&self, term: Term) -> Shapes {
        let shapes = term.entry().shapes;
        std::array::from_fn(|k| Scale::new(shapes.get(k).map_or(0.0, |parameter| self.shape(parameter))))
    }

    /// Torque at the motor's own joint coordinate per ampere: gear × torque constant, N·m/A.
    pub fn torque_per_ampere(&self) -> f64 {
        self.gear * self.torque_constant
    }

    /// Smallest step of the encoder at the joint, rad (m for a prismatic joint); 0 where it does not quantise.
    pub fn encoder_step(&self, revolute: bool) -> f64 {
        if self.counts_per_revolution > 0.0 {
            (if revolute { std::f64::consts::TAU } else { 1.0 }) / self.counts_per_revolution
        } else {
            0.0
        }
    }

    /// Smallest step of the current's converter, A; 0 where it does not quantise.
    pub fn adc_step(&self) -> f64 {
        if self.adc_bits > 0 { 2.0 * self.adc_range / f64::from(1_u32 << self.adc_bits) } else { 0.0 }
    }
}
