//! The torque constant of a motor from its back-EMF, measured in place.
//!
//! ```text
//! mean over a window of h seconds:   v̄ = R ī + L (i_end − i_begin)/h + Ke N (q_end − q_begin)/h + V_b sgn(i)
//! ```
//! A window's mean speed is the difference of two encoder readings, so no derivative is taken, and its mean voltage is
//! exactly linear in the means. Windows in which the current is near zero, where brushes are no constant drop, are left
//! out. The periods are averaged first, so that the noise of the current biases R less.
//!
//! Identifiability: while the motor overcomes friction alone, its current is `a sgn(ω) + b ω`, a combination of the
//! columns for V_b and Ke. R shows only where the current varies apart from speed: under gravity, and in reversals, where
//! it turns inertia. Where neither is strong, take R as known ([`Resistance::Known`]).
//!
//! Reference: P. I. Corke, "In situ measurement of robot motor electrical constants", Robotica 14(4), 1996.

use nalgebra::{DMatrix, DVector};

use super::error::CalibrationError;
use crate::estimation::Measured;
use crate::experiment::{Recording, Transmission};
use crate::linalg::{LeastSquares, LeastSquaresError};
use crate::model::{EffortInterface, JointKind, MotorCircuit, Robot};

/// Length of a window, s.
const WINDOW_S: f64 = 0.05;

/// Least current of a window in which the drop over the brushes is taken as constant, A.
const LEAST_CURRENT: f64 = 5.0 * MotorCircuit::BRUSH_CURRENT;

/// The assumed resistance of the armature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resistance {
    /// Estimated with the torque constant.
    Estimated,
    /// Known, Ω.
    Known(f64),
}

/// Speed and back-EMF of a motor in one window.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BackEmfPoint {
    /// Mean speed of the motor's shaft, rad/s.
    pub speed: f64,
    /// Mean voltage minus the drops over resistance, inductance and brushes, V.
    pub voltage: f64,
}

/// The electrical constants of one motor.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BackEmf {
    /// Torque constant, N·m/A, equal to the back-EMF constant in V·s/rad.
    pub torque_constant: Measured,
    /// Resistance, Ω; `None` where it was taken as known.
    pub resistance: Option<Measured>,
    /// Inductance, H.
    pub inductance: Measured,
    /// Drop over the brushes, V.
    pub brush_drop: Measured,
    /// RMS residual of the circuit equation in a window, V.
    pub residual_rms: f64,
    /// Condition number of the equations with columns of unit length.
    pub condition_scaled: f64,
    /// Periods that were averaged.
    pub periods: usize,
    /// The windows.
    pub points: Vec<BackEmfPoint>,
}

