//! `armid identify`

use std::fmt::Write;
use std::path::PathBuf;

use armid::estimation::{Estimate, EstimatorKind};
use armid::model::Columns;
use armid_io::output::pretty;
use armid_io::{ProcessedLog, output};
use miette::Result;
use serde_json::{Value, json};

use crate::arguments::{LogArguments, columns, one_of};
use crate::terminal::{Align, Answer, Console, Ending, Table, number};

const AFTER_HELP: &str = "\
R.mcap is a recording of `armid run`, or any MCAP with ROS 2 joint states on /joint_states; a CSV
has the headings t,q1..qn,tau1..taun (N·m) or t,q1..qn,current1..currentn (A) and needs --robot.

Examples:
  armid identify R.mcap -o E.json
  armid identify R.mcap --estimator ols,wls --json
  armid identify log.csv --robot crs-a460 --period 10 --skip 3 -o E.json
  armid identify --list";

/// Estimate the parameters from a recording
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The recording: MCAP or CSV
    #[arg(required_unless_present = "list")]
    recording: Option<PathBuf>,
    /// List the estimators
    #[arg(long)]
    list: bool,
    /// One estimator, or several with commas between them
    #[arg(long, value_delimiter = ',', default_value = "wls", value_parser = one_of(EstimatorKind::ALL, EstimatorKind::name))]
    estimator: Vec<EstimatorKind>,
    /// What is estimated
    #[arg(long, default_value = "rigid+rotor+friction", value_parser = columns)]
    columns: Columns,
    /// Short for --columns rigid
    #[arg(long, conflicts_with = "columns")]
    no_friction: bool,
    #[command(flatten)]
    log: LogArguments,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let Some(path) = arguments.recording.as_ref().filter(|_| !arguments.list) else {
        console.answer(&list())?;
        return Ok(Ending::Done);
    };
    let columns = if arguments.no_friction { Columns::RIGID } else { arguments.columns };
    let prepared = arguments.log.process(path)?;
    let estimates = prepared.identify_by(columns, &arguments.estimator)?;
    let json = match estimates.as_slice() {
        [one] => as_json(one, &prepared),
        several => several.iter().map(|estimate| as_json(estimate, &prepared)).collect(),
    };
    if console.to_standard_output() {
        console.print(&pretty(&json))?;
    }
    if let Some(path) = console.output() {
        output::write_text(path, &pretty(&json))?;
        console.note(format!("wrote {}", path.display()));
    }
    let text = estimates.iter().map(|estimate| text(estimate, &prepared, console.verbose())).collect();
    console.show(&Answer { text, json })?;
    let sound = estimates.iter().all(|estimate| estimate.termination.was_successful());
    Ok(if sound { Ending::Done } else { Ending::Negative })
}

fn list() -> Answer {
    let mut table = Table::new(&[("estimator", Align::Left), ("what it does", Align::Left)]);
    for kind in EstimatorKind::ALL {
        table.row([kind.name(), kind.estimator().summary()]);
    }
    let json = EstimatorKind::ALL
        .iter()
        .map(|kind| json!({ "name": kind.name(), "summary": kind.estimator().summary() }))
        .collect();
    Answer { text: table.render(0), json }
}

/// The estimate's own keys, with each finding's sentence and advice beside its numbers.
fn as_json(estimate: &Estimate, prepared: &ProcessedLog) -> Value {
    let mut json = serde_json::to_value(estimate).unwrap_or_default();
    if let Some(gaps) = &prepared.gaps {
        json["gaps"] = gaps.json();
    }
    if let Some(findings) = json.get_mut("findings").and_then(Value::as_array_mut) {
        for (value, finding) in findings.iter_mut().zip(&estimate.findings) {
            value["text"] = json!(finding.to_string());
            value["advice"] = json!(finding.advice());
        }
    }
    json
}

