//! `armid identify --drive-gains`

use std::path::PathBuf;

use armid::estimation::{EstimationError, EstimationProblem, EstimatorKind, GainMethod, drive_gains, moved_by_gains};
use armid::model::Columns;
use armid::spatial::Inertia;
use armid_io::log::HeldOut;
use armid_io::output::{self, pretty};
use armid_io::{Error, Inputs, ProcessedLog};
use miette::Result;

use crate::answers::drive_gains::DriveGainsAnswer;
use crate::arguments::LogArguments;
use crate::terminal::{Answer, Console, Ending};

/// What helps where a gain is not shown.
const MORE: &str = "a load further from the axes, a heavier one, or more motion shows more: `armid design ROBOT --payload KG` makes a \
                    motion for it; `armid calibrate torque-constant` needs no load";

pub(super) fn run(
    [without, with]: [&[PathBuf]; 2],
    log: &LogArguments,
    columns: Columns,
    load: &Inertia,
    console: &Console,
) -> Result<Ending> {
    let (mut without, inputs) = log.process(without, None, HeldOut::Nothing, None)?;
    let (with, inputs_with) = log.process(with, Some(&inputs), HeldOut::Nothing, None)?;
    let constants = constants([&without, &with], [&inputs, &inputs_with])?;
    if without.has_no_periods() {
        without.find_onset(columns)?;
    }
    let observations = without.gain_equations(&with, columns, load)?;
    let named = |error: EstimationError| {
        Error::new(format!("{}, {}: {error}", without.name(), with.name())).help(MORE.to_owned())
    };
    let [first, second] = &observations;
    let found = GainMethod::ALL.iter().map(|&method| drive_gains(first, second, load, method));
    let found = found.collect::<Result<Vec<_>, _>>().map_err(named)?;
    let stated = EstimatorKind::Wls.estimator().estimate(&EstimationProblem::new(first)).map_err(named)?;
    let moved = moved_by_gains(first).map_err(named)?;
    let answer = DriveGainsAnswer {
        robot: &without.robot.robot,
        load,
        constants: &constants,
        of_mapping: inputs.mapping.as_deref().is_some_and(|mapping| mapping.contains("constant=")),
        found: &found,
        stated: &stated,
        moved: moved.row_iter().map(|row| row.iter().copied().collect()).collect(),
        sides: [(without.name(), &inputs), (with.name(), &inputs_with)],
    };
    let json = answer.json();
    if console.to_standard_output() {
        console.print(&pretty(&json))?;
    }
    if let Some(path) = console.output() {
        output::write_text(path, &pretty(&json))?;
        console.note(format!("wrote {}", path.display()));
    }
    console.show(&Answer { text: answer.text(), json })?;
    Ok(if answer.is_sound() { Ending::Done } else { Ending::Negative })
}

/// The constants by which both sides' currents became torques, where these are two logs of one arm whose motors each drive a joint.
fn constants([without, with]: [&ProcessedLog; 2], [first, second]: [&Inputs; 2]) -> Result<Vec<f64>, Error> {
    if let Some(file) = first.shared_file(second) {
        let message = format!(
            "{} with the load is {} without it (the same SHA-256), expected two recordings",
            file.path,
            without.name()
        );
        return Err(Error::mismatch(message).help("record one log with the load and one without it: `armid run` does"));
    }
    let robot = &without.robot.robot;
    if let Some(joint) = (0..robot.dof()).find(|&joint| robot.is_coupled(joint)) {
        let message = format!(
            "joint \"{}\" is driven by several motors, expected one motor for each joint: its torque has no gain of its own",
            robot.joints()[joint].name
        );
        return Err(Error::new(message).help("`armid calibrate torque-constant` measures each motor's by its back-EMF"));
    }
    let (stated, again) = (without.stated_constants()?, with.stated_constants()?);
    if stated != again {
        let message = format!("{} states other torque constants than {}", with.name(), without.name());
        return Err(
            Error::mismatch(message).help("`armid identify --drive-gains --robot ROBOT` takes one robot file for both")
        );
    }
    Ok(stated)
}
