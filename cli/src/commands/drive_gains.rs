//! `armid identify --drive-gains`

use std::path::PathBuf;

use armid::model::Columns;
use armid::spatial::Inertia;
use armid_io::Error;
use armid_io::log::HeldOut;
use armid_workflow::drive_gains;
use miette::Result;

use crate::answers::drive_gains::DriveGainsText;
use crate::arguments::LogArguments;
use crate::terminal::{Answer, Console, Ending, Watch};

pub(super) fn run(
    [without, with]: [&[PathBuf]; 2],
    log: &LogArguments,
    columns: Columns,
    load: &Inertia,
    console: &Console,
) -> Result<Ending> {
    let (without, inputs) = log.process(without, None, HeldOut::Nothing)?;
    let (with, inputs_with) = log.process(with, Some(&inputs), HeldOut::Nothing)?;
    let answer = drive_gains((without, inputs), (&with, inputs_with), columns, load, &Watch::new(console))?;
    let json = serde_json::to_value(&answer).map_err(Error::new)?;
    console.deliver_json(&Answer { text: DriveGainsText(&answer).text(), json })?;
    Ok(if answer.is_sound() { Ending::Done } else { Ending::Negative })
}
