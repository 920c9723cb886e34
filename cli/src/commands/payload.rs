//! `armid identify --payload`

use std::path::{Path, PathBuf};

use armid::base::{Method, reduce};
use armid::estimation::{Estimate, EstimatorKind, payload};
use armid::model::Columns;
use armid::seed::Seed;
use armid_io::estimate::{self, check_robot};
use armid_io::log::HeldOut;
use armid_io::output::{self, pretty};
use armid_io::{Error, Inputs, LoadedRobot, Text};
use miette::Result;

use crate::answers::payload::PayloadAnswer;
use crate::arguments::LogArguments;
use crate::terminal::{Answer, Console, Ending};

/// The logs of the arm without and with its load.
pub(super) struct PayloadLogs<'a> {
    pub(super) without: &'a [PathBuf],
    pub(super) with: &'a [PathBuf],
    pub(super) log: &'a LogArguments,
}

/// An estimate of one of the two, where it came from, and its robot where a log gave it.
struct Side {
    estimate: Estimate,
    name: String,
    inputs: Option<Inputs>,
    robot: Option<LoadedRobot>,
}

pub(super) fn run(
    logs: &PayloadLogs<'_>,
    columns: Columns,
    estimators: &[EstimatorKind],
    console: &Console,
) -> Result<Ending> {
    let [estimator] = estimators else {
        return Err(Error::new("--payload takes one estimator, found several").into());
    };
    let without = match logs.without {
        [one] if one.extension().is_some_and(|extension| extension == "json") => of_estimate(one)?,
        several => of_logs(logs.log, several, None, columns, *estimator)?,
    };
    // Robot, mapping and processing are those of the estimate where nothing else is said.
    let columns = columns_of(&without)?;
    let with = of_logs(logs.log, logs.with, Some(&without), columns, *estimator)?;
    if let (Some(one), Some(other)) = (&without.inputs, &with.inputs)
        && let Some(file) = one.shared_file(other)
    {
        let message = format!(
            "{} with the load is {} without it (the same SHA-256), expected two recordings",
            file.path, without.name
        );
        return Err(Error::mismatch(message).help("record one log with the load and one without it").into());
    }
    let loaded = with.robot.as_ref().or(without.robot.as_ref());
    let Some(loaded) = loaded else { return Err(Error::new("no robot is named, expected --robot ROBOT").into()) };
    check_robot(&without.estimate, &without.name, loaded)?;
    let base = reduce(&loaded.robot, columns, Method::Structural, Seed::new(0))
        .map_err(|error| Error::new(format!("robot \"{}\": {error}", loaded.robot.name())))?;
    let found = payload(&base, &without.estimate, &with.estimate).map_err(|error| {
        let help = "both logs must move every joint; `armid design` makes a motion that does";
        Error::new(format!("{}, {}: {error}", without.name, with.name)).help(help)
    })?;
    let answer = PayloadAnswer {
        found: &found,
        robot: &loaded.robot,
        sides: [(&without.name, without.inputs.as_ref()), (&with.name, with.inputs.as_ref())],
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
    let sound = found.body.termination.was_successful() && found.body.is_within() && answer.is_of_a_load();
    Ok(if sound { Ending::Done } else { Ending::Negative })
}

fn columns_of(side: &Side) -> Result<Columns> {
    Columns::parse(&side.estimate.columns).ok_or_else(|| {
        let message = format!(
            "{}: the set of columns is \"{}\", expected one that --columns takes",
            side.name, side.estimate.columns
        );
        Error::new(message).into()
    })
}

/// An estimate that is there already.
fn of_estimate(path: &Path) -> Result<Side> {
    let text = Text::read(path)?;
    let estimate = estimate::parse(&text)?;
    let inputs = Inputs::of_estimate(&text)?;
    Ok(Side { estimate, name: text.name, inputs, robot: None })
}

/// An estimate from logs; where there is one of the `other` logs, with the shape parameters of friction of that.
fn of_logs(
    log: &LogArguments,
    paths: &[PathBuf],
    other: Option<&Side>,
    columns: Columns,
    estimator: EstimatorKind,
) -> Result<Side> {
    let remembered = other.and_then(|other| other.inputs.as_ref());
    let (mut prepared, inputs) = log.process(paths, remembered, HeldOut::Nothing, None)?;
    match other {
        Some(other) => prepared.take_shape(&other.estimate, &other.name)?,
        None if prepared.has_no_periods() => {
            prepared.find_onset(columns)?;
        }
        None => {}
    }
    let estimate = prepared.identify(columns, estimator)?;
    let name = prepared.name();
    Ok(Side { estimate, name, inputs: Some(inputs), robot: Some(prepared.robot) })
}