/// Measures the constants of the motor of `joint` (from zero) on the recorded periods.
///
/// # Errors
/// [`CalibrationError`] where the recording has no voltages, no currents or no whole period, or where the motion does not
/// separate the constants.
pub fn back_emf(
    recording: &Recording,
    robot: &Robot,
    joint: usize,
    resistance: Resistance,
) -> Result<BackEmf, CalibrationError> {
    let mean = MeanPeriod::new(recording, robot, joint)?;
    let length = ((WINDOW_S * recording.rate_hz).round() as usize).max(2);
    let seconds = length as f64 / recording.rate_hz;
    let gear = robot.joints()[joint].drive.gear;
    // Rows: speed, sign of the current, slope of the current, current, voltage.
    let mut windows: Vec<[f64; 5]> = Vec::new();
    let mut begin = 0;
    while begin + length < mean.current.len() {
        let current = &mean.current[begin..=begin + length];
        let sign = current[0].signum();
        if current.iter().all(|i| sign * i > LEAST_CURRENT) {
            let over = |values: &[f64]| trapezium(&values[begin..=begin + length]);
            let speed = gear * (mean.q[begin + length] - mean.q[begin]) / seconds;
            let slope = (current[length] - current[0]) / seconds;
            windows.push([speed, sign, slope, over(&mean.current), over(&mean.voltage)]);
        }
        begin += length;
    }
    let estimated = resistance == Resistance::Estimated;
    let columns = if estimated { 4 } else { 3 };
    if windows.len() < 4 * columns {
        let quantity = "windows of 50 ms with a current that is not near zero";
        return Err(CalibrationError::unfit(quantity, windows.len(), "at least 16; drive the joint longer"));
    }
    let known = match resistance {
        Resistance::Estimated => 0.0,
        Resistance::Known(ohm) => ohm,
    };
    let w = DMatrix::from_fn(windows.len(), columns, |k, column| windows[k][column]);
    let y = DVector::from_iterator(windows.len(), windows.iter().map(|row| row[4] - known * row[3]));
    let fit = LeastSquares::solve(&w, &y).map_err(|fault| CalibrationError::NotExcited {
        parameter: match fault {
            LeastSquaresError::Dependent { column: 3, .. } => "the resistance",
            LeastSquaresError::Dependent { column: 1, .. } => "the brushes",
            _ => "the torque constant",
        },
        fault,
    })?;
    let residual = &y - &w * fit.solution();
    let freedom = (windows.len() - columns) as f64;
    let variance = residual.norm_squared() / freedom;
    let information = fit.inverse_information();
    let measured = |column: usize| {
        let std = (variance * information[(column, column)]).sqrt();
        Measured::new(fit.solution()[column], std, freedom)
    };
    let (drop, inductance) = (measured(1), measured(2));
    let ohm = if estimated { fit.solution()[3] } else { known };
    let points = windows.iter().map(|&[speed, sign, slope, current, voltage]| BackEmfPoint {
        speed,
        voltage: voltage - ohm * current - drop.value * sign - inductance.value * slope,
    });
    Ok(BackEmf {
        torque_constant: measured(0),
        resistance: estimated.then(|| measured(3)),
        inductance,
        brush_drop: drop,
        residual_rms: (residual.norm_squared() / windows.len() as f64).sqrt(),
        condition_scaled: fit.condition_scaled(),
        periods: recording.periods(),
        points: points.collect(),
    })
}

/// Mean of a sampled function over its interval by the trapezium rule.
fn trapezium(values: &[f64]) -> f64 {
    let last = values.len() - 1;
    (values[1..last].iter().sum::<f64>() + 0.5 * (values[0] + values[last])) / last as f64
}

/// One motor over the mean of the recorded periods.
struct MeanPeriod {
    /// Motor coordinate after the gear, rad.
    q: Vec<f64>,
    current: Vec<f64>,
    voltage: Vec<f64>,
}

impl MeanPeriod {
    fn new(recording: &Recording, robot: &Robot, joint: usize) -> Result<Self, CalibrationError> {
        let n = recording.dof;
        if robot.dof() != n || joint >= n {
            return Err(CalibrationError::unfit("joint", joint + 1, "one that robot and recording have"));
        }
        if recording.effort_unit != EffortInterface::Current {
            return Err(CalibrationError::unfit("effort", recording.effort_unit.name(), "motor currents"));
        }
        if robot.joints()[joint].kind != JointKind::Revolute {
            return Err(CalibrationError::unfit("joint", "a sliding one", "a motor whose speed is in rad/s"));
        }
        if recording.voltage.len() != recording.len() * n {
            return Err(CalibrationError::NoVoltage);
        }
        let periods = recording.periods();
        if periods == 0 {
            return Err(CalibrationError::unfit("recorded periods", "none", "at least one"));
        }
        let transmission = Transmission::new(robot);
        let samples = recording.period_samples;
        let mut mean = Self { q: vec![0.0; samples], current: vec![0.0; samples], voltage: vec![0.0; samples] };
        let mut motors = vec![0.0; n];
        let share = 1.0 / periods as f64;
        for period in 0..periods {
            for (to, k) in recording.period(period).enumerate() {
                transmission.motor_motion(recording.q(k), &mut motors);
                mean.q[to] += share * motors[joint];
                mean.current[to] += share * recording.effort(k)[joint];
                mean.voltage[to] += share * recording.voltage(k)[joint];
            }
        }
        Ok(mean)
    }
}
