//! `armid validate`

use std::fmt::Write;
use std::path::PathBuf;

use armid::estimation::{Model, TorqueResidual, Validation};
use armid_io::log::HeldOut;
use armid_io::{Error, Inputs, ProcessedLog, Text, estimate};
use miette::Result;
use serde_json::{Value, json};

use crate::answers::estimate::left_out;
use crate::answers::findings::paragraph;
use crate::answers::labels::{joint_names, percent};
use crate::arguments::LogArguments;
use crate::terminal::{Align, Answer, Console, Ending, Table, number};

const AFTER_HELP: &str = "\
The verdict is `passed` (exit 0) where every joint's difference, as a share of its measured
effort's RMS, is within --limit, and `failed` (exit 1) otherwise. It is taken over the rows that
would be used for a fit: those where the joint moves faster than 2 % of its top speed and no channel
is faulty. The shares over all rows and in total, below a fixed --bandwidth-hz, are listed beside it.
Robot, mapping and processing are those of the estimate unless others are given; its paths are looked for
from the current folder, then beside E.json. A log of the fit itself is remarked upon: it validates nothing.
A URDF or MJCF in the place of an estimate is predicted with as it is, with its own inertias, damping,
friction and armature; --base-link and --tip-link say which chain of it moves.

Examples:
  armid validate E.json other.mcap
  armid validate E.json log.csv --robot crs-a460 --period 10 --limit 0.05 --json
  armid validate arm.urdf log.csv --map \"t=time_ms ms, q=pos_[1-6] deg, tau=torque_[1-6]\"";

/// Predict the efforts of a recording that was not used for the estimate
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The estimate, a JSON file of `armid identify`, or a model: a URDF or MJCF
    estimate: PathBuf,
    /// The logs: MCAP, tables, or TOML files with a [log] table
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Largest difference that passes, as a share of the measured RMS
    #[arg(long, default_value_t = 0.1)]
    limit: f64,
    #[command(flatten)]
    log: LogArguments,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    if !(arguments.limit.is_finite() && arguments.limit > 0.0) {
        return Err(Error::new(format!("--limit is {}, expected a number above zero", arguments.limit)).into());
    }
    let text = Text::read(&arguments.estimate)?;
    if text.content.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        return validate_model(arguments, &text.name, console);
    }
    let estimates = estimate::parse_all(&text)?;
    let inputs = Inputs::of_estimate(&text)?;
    let (prepared, now) = arguments.log.process(&arguments.logs, inputs.as_ref(), HeldOut::Nothing, None)?;
    let of_the_fit = inputs.as_ref().and_then(|inputs| inputs.shared_file(&now)).map(|file| {
        format!(
            "{} is the log of the fit (the same SHA-256), so that this is no validation: another log is one, or what \
             `armid identify --held-out` keeps aside",
            file.path
        )
    });
    let remarks: Vec<String> = of_the_fit.into_iter().collect();
    if let Some(inputs) = inputs.filter(|inputs| inputs.robot.name.is_some() && inputs.robot.name == now.robot.name) {
        inputs.check_robot(&prepared.robot, &text.name)?;
    }
    let mut verdicts = Vec::new();
    for estimate in &estimates {
        let validation = prepared.validate(estimate, &text.name)?;
        let (residual, _) = prepared.residual(estimate, &text.name)?;
        let (by, limit, remarks) = (estimate.estimator.as_str(), arguments.limit, remarks.as_slice());
        verdicts.push(Verdict { by, prepared: &prepared, validation, residual, limit, remarks });
    }
    deliver(&verdicts, console)
}

/// The same of a model file, which is its own robot unless another one reads the log.
fn validate_model(arguments: &Arguments, name: &str, console: &Console) -> Result<Ending> {
    let loaded = arguments.log.model(name)?;
    let Some(parameters) = &loaded.own else {
        return Err(Error::new(format!("{name} states no inertias, expected a URDF or MJCF that does")).into());
    };
    let log = arguments.log.clone().with_robot(name);
    let (prepared, _) = log.process(&arguments.logs, None, HeldOut::Nothing, None)?;
    let model = Model { robot: &loaded.robot, parameters };
    let validation = prepared.validate_model(&model, name)?;
    let (residual, _) = prepared.model_residual(&model, name)?;
    let (limit, remarks) = (arguments.limit, loaded.remarks.as_slice());
    deliver(&[Verdict { by: name, prepared: &prepared, validation, residual, limit, remarks }], console)
}

fn deliver(verdicts: &[Verdict<'_>], console: &Console) -> Result<Ending> {
    let json = match verdicts {
        [one] => one.json(),
        several => several.iter().map(Verdict::json).collect(),
    };
    let answer = Answer { text: verdicts.iter().map(Verdict::text).collect(), json };
    console.answer(&answer)?;
    Ok(if verdicts.iter().all(Verdict::passed) { Ending::Done } else { Ending::Negative })
}

struct Verdict<'a> {
    /// The estimator, or the file of a model.
    by: &'a str,
    prepared: &'a ProcessedLog,
    validation: Validation,
    residual: TorqueResidual,
    limit: f64,
    /// What else is to be known of the logs.
    remarks: &'a [String],
}

impl Verdict<'_> {
    fn passed(&self) -> bool {
        self.validation.is_within(self.limit)
    }

    const fn word(passed: bool) -> &'static str {
        if passed { "passed" } else { "failed" }
    }

    fn json(&self) -> Value {
        json!({
            "estimator": self.by,
            "robot": self.prepared.robot.robot.name(),
            "recording": self.prepared.name(),
            "rms": self.validation.rms,
            "units": self.validation.units,
            "relative_rms": self.validation.relative_rms,
            "limit": self.limit,
            "residual": self.residual,
            "logs": self.prepared.reports,
            "remarks": self.remarks,
            "verdict": Self::word(self.passed()),
        })
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{} by {}: {} (limit {} %)\n\n",
            self.prepared.name(),
            self.by,
            Self::word(self.passed()),
            number(100.0 * self.limit)
        );
        for remark in self.remarks {
            let _ = writeln!(text, "{}", paragraph(remark, 2));
        }
        let mut table = Table::new(&[
            ("joint", Align::Left),
            ("difference RMS", Align::Right),
            ("", Align::Left),
            ("of the measured", Align::Right),
            ("", Align::Left),
            ("below the bandwidth", Align::Right),
            ("on all rows", Align::Right),
        ]);
        for (i, joint) in joint_names(self.prepared).into_iter().enumerate() {
            let share = self.validation.relative_rms[i];
            table.row([
                joint,
                number(self.validation.rms[i]),
                self.validation.units[i].clone(),
                format!("{:.2} %", 100.0 * share),
                Self::word(share <= self.limit).to_owned(),
                percent(self.residual.used.share[i]),
                percent(self.residual.all.share[i]),
            ]);
        }
        let total = [percent(self.residual.used.total), percent(self.residual.all.total)];
        table.row(["total", "", "", "", "", &total[0], &total[1]]);
        let _ = write!(
            text,
            "{}\n  the bandwidth is {} Hz\n{}",
            table.render(2),
            number(self.residual.bandwidth_hz),
            left_out(self.prepared)
        );
        text
    }
}
