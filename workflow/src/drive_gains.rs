//! Which torque constants do the drives have, or which stiffness the servos, by a known load?

use armid::estimation::{
    BaseEstimate, DriveGain, DriveGains, Estimate, EstimationError, EstimationProblem, EstimatorKind, GainMethod,
    drive_gains as drive_gains_of, gain_slopes,
};
use armid::model::{Columns, Robot};
use armid::observer::Observer;
use armid::remedy::{Remedy, Setting, Task};
use armid::spatial::Inertia;
use armid_io::log::EffortScale;
use armid_io::{Error, Inputs, ProcessedLog};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

use crate::payload::check_apart;

/// What helps where a gain is not shown.
fn more() -> Remedy {
    let help = Remedy::from("a load further from the axes, a heavier one, or more motion shows more: ");
    let help = help.perform(Task::Design, "ROBOT").option(Setting::Payload, "KG").say(" makes a motion for it; ");
    help.perform(Task::CalibrateTorqueConstant, "").say(" needs no load")
}

/// The torque constants of all drives, and everything that is said of them. It serialises to the keys of the command's answer.
#[derive(Clone, Debug)]
pub struct DriveGainsAnswer {
    /// The robot.
    pub robot: Robot,
    /// The load about the origin of the last link's frame.
    pub load: Inertia,
    /// The constants by which currents became torques, N·m/A, or commands, N·m/rad.
    pub constants: Vec<f64>,
    /// Which of these they are.
    pub scale: EffortScale,
    /// By every method.
    pub found: Vec<DriveGains>,
    /// The base parameters by the stated constants, without the load.
    pub stated: Estimate,
    /// How each of them follows the gains, ∂β/∂ ln κ, b of n.
    pub moved: Vec<Vec<f64>>,
    /// The logs without the load, and what they were made from.
    pub without: (String, Inputs),
    /// The logs with the load, and what they were made from.
    pub with: (String, Inputs),
}

/// The torque constants, or the stiffness of servos, by two logs of one arm, without and with a load of known parameters.
///
/// # Errors
/// [`Error`] where the logs hold torques, are one recording or state unlike constants, where several motors drive a joint, or where
/// the equations have no answer; of [`armid_io::ErrorKind::Interrupted`] where the observer ended the search for the onset of friction.
pub fn drive_gains(
    (mut without, inputs): (ProcessedLog, Inputs),
    (with, inputs_with): (&ProcessedLog, Inputs),
    columns: Columns,
    load: &Inertia,
    observer: &dyn Observer,
) -> Result<DriveGainsAnswer, Error> {
    let (scale, constants) = scale([&without, with], [&inputs, &inputs_with])?;
    if without.has_no_periods() {
        without.find_onset(columns, observer)?;
    }
    let observations = without.gain_equations(with, columns, load)?;
    let named =
        |error: EstimationError| Error::new(format!("{}, {}: {error}", without.name(), with.name())).help(more());
    let [first, second] = &observations;
    let found = GainMethod::ALL.iter().map(|&method| drive_gains_of(first, second, load, method));
    let found = found.collect::<Result<Vec<_>, _>>().map_err(named)?;
    let stated = EstimatorKind::Wls.estimator().estimate(&EstimationProblem::new(first)).map_err(named)?;
    let moved = gain_slopes(first).map_err(named)?;
    Ok(DriveGainsAnswer {
        robot: without.robot.robot.clone(),
        load: *load,
        constants,
        scale,
        found,
        stated,
        moved: moved.row_iter().map(|row| row.iter().copied().collect()).collect(),
        without: (without.name(), inputs),
        with: (with.name(), inputs_with),
    })
}

/// The constants by which both sides' efforts became torques, where these are two logs of one arm whose motors each drive a joint.
fn scale([without, with]: [&ProcessedLog; 2], [first, second]: [&Inputs; 2]) -> Result<(EffortScale, Vec<f64>), Error> {
    check_apart((&without.name(), Some(first)), Some(second))?;
    let robot = &without.robot.robot;
    if let Some(joint) = (0..robot.dof()).find(|&joint| robot.is_coupled(joint)) {
        let message = format!(
            "joint \"{}\" is driven by several motors, expected one motor for each joint: its torque has no gain of its own",
            robot.joints()[joint].name
        );
        let help = Remedy::task(Task::CalibrateTorqueConstant, "").say(" measures each motor's by its back-EMF");
        return Err(Error::new(message).help(help));
    }
    let (stated, again) = (without.stated_scale()?, with.stated_scale()?);
    if stated != again {
        let message = format!("{} states other torque constants than {}", with.name(), without.name());
        return Err(
            Error::mismatch(message).help(Remedy::set(Setting::Robot, "ROBOT").say(" is one robot file for both"))
        );
    }
    Ok(stated)
}

