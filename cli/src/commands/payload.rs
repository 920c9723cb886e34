//! `armid identify --payload`

use std::path::{Path, PathBuf};

use armid::estimation::EstimatorKind;
use armid::model::Columns;
use armid_io::log::HeldOut;
use armid_io::{Error, Inputs, LoadedRobot, Text, estimate};
use armid_workflow::{PayloadSide, columns_of, payload};
use miette::Result;

use crate::answers::payload::text;
use crate::arguments::LogArguments;
use crate::terminal::{Answer, Console, Ending, Watch};

/// From the logs of the arm without and with its load.
pub(super) fn run(
    [without, with]: [&[PathBuf]; 2],
    log: &LogArguments,
    columns: Columns,
    estimators: &[EstimatorKind],
    console: &Console,
) -> Result<Ending> {
    let [estimator] = estimators else {
        return Err(Error::new("--payload takes one estimator, found several").into());
    };
    let without = match without {
        [one] if one.extension().is_some_and(|extension| extension == "json") => of_estimate(one)?,
        several => of_logs(log, several, None, (columns, *estimator), console)?.0,
    };
    // Robot, mapping and processing are those of the estimate where nothing else is said.
    let columns = columns_of(&without.estimate, &without.name)?;
    let (with, robot) = of_logs(log, with, Some(&without), (columns, *estimator), console)?;
    let answer = payload(&robot, without, with)?;
    let json = serde_json::to_value(&answer).map_err(Error::new)?;
    console.deliver_json(&Answer { text: text(&answer), json })?;
    Ok(if answer.is_sound() { Ending::Done } else { Ending::Negative })
}

/// An estimate that is there already.
fn of_estimate(path: &Path) -> Result<PayloadSide, Error> {
    let text = Text::read(path)?;
    let estimate = estimate::parse(&text)?;
    let inputs = Inputs::of_estimate(&text)?;
    Ok(PayloadSide { estimate, name: text.name, inputs })
}

/// An estimate from logs, and their robot; where there is one of the `other` logs, with the shape parameters of friction of that.
fn of_logs(
    log: &LogArguments,
    paths: &[PathBuf],
    other: Option<&PayloadSide>,
    (columns, estimator): (Columns, EstimatorKind),
    console: &Console,
) -> Result<(PayloadSide, LoadedRobot), Error> {
    let remembered = other.and_then(|other| other.inputs.as_ref());
    let (mut prepared, inputs) = log.process(paths, remembered, HeldOut::Nothing)?;
    let side = PayloadSide::of_log(&mut prepared, Some(inputs), columns, estimator, other, &Watch::new(console))?;
    Ok((side, prepared.robot))
}