fn text(estimate: &Estimate, prepared: &ProcessedLog, verbose: bool) -> String {
    let mut text = format!(
        "{} by {}: {} base parameters of \"{}\" ({})\n{} samples, {} period{} averaged; condition {} ({} with columns \
         of unit length){}\n\n",
        prepared.log.name,
        estimate.estimator,
        estimate.base.len(),
        estimate.robot,
        estimate.columns,
        estimate.samples,
        estimate.periods,
        if estimate.periods == 1 { "" } else { "s" },
        number(estimate.condition),
        number(estimate.condition_scaled),
        if prepared.log.complete { "" } else { "\nthe recording is cut off; its whole periods were used" },
    );
    if let Some(gaps) = &prepared.gaps {
        let _ = writeln!(text, "{}", gaps.text());
    }
    let mut table = Table::new(&[
        ("parameter", Align::Left),
        ("value", Align::Right),
        ("std", Align::Right),
        ("95 % interval", Align::Right),
        ("", Align::Right),
        ("unit", Align::Left),
    ]);
    for parameter in &estimate.base {
        let decimals = decimals(parameter.std);
        let [value, low, high] =
            [parameter.value, parameter.ci95[0], parameter.ci95[1]].map(|number| format!("{number:.decimals$}"));
        let std = format!("{:.decimals$}", parameter.std);
        table.row([parameter.name.clone(), value, std, low, high, parameter.unit.clone()]);
    }
    text.push_str(&table.render(2));
    let mut table = Table::new(&[
        ("joint", Align::Left),
        ("residual RMS", Align::Right),
        ("noise", Align::Right),
        ("", Align::Left),
    ]);
    for (i, joint) in prepared.robot.robot.joints().iter().enumerate() {
        let (residual, noise) = (number(estimate.residual_rms[i]), number(estimate.noise_std[i]));
        table.row([joint.name.clone(), residual, noise, estimate.units[i].clone()]);
    }
    let _ = write!(text, "\n{}", table.render(2));
    match estimate.consistent {
        Some(true) => text.push_str("\nthe full set of parameters is physically consistent\n"),
        Some(false) => text.push_str("\nthe full set of parameters is not physically consistent\n"),
        None => {}
    }
    if verbose && let Some(standard) = &estimate.standard {
        let mut table = Table::new(&[("standard parameter", Align::Left), ("value", Align::Right)]);
        for parameter in standard {
            table.row([parameter.name.clone(), format!("{:.6}", parameter.value)]);
        }
        let _ = write!(text, "\n{}", table.render(2));
    }
    text.push_str(&findings(estimate));
    text
}

/// The findings, those with the same advice together.
fn findings(estimate: &Estimate) -> String {
    let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
    for finding in &estimate.findings {
        match groups.iter_mut().find(|(advice, _)| *advice == finding.advice()) {
            Some((_, found)) => found.push(finding.to_string()),
            None => groups.push((finding.advice(), vec![finding.to_string()])),
        }
    }
    let mut text = String::new();
    for (advice, found) in groups {
        text.push('\n');
        for sentence in found {
            let mut table = Table::new(&[("", Align::Left)]);
            table.row([sentence]);
            text.push_str(table.render(2).trim_start_matches('\n'));
        }
        let mut table = Table::new(&[("", Align::Left)]);
        table.row([format!("→ {advice}")]);
        text.push_str(table.render(4).trim_start_matches('\n'));
    }
    text
}

/// Decimals that show two digits of a standard deviation.
fn decimals(std: f64) -> usize {
    if std.is_finite() && std > 0.0 { (1.0 - std.log10().floor()).clamp(0.0, 12.0) as usize } else { 6 }
}

#[cfg(test)]
mod tests {
    use super::decimals;

    #[test]
    fn two_digits_of_the_deviation_are_shown() {
        for (std, expected) in [(0.014, 3), (2.9e-3, 4), (0.99, 2), (25.0, 0), (1e-30, 12), (f64::INFINITY, 6)] {
            assert_eq!(decimals(std), expected, "{std}");
        }
    }
}
