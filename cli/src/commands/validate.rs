//! `armid validate`

use std::fmt::Write;
use std::path::PathBuf;

use armid::estimation::{Estimate, Validation, validate};
use armid::model::Columns;
use armid::regressor::JointTorqueRegressor;
use miette::Result;
use serde_json::{Value, json};

use crate::answer::{Answer, Ending};
use crate::atomic_file::read_text;
use crate::console::Console;
use crate::fault::{Fault, Text};
use crate::identification::{LogArguments, Prepared, prepare};
use crate::table::{Align, Table, number};

const AFTER_HELP: &str = "\
The verdict is `passed` (exit 0) where every joint's difference, as a share of its measured
effort's RMS, is within --limit, and `failed` (exit 1) otherwise.

Examples:
  armid validate E.json other.mcap
  armid validate E.json log.csv --robot crs-a460 --period 10 --limit 0.05 --json";

/// Predict the efforts of a recording that was not used for the estimate
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The estimate, of `armid identify`
    estimate: PathBuf,
    /// The recording: MCAP or CSV
    recording: PathBuf,
    /// Largest difference that passes, as a share of the measured RMS
    #[arg(long, default_value_t = 0.1)]
    limit: f64,
    #[command(flatten)]
    log: LogArguments,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    if !(arguments.limit.is_finite() && arguments.limit > 0.0) {
        return Err(Fault::new(format!("--limit is {}, expected a number above zero", arguments.limit)).into());
    }
    let text = read_text(&arguments.estimate)?;
    let estimates = read(&text)?;
    let prepared = prepare(&arguments.recording, &arguments.log)?;
    let mut verdicts = Vec::new();
    for estimate in &estimates {
        verdicts.push(Verdict::of(estimate, &prepared, arguments.limit, &text)?);
    }
    let json = match verdicts.as_slice() {
        [one] => one.json(),
        several => several.iter().map(Verdict::json).collect(),
    };
    let answer = Answer { text: verdicts.iter().map(Verdict::text).collect(), json };
    console.answer(&answer)?;
    Ok(if verdicts.iter().all(Verdict::passed) { Ending::Done } else { Ending::Negative })
}

/// One estimate, or the list that several estimators make.
fn read(text: &Text) -> Result<Vec<Estimate>> {
    let several = text.content.trim_start().starts_with('[');
    let read = if several {
        serde_json::from_str(&text.content)
    } else {
        serde_json::from_str(&text.content).map(|one| vec![one])
    };
    let estimates: Vec<Estimate> = read.map_err(|error| {
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        Fault::new(message).at_line(text, error.line(), error.column()).help("expected an estimate of `armid identify`")
    })?;
    Ok(estimates)
}

struct Verdict<'a> {
    estimate: &'a Estimate,
    prepared: &'a Prepared,
    validation: Validation,
    limit: f64,
}

impl<'a> Verdict<'a> {
    fn of(estimate: &'a Estimate, prepared: &'a Prepared, limit: f64, text: &Text) -> Result<Self> {
        let robot = &prepared.robot.robot;
        if estimate.robot != robot.name() {
            let message = format!("{} is of robot \"{}\", expected \"{}\"", text.name, estimate.robot, robot.name());
            return Err(Fault::new(message).into());
        }
        let columns = Columns::parse(&estimate.columns).ok_or_else(|| {
            let names = Columns::ALL.map(Columns::name).join(", ");
            Fault::new(format!("{}: columns is \"{}\", expected one of {names}", text.name, estimate.columns))
        })?;
        let regressor = JointTorqueRegressor::new(robot, columns);
        let validation = validate(estimate, &regressor, &prepared.samples)
            .map_err(|error| Fault::new(format!("{}: {error}", text.name)))?;
        Ok(Self { estimate, prepared, validation, limit })
    }

    fn passed(&self) -> bool {
        self.validation.is_within(self.limit)
    }

    const fn word(passed: bool) -> &'static str {
        if passed { "passed" } else { "failed" }
    }

    fn json(&self) -> Value {
        json!({
            "estimator": self.estimate.estimator,
            "robot": self.estimate.robot,
            "recording": self.prepared.log.name,
            "rms": self.validation.rms,
            "units": self.validation.units,
            "relative_rms": self.validation.relative_rms,
            "limit": self.limit,
            "verdict": Self::word(self.passed()),
        })
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{} by {}: {} (limit {} %)\n\n",
            self.prepared.log.name,
            self.estimate.estimator,
            Self::word(self.passed()),
            number(100.0 * self.limit)
        );
        let mut table = Table::new(&[
            ("joint", Align::Left),
            ("difference RMS", Align::Right),
            ("", Align::Left),
            ("of the measured", Align::Right),
            ("", Align::Left),
        ]);
        for (i, joint) in self.prepared.robot.robot.joints().iter().enumerate() {
            let share = self.validation.relative_rms[i];
            table.row([
                joint.name.clone(),
                number(self.validation.rms[i]),
                self.validation.units[i].clone(),
                format!("{:.2} %", 100.0 * share),
                Self::word(share <= self.limit).to_owned(),
            ]);
        }
        let _ = write!(text, "{}", table.render(2));
        text
    }
}
