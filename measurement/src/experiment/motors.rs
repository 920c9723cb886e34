//! The motors as they really are: torque per ampere, supply, and the voltage that a current at a speed needs.

use crate::lanes::Lane;
use crate::model::{Drive, MotorCircuit};
use crate::statistics::Interval;

/// The motors of one run, in motor coordinates after the gear.
#[derive(Clone, Debug)]
pub(super) struct Motors {
    pub(super) per_ampere: Vec<f64>,
    gear: Vec<f64>,
    circuits: Vec<Option<MotorCircuit>>,
    rate_hz: f64,
}

impl Motors {
    pub(super) fn new(drives: &[Drive], rate_hz: f64) -> Self {
        Self {
            per_ampere: drives.iter().map(Drive::torque_per_ampere).collect(),
            gear: drives.iter().map(|drive| drive.gear).collect(),
            circuits: drives.iter().map(|drive| drive.circuit).collect(),
            rate_hz,
        }
    }

    /// Whether currents (A) of motor i at speeds (after the gear, rad/s) are well below what its supply can drive, of all runs: then
    /// nothing is held, and nothing needs a division.
    #[inline(always)]
    pub(super) fn is_far_below<V: Lane>(&self, i: usize, qd_motor: V, current: V) -> bool {
        let Some(circuit) = &self.circuits[i] else { return true };
        let speed = current.splat(self.gear[i]) * qd_motor;
        let voltage = current.splat(circuit.resistance) * current.magnitude()
            + (current.splat(circuit.back_emf) * speed).magnitude();
        (voltage + current.splat(circuit.brush_drop))
            .less(current.splat(0.99 * circuit.supply), current.splat(1.0), current.splat(0.0))
            .reaches(1.0)
    }

    /// The current of motor i (A) held to what its supply can drive at its speed (after the gear, rad/s).
    #[inline]
    pub(super) fn held(&self, i: usize, qd_motor: f64, current: f64) -> f64 {
        if self.is_far_below(i, qd_motor, current) {
            return current;
        }
        self.circuits[i].map_or(current, |circuit| {
            let Interval { low, high } = circuit.current_limits(self.gear[i] * qd_motor);
            current.clamp(low, high)
        })
    }

    /// Holds the currents (A, n) to what the supply can drive at the motors' speeds (after the gear, rad/s, n);
    /// returns whether one was held.
    pub(super) fn saturate(&self, qd_motor: &[f64], current: &mut [f64]) -> bool {
        let mut saturated = false;
        for (i, (current, qd_motor)) in current.iter_mut().zip(qd_motor).enumerate() {
            if !self.is_far_below(i, *qd_motor, *current) {
                let held = self.held(i, *qd_motor, *current);
                saturated |= held != *current;
                *current = held;
            }
        }
        saturated
    }

    /// By how much a current that the supply holds moves with the motor's speed (after the gear), A·s/rad; `None` where the
    /// supply does not hold it.
    pub(super) fn supply_slope(&self, i: usize, qd_motor: f64, current: f64) -> Option<f64> {
        let circuit = self.circuits[i]?;
        let Interval { low, high } = circuit.current_limits(self.gear[i] * qd_motor);
        if current != low && current != high {
            return None;
        }
        // Between the drops of the brushes nothing flows at any speed.
        Some(if current == 0.0 { 0.0 } else { -circuit.back_emf * self.gear[i] / circuit.resistance })
    }

