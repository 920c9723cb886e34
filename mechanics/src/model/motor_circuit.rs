//! The electrical side of a brushed DC motor.

/// The circuit of one motor's armature.
///
/// ```text
/// v = R i + L di/dt + Ke ω + V_b σ(i)        Ke = Kt in SI units, since Kt i ω = Ke ω i is the converted power
/// ```
/// `ω` is the speed of the motor's shaft, ahead of the gear, rad/s; `V_b` the drop over both brushes, against the
/// current, and `σ` its sign, smooth below [`MotorCircuit::BRUSH_CURRENT`].
///
/// Reference: P. I. Corke, "In situ measurement of robot motor electrical constants", Robotica 14(4), 1996.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::MotorCircuit;
/// let motor = MotorCircuit { resistance: 1.5, inductance: 1.5e-3, back_emf: 0.15, brush_drop: 1.0, supply: 70.0 };
/// assert!((motor.voltage(2.0, 0.0, 100.0) - (3.0 + 15.0 + 1.0)).abs() < 1e-12);
/// // At 300 rad/s 24 V are left for the resistance.
/// assert!((motor.current_limits(300.0).high - 16.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorCircuit {
    /// Resistance of the armature and its leads R, Ω.
    pub resistance: f64,
    /// Inductance L, H.
    pub inductance: f64,
    /// Back-EMF constant Ke, V·s/rad.
    pub back_emf: f64,
    /// Drop over the brushes V_b, V.
    pub brush_drop: f64,
    /// Largest voltage that the amplifier can give, V.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub supply: f64,
}

impl MotorCircuit {
    /// Current below which the brushes behave as a resistance, A: assumed, far below the currents of an experiment.
    pub const BRUSH_CURRENT: f64 = 0.02;

    /// Voltage at the terminals, V, for a current (A), its slope (A/s) and the speed of the shaft (rad/s).
    pub fn voltage(&self, current: f64, slope: f64, speed: f64) -> f64 {
        let brushes = self.brush_drop * super::friction::smooth_sign(current, Self::BRUSH_CURRENT);
        self.resistance * current + self.inductance * slope + self.back_emf * speed + brushes
    }

    /// The steady currents, A, that the supply can drive at a speed of the shaft (rad/s).
    pub fn current_limits(&self, speed: f64) -> crate::statistics::Interval {
        let most = |side: f64| {
            let left = side * self.supply - self.back_emf * speed;
            // The brushes take their drop from what is left.
            let behind = if left.abs() > self.brush_drop { left - self.brush_drop.copysign(left) } else { 0.0 };
            behind / self.resistance
        };
        crate::statistics::Interval { low: most(-1.0), high: most(1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::MotorCircuit;

    #[test]
    fn identity_limits_are_the_currents_that_need_the_whole_supply() {
        let motor = MotorCircuit { resistance: 2.0, inductance: 1e-3, back_emf: 0.1, brush_drop: 1.5, supply: 40.0 };
        for speed in [-300.0, -20.0, 0.0, 20.0, 300.0] {
            let crate::statistics::Interval { low, high } = motor.current_limits(speed);
            assert!(low < 0.0 && high > 0.0);
            assert!((motor.voltage(high, 0.0, speed) - 40.0).abs() < 1e-9);
            assert!((motor.voltage(low, 0.0, speed) + 40.0).abs() < 1e-9);
        }
        // Faster than the supply can turn it the motor is a brake at any command.
        assert!(motor.current_limits(500.0).high < 0.0);
    }
}
