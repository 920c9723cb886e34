//! `armid identify`

use std::path::PathBuf;

use armid::estimation::{EstimatorKind, FrictionSpeeds, candidate_terms};
use armid::model::Columns;
use armid_io::Error;
use armid_io::log::HeldOut;
use armid_workflow::identification::{IdentifySettings, identify};
use miette::Result;
use serde_json::json;

use super::{drive_gains, payload};
use crate::answers::estimate::estimate_text;
use crate::answers::friction_speed::{onset_text, speeds_text};
use crate::answers::selection::selection_text;
use crate::answers::transmission::transmission_text;
use crate::arguments::{KnownLoadArguments, LogArguments, columns, estimator, read_parameter_map};
use crate::terminal::{Answer, Console, Ending, Table, Watch};

const AFTER_HELP: &str = "\
A log is a recording of `armid run`, ROS 2 joint states, a table, or a TOML with a [log] table. Headings \
t,q1..qn and tau1..taun or current1..currentn need no --map (`armid help map`). The last fifth of a third-\
party log is kept for validation. A mistake in the log is named with its correction, and the exit status is \
1.

Examples:
  armid identify R.mcap -o E.json
  armid identify R.mcap --estimator ols,wls --json
  armid identify log.csv --robot crs-a460 --period 10 --from 3 -o E.json
  armid identify log.csv --robot arm.urdf --map \"t=time_ms, q=pos_[1-6] deg, tau=torque_[1-6]\"
  armid identify log.npz --robot arm.urdf --map \"t=time, q=pos deg, tau=torque_[0-2]/-/torque_[4-5]\"
  armid identify pos.csv cur.csv --robot arm.toml --rate 1000 --map \"q=pos:j[1-6], current=cur:j[1-6]\"
  armid identify bag --robot arm.urdf --map \"topic=/arm/joint_states, q=joint[1-6], tau=joint[1-6] motor\"
  armid identify a.csv b.csv --robot crs-a460 --held-out c.csv -o E.json
  armid identify log.csv --robot arm.toml --map \"t=t, q=motor_[1-6] motor, q_link=link_[1-6], tau=torque_[1-6]\"
  armid identify R.mcap --select -o E.json
  armid identify R.mcap --select=rigid+rotor+friction+stribeck --held-out other.mcap
  armid identify R.mcap --columns rigid+rotor+friction+stribeck --stribeck-speed
  armid identify --payload --without empty.csv --with loaded.csv --robot arm.urdf -o P.json
  armid identify --payload --without E.json --with loaded.csv
  armid identify --drive-gains --without A.mcap --with B.mcap --payload-mass 1 --payload-centre 0,0,0.06
  armid identify --list";

/// What `--select` without a list means.
const ALL_TERMS: &str = "all";

/// Reads the terms to select from; those that are no columns, since they depend on more than the motion, are tested beside the others.
fn candidates(text: &str) -> Result<Columns, Error> {
    if text == ALL_TERMS {
        return Ok(candidate_terms().into_iter().fold(Columns::RIGID, Columns::with_term));
    }
    if let Some(columns) = Columns::parse_among(text, &candidate_terms()) {
        return Ok(columns);
    }
    columns(text).map_err(|fault| Error::new(format!("--select={text}: {fault}")))
}

/// Estimate the parameters from a recording
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP, group = clap::ArgGroup::new("of_two").args(["payload", "drive_gains"]))]
pub(crate) struct Arguments {
    /// Logs: MCAP, bags, tables, LeRobot folders, or TOML files that describe them
    #[arg(required_unless_present_any = ["list", "payload", "drive_gains"], conflicts_with = "of_two", value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Estimate the payload, from logs without and with it
    #[arg(long, requires_all = ["without", "with"], conflicts_with = "held_out", help_heading = "Payload")]
    payload: bool,
    /// Estimate all torque constants, from logs without and with a known payload
    #[arg(long, requires_all = ["without", "with"], conflicts_with_all = ["held_out", "estimator"], help_heading = "Payload")]
    drive_gains: bool,
    /// Logs without the payload; with --payload also an estimate
    #[arg(long, value_name = "LOG|E.json", num_args = 1.., requires = "of_two", help_heading = "Payload")]
    without: Vec<PathBuf>,
    /// Logs with the payload
    #[arg(long, value_name = "LOG", num_args = 1.., requires = "of_two", help_heading = "Payload")]
    with: Vec<PathBuf>,
    #[command(flatten)]
    known_load: KnownLoadArguments,
    /// List the estimators
    #[arg(long)]
    list: bool,
    /// One estimator, or several with commas between them
    #[arg(long, value_delimiter = ',', default_value = "wls", value_parser = estimator())]
    estimator: Vec<EstimatorKind>,
    /// Which parameters are estimated
    #[arg(long, default_value = "rigid+rotor+friction", value_parser = columns)]
    columns: Columns,
    /// Short for --columns rigid
    #[arg(long, conflicts_with = "columns")]
    no_friction: bool,
    /// Select the torque terms that the data support, among all or COLUMNS
    #[arg(long, value_name = "COLUMNS", num_args = 0..=1, require_equals = true, default_missing_value = ALL_TERMS,
        conflicts_with_all = ["columns", "no_friction", "of_two"])]
    select: Option<String>,
    /// Estimate the Stribeck velocity of each joint
    #[arg(long, conflicts_with_all = ["select", "no_friction", "of_two"])]
    stribeck_speed: bool,
    /// Onset speed of Coulomb friction: from the log or the robot file
    #[arg(long, value_name = "WHICH", value_parser = ["found", "stated"], conflicts_with_all = ["no_friction", "of_two"])]
    onset_speed: Option<String>,
    /// Data kept for validation: a share (30%), none, or another log
    #[arg(long, value_name = "PART|LOG", help_heading = "Logs")]
    held_out: Option<String>,
    /// Initial parameters of estimators that simulate, TOML or JSON
    #[arg(long, value_name = "P", conflicts_with = "of_two")]
    start: Option<PathBuf>,
    #[command(flatten)]
    log: LogArguments,
}