impl DriveGainsAnswer {
    /// The result that has no bias by the noise of the currents, and so has intervals.
    pub fn taken(&self) -> &DriveGains {
        self.found.iter().find(|found| found.method == GainMethod::Total).unwrap_or(&self.found[0])
    }

    /// Whether every gain was found.
    pub fn is_sound(&self) -> bool {
        let converged = self.found.iter().all(|found| found.termination.was_successful());
        converged && self.taken().hidden_joints().is_empty()
    }

    /// Name of a joint.
    pub fn joint(&self, joint: usize) -> &str {
        &self.robot.joints()[joint].name
    }

    /// The constant of a joint by a gain.
    pub fn constant(&self, joint: usize, gain: &DriveGain) -> DriveGain {
        let stated = self.constants[joint];
        let ci95 = gain.ci95.map(|ends| ends.map(|end| stated * end));
        DriveGain { value: stated * gain.value, std: gain.std.map(|std| stated * std), ci95 }
    }

    /// The lines that state the constants that were found; none where one was not.
    pub fn corrected(&self) -> Option<String> {
        let taken = self.taken();
        if !taken.hidden_joints().is_empty() {
            return None;
        }
        let value = |(joint, gain): (usize, &DriveGain)| format!("{:.6}", self.constant(joint, gain).value);
        let values: Vec<String> = taken.gains.iter().enumerate().map(value).collect();
        if self.scale != EffortScale::RobotConstant {
            return Some(format!("{}={}", self.scale.key(), values.join("/")));
        }
        let line = |(joint, value): (usize, &String)| {
            format!("torque_constant_nm_a = {value}  # joint \"{}\", was {}", self.joint(joint), self.constants[joint])
        };
        Some(values.iter().enumerate().map(line).collect::<Vec<_>>().join("\n"))
    }
}

impl Serialize for DriveGainsAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let taken = self.taken();
        let [key, stated] = self.scale.answer_keys();
        let by = |joint: usize| -> Map<String, Value> {
            let of = |found: &DriveGains| {
                let gain = &found.gains[joint];
                (found.method.name().to_owned(), json!({ "ratio": gain, key: self.constant(joint, gain) }))
            };
            self.found.iter().map(of).collect()
        };
        let joint =
            |joint: usize| json!({ "joint": self.joint(joint), stated: self.constants[joint], "by": by(joint) });
        let parameter = |(row, parameter): (usize, &BaseEstimate)| {
            json!({
                "name": parameter.name,
                "unit": parameter.unit,
                "by_stated_constants": parameter.value,
                "std": parameter.std,
                "by_found_constants": taken.beta[row],
                "moved_per_unit_of_gain": self.moved[row],
            })
        };
        let method = |found: &DriveGains| {
            json!({
                "method": found.method,
                "degrees_of_freedom": found.degrees_of_freedom,
                "termination": found.termination,
            })
        };
        let names = |which: Vec<usize>| which.into_iter().map(|joint| self.joint(joint).to_owned()).collect::<Vec<_>>();
        json!({
            "robot": self.robot.name(),
            "without": self.without.0,
            "with": self.with.0,
            "load": { "mass_kg": self.load.mass, "parameters": self.load.to_array() },
            "taken": taken.method,
            "methods": self.found.iter().map(method).collect::<Value>(),
            "joints": (0..self.robot.dof()).map(joint).collect::<Value>(),
            "wrong": names(taken.wrong_joints()),
            "not_shown": names(taken.hidden_joints()),
            "base": self.stated.base.iter().enumerate().map(parameter).collect::<Value>(),
            "corrected": self.corrected(),
            "inputs": { "without": self.without.1, "with": self.with.1 },
        })
        .serialize(serializer)
    }
}
