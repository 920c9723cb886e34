//! `armid validate`

use std::fmt::Write;
use std::path::PathBuf;

use armid_io::log::HeldOut;
use armid_io::{Error, Inputs, ProcessedLog, Text, estimate};
use armid_workflow::numbers::{number, percent};
use armid_workflow::{ValidationVerdict, validate, validate_model};
use miette::Result;

use crate::answers::estimate::left_out;
use crate::answers::findings::paragraph;
use crate::arguments::LogArguments;
use crate::terminal::{Answer, Console, Ending, Table, Watch};

const AFTER_HELP: &str = "\
The verdict is `passed` (exit 0) if every joint's error is within --limit of its measured RMS, else `failed` (exit 1). \
The log of the fit is `not a validation` (exit 0). Rows that a fit would use count; errors on all rows are listed. \
Mapping and processing are the estimate's. A URDF or MJCF predicts with its own parameters.

Examples:
  armid validate E.json other.mcap
  armid validate E.json log.csv --robot crs-a460 --period 10 --limit 0.05 --json
  armid validate arm.urdf log.csv --map \"t=time_ms ms, q=pos_[1-6] deg, tau=torque_[1-6]\"";

/// Predict the efforts of a recording that was not used for the estimate
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// An estimate (JSON of `armid identify`), or a URDF or MJCF
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
    let text = Text::read(&arguments.estimate)?;
    let (name, limit, watch) = (&text.name, arguments.limit, Watch::new(console));
    let (answer, log) = if text.content.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        // A model file is its own robot unless another one reads the log.
        let model = arguments.log.model(name)?;
        let (log, _) = arguments.log.clone().with_robot(name).process(&arguments.logs, None, HeldOut::Nothing)?;
        (validate_model(&model, name, &log, limit, &watch)?, log)
    } else {
        let estimates = estimate::parse_all(&text)?;
        let inputs = Inputs::of_estimate(&text)?;
        let (log, now) = arguments.log.process(&arguments.logs, inputs.as_ref(), HeldOut::Nothing)?;
        let inputs = [inputs.as_ref(), Some(&now)];
        (validate(&estimates, name, &log, inputs, limit, &watch)?, log)
    };
    let text = answer.verdicts.iter().map(|verdict| verdict_text(verdict, &log, console.global.verbose)).collect();
    console.answer(&Answer { text, json: serde_json::to_value(&answer).map_err(Error::new)? })?;
    Ok(if answer.passed() { Ending::Done } else { Ending::Negative })
}

fn verdict_text(of: &ValidationVerdict, log: &ProcessedLog, verbose: bool) -> String {
    let is_own = of.log_of_fit.is_some();
    let verdict = if is_own && of.verdict == "failed" { "not a validation, and failed" } else { of.verdict };
    let mut text = format!("{} by {}: {verdict} (limit {} %)\n\n", of.recording, of.by, number(100.0 * of.limit));
    for remark in &of.remarks {
        let _ = writeln!(text, "{}", paragraph(remark, 2));
    }
    let (validation, residual) = (&of.validation, &of.residual);
    let below = number(residual.bandwidth_hz);
    let mut table =
        Table::of(&format!("joint | #difference RMS |  | #of the measured |  | #below {below} Hz | #on all rows"));
    for (i, joint) in log.joint_names().into_iter().enumerate() {
        let share = validation.relative_rms[i];
        table.row([
            joint,
            number(validation.rms[i]),
            validation.units[i].clone(),
            format!("{:.2} %", 100.0 * share),
            match share <= of.limit {
                true if is_own => "",
                true => "passed",
                false => "failed",
            }
            .to_owned(),
            percent(residual.used.share[i]),
            percent(residual.all.share[i]),
        ]);
    }
    let total = [percent(residual.used.total), percent(residual.all.total)];
    table.row(["total", "", "", "", "", &total[0], &total[1]]);
    text + &table.render(2) + "\n" + &left_out(log, verbose)
}