impl Arguments {
    /// What is held out, and the log where it is one of its own.
    fn held_out(&self) -> Result<(HeldOut, Option<PathBuf>), Error> {
        let Some(said) = &self.held_out else { return Ok((HeldOut::LastFifth, None)) };
        if said == "none" {
            return Ok((HeldOut::Nothing, None));
        }
        if let Some(percent) = said.strip_suffix('%') {
            return match percent.trim().parse::<f64>() {
                Ok(percent) if (0.0..=90.0).contains(&percent) => Ok((HeldOut::Share(percent / 100.0), None)),
                _ => Err(Error::new(format!("--held-out is {said}, expected 0% to 90%, none, or a log"))),
            };
        }
        let path = PathBuf::from(said);
        if !path.exists() {
            let message = format!("--held-out is {said}, expected a part such as 20%, none, or an existing log");
            return Err(Error::new(message));
        }
        Ok((HeldOut::Nothing, Some(path)))
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    if arguments.list {
        console.answer(&list())?;
        return Ok(Ending::Done);
    }
    let columns = if arguments.no_friction { Columns::RIGID } else { arguments.columns };
    let sides = [&*arguments.without, &*arguments.with];
    if arguments.payload {
        return payload::run(sides, &arguments.log, columns, &arguments.estimator, console);
    }
    if arguments.drive_gains {
        let load = arguments.known_load.load()?;
        return drive_gains::run(sides, &arguments.log, columns, &load, console);
    }
    let among = arguments.select.as_deref().map(candidates).transpose()?;
    let (held_out, other) = arguments.held_out()?;
    let of_logs = if among.is_some() { &arguments.log.for_selection() } else { &arguments.log };
    let (mut prepared, mut inputs) = of_logs.process(&arguments.logs, None, held_out)?;
    if let Some(other) = other {
        inputs.held_out_log = Some(other.display().to_string());
        let (others, _) = of_logs.process(&[other], Some(&inputs), HeldOut::Nothing)?;
        prepared.hold_out(&others);
    }
    if let Some(path) = &arguments.start {
        prepared.start = Some(read_parameter_map(path, &prepared.robot.robot)?.0);
    }
    let settings = IdentifySettings {
        columns,
        estimators: arguments.estimator.clone(),
        select: among,
        onset_speed: arguments.onset_speed.as_deref().map(|which| which == "found"),
        stribeck_speed: arguments.stribeck_speed,
        ..IdentifySettings::default()
    };
    let answer = identify(prepared, Some(inputs), &settings, &Watch::new(console))?;
    let json = serde_json::to_value(&answer).map_err(Error::new)?;
    let robot = &answer.log.robot.robot;
    let said = answer.estimates.iter().map(|of| estimate_text(&answer.log, of, console.global.verbose));
    let mut text: String = said.collect();
    text += &answer.selection.as_ref().map(selection_text).unwrap_or_default();
    let in_full = console.global.verbose || arguments.onset_speed.is_some();
    let said = |onset: &FrictionSpeeds| {
        if in_full { speeds_text(onset, robot, onset.predict_better()) } else { onset_text(onset, robot) }
    };
    text += &answer.onset.as_ref().map(said).unwrap_or_default();
    text += &answer.speeds.as_ref().map(|speeds| speeds_text(speeds, robot, true)).unwrap_or_default();
    text += &answer.transmissions.as_deref().map(transmission_text).unwrap_or_default();
    console.deliver_json(&Answer { text, json })?;
    Ok(match answer.interrupted {
        true => Ending::Interrupted,
        false if answer.is_sound() => Ending::Done,
        false => Ending::Negative,
    })
}

fn list() -> Answer {
    let mut table = Table::of("estimator | what it does");
    for kind in EstimatorKind::ALL {
        let (mut words, others) = (kind.estimator().summary().to_owned(), kind.aliases());
        if !others.is_empty() {
            words.push_str(&format!("; the same by other names: {}", others.join(", ")));
        }
        table.row([kind.name().to_owned(), words]);
    }
    let json = EstimatorKind::ALL
        .iter()
        .map(
            |kind| json!({ "name": kind.name(), "summary": kind.estimator().summary(), "other_names": kind.aliases() }),
        )
        .collect();
    Answer { text: table.render(0), json }
}