    /// Mean voltage over the servo period around a sample, V, n. `before` and `after` are the currents held on either
    /// side of it: their mean flows, and their step is the inductance's share.
    pub(super) fn voltages(&self, before: &[f64], after: &[f64], qd_motor: &[f64], voltage: &mut [f64]) {
        for (i, circuit) in self.circuits.iter().enumerate() {
            let slope = (after[i] - before[i]) * self.rate_hz;
            voltage[i] = circuit.map_or(0.0, |circuit| {
                circuit.voltage(0.5 * (before[i] + after[i]), slope, self.gear[i] * qd_motor[i])
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{ExperimentPlan, Sensing, Servo, record};
    use crate::model::Robot;

    const CIRCUIT: MotorCircuit =
        MotorCircuit { resistance: 1.5, inductance: 1.5e-3, back_emf: 0.15, brush_drop: 1.0, supply: 70.0 };

    fn motors(robot: &Robot, circuit: MotorCircuit) -> Vec<Drive> {
        let drive = |joint: &crate::model::Joint| Drive { circuit: Some(circuit), ..joint.drive.clone() };
        robot.joints().iter().map(drive).collect()
    }

    #[test]
    fn analytic_voltage_of_a_flywheel_is_that_of_its_motion() {
        // A flywheel without friction: i = J q̈ / (N Kt), and everything else follows from the motion itself.
        let robot = hinges::single().with_drives(motors(&hinges::single(), CIRCUIT));
        let plan = ExperimentPlan { periods: 1, ..ExperimentPlan::new(hinges::trajectory(1)) };
        let sensing = Sensing { voltage: true, ..Sensing::ideal() };
        let mut servo = Servo::new(&robot, &hinges::parameters(1), FlyWheels::new(1)).unwrap().with_sensing(sensing);
        let recording = record(&mut servo, &plan).unwrap().0;
        assert_eq!(recording.voltage.len(), recording.len());
        let mut turning = 0;
        for k in recording.recorded().skip(1).take(1900) {
            let at = |k: usize| recording.q(k)[0];
            let speed = 100.0 * (at(k + 1) - at(k - 1)) / 2e-3;
            let current = recording.effort(k)[0];
            if current.abs() > 0.2 {
                let expected = 1.5 * current + 15.0 * 0.01 * speed + current.signum();
                // The inductance's share is L di/dt < 1.5 mH · 15 A/s.
                assert!((recording.voltage(k)[0] - expected).abs() < 0.03, "{k}");
                turning += 1;
            }
        }
        assert!(turning > 1000);
    }

    #[test]
    fn a_weak_supply_holds_the_current_and_no_circuit_gives_no_voltage() {
        let robot = hinges::single();
        let plan = ExperimentPlan { periods: 1, ..ExperimentPlan::new(hinges::trajectory(1)) };
        let sensing = Sensing { voltage: true, ..Sensing::ideal() };
        let servo = || Servo::new(&robot, &hinges::parameters(1), FlyWheels::new(1)).unwrap();
        let mut plain = servo().with_sensing(sensing);
        assert!(record(&mut plain, &plan).unwrap().0.voltage.is_empty());
        assert_eq!(plain.tracking().unwrap().saturated_steps, 0);
        // 10 V turn the motor at 60 rad/s, the motion needs up to 100.
        let mut weak = servo().with_motors(motors(&robot, MotorCircuit { supply: 10.0, ..CIRCUIT }));
        record(&mut weak, &plan).unwrap();
        let tracking = weak.tracking().unwrap();
        assert!(tracking.saturated_steps > 100, "{tracking:?}");
    }

    #[test]
    fn analytic_a_weaker_motor_needs_more_current_for_the_same_motion() {
        let robot = hinges::single();
        let plan = ExperimentPlan { periods: 1, ..ExperimentPlan::new(hinges::trajectory(1)) };
        let rms = |factor: f64| {
            let mut motors = motors(&robot, CIRCUIT);
            motors[0].torque_constant *= factor;
            let servo = Servo::new(&robot, &hinges::parameters(1), FlyWheels::new(1)).unwrap();
            let mut servo = servo.with_sensing(Sensing::ideal()).with_motors(motors);
            let recording = record(&mut servo, &plan).unwrap().0;
            let square: f64 = recording.recorded().map(|k| recording.effort(k)[0] * recording.effort(k)[0]).sum();
            square.sqrt()
        };
        // The loop follows a little differently with 0.8 of its gain: a few per cent of the motion's acceleration.
        assert!((rms(0.8) / rms(1.0) - 1.25).abs() < 0.03, "{}", rms(0.8) / rms(1.0));
    }
}
