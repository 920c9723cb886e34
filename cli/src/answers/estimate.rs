//! What `armid identify` says of an estimate.

use std::fmt::Write;

use armid::estimation::{Estimate, TorqueResidual};
use armid::number::significant;
use armid_io::ProcessedLog;
use armid_workflow::identification::{Identified, grouped};
use armid_workflow::numbers::{number, percent};

use super::findings::{findings, paragraph};
use super::verdict::verdict_text;
use crate::terminal::Table;

/// Rows of a table of parameters that still fit on one screen with the rest.
const SCREEN_ROWS: usize = 12;

/// Residuals of all rows joint by joint, and in total; with more words also those of the rows that the fit uses.
fn residual_table(
    joints: &[String],
    units: &[String],
    fit: &TorqueResidual,
    held_out: Option<&TorqueResidual>,
    verbose: bool,
) -> String {
    let mut headings = "joint | #residual RMS |  | #of the measured".to_owned();
    let mut columns = vec![&fit.all];
    if let Some(held_out) = held_out {
        headings += " | #held out";
        columns.push(&held_out.all);
    }
    if verbose {
        headings += " | #rows of the fit";
        columns.push(&fit.used);
        if let Some(held_out) = held_out {
            headings += " | #held out, rows of the fit";
            columns.push(&held_out.used);
        }
    }
    let mut table = Table::of(&headings);
    for (i, joint) in joints.iter().enumerate() {
        let mut row = vec![joint.clone(), significant(fit.all.rms[i], 3), units[i].clone()];
        row.extend(columns.iter().map(|rows| percent(rows.share[i])));
        table.row(row);
    }
    let mut row = vec!["total".to_owned(), String::new(), String::new()];
    row.extend(columns.iter().map(|rows| percent(rows.total)));
    table.row(row);
    table.render(2)
}

/// Which rows a fit leaves out and why, and what is at fault in the recordings; nothing where all count. More words say it joint by
/// joint.
pub(crate) fn left_out(prepared: &ProcessedLog, verbose: bool) -> String {
    let mut text = String::new();
    for report in &prepared.reports {
        let share = |count: &usize| 100.0 * (1.0 - *count as f64 / report.blocks.max(1) as f64);
        let shares: Vec<f64> = report.equations.iter().map(share).collect();
        let (least, most) =
            (shares.iter().copied().fold(f64::INFINITY, f64::min), shares.iter().copied().fold(0.0, f64::max));
        if most > 0.0 {
            let of_each: Vec<String> = shares.iter().map(|share| format!("{share:.0} %")).collect();
            let range = if verbose { of_each.join(", ") } else { format!("{least:.0} to {most:.0} %") };
            let slow = 100.0 * prepared.settings.processing.reversal_fraction;
            let sentence = format!(
                "rows of the fit: all but {range} of those of a joint, where it reverses or is slower than {slow} % of its top speed, \
                 the filter has an edge, or a channel is at fault"
            );
            let sentence = if prepared.reports.len() > 1 { format!("{}: {sentence}", report.name) } else { sentence };
            text.push_str(&paragraph(&sentence, 2));
        }
        for sentence in report.origin.sentences() {
            let sentence = if prepared.reports.len() > 1 { format!("{}: {sentence}", report.name) } else { sentence };
            text.push_str(&paragraph(&sentence, 2));
        }
        if let Some(gaps) = &report.gaps {
            text.push_str(&paragraph(gaps.text().trim_end(), 2));
        }
        if !report.complete {
            text.push_str("  the recording is cut off; its whole periods were used\n");
        }
    }
    text
}

/// An estimate: what fits on one screen, and with more words everything that is said of it.
pub(crate) fn estimate_text(prepared: &ProcessedLog, of: &Identified, verbose: bool) -> String {
    let Identified { estimate, used, held_out, verdict, .. } = of;
    let time = |of: fn(&armid_io::log::LogReport) -> f64| prepared.reports.iter().map(of).sum::<f64>();
    let averaged = if prepared.samples.period_s.is_some() {
        let plural = if estimate.periods == 1 { "" } else { "s" };
        format!("{} period{plural} averaged", estimate.periods)
    } else {
        "no periods".to_owned()
    };
    let mut text = format!(
        "{} by {}: {} base parameters of \"{}\" ({})\n",
        prepared.name(),
        estimate.estimator,
        estimate.base.len(),
        estimate.robot,
        estimate.columns,
    );
    let _ = writeln!(text, "\n{}", verdict_text(verdict));
    let _ =
        writeln!(text, "torque below {} Hz that the estimate does not explain, on all rows", number(used.bandwidth_hz));
    text += &residual_table(&prepared.joint_names(), &estimate.units, used, held_out.as_ref(), verbose);
    let sentence = format!(
        "{} s used, {} s held out, {averaged}; {} samples; condition number {} ({} with columns of unit length)",
        number(time(|report| report.used_s)),
        number(time(|report| report.held_out_s)),
        estimate.samples,
        number(estimate.condition),
        number(estimate.condition_scaled),
    );
    let _ = write!(text, "\n{}", paragraph(&sentence, 2));
    text += &left_out(prepared, verbose);
    let shows_parameters = verbose || estimate.base.len() <= SCREEN_ROWS;
    if shows_parameters {
        text.push('\n');
        text += &parameters(of, verbose);
    }
    text += &servo(estimate);
    if !verbose {
        return text + &what_more(of, shows_parameters);
    }
    match estimate.consistent {
        Some(true) => text.push_str("\nthe full set of parameters is physically consistent\n"),
        Some(false) => text.push_str("\nthe full set of parameters is not physically consistent\n"),
        None => {}
    }
    if let Some(standard) = &estimate.standard {
        let mut table = Table::of("standard parameter | #value");
        for parameter in standard {
            table.row([parameter.name.clone(), format!("{:.6}", parameter.value)]);
        }
        let _ = write!(text, "\n{}", table.render(2));
    }
    text.push_str(&findings(&estimate.findings, verdict.groups));
    text
}

/// What the first screen leaves out, and how it is shown.
fn what_more(Identified { estimate, verdict, .. }: &Identified, shows_parameters: bool) -> String {
    let findings = grouped(&estimate.findings).len().saturating_sub(verdict.groups);
    let mut more = vec![];
    if !shows_parameters {
        more.push(format!("all {} parameters with their intervals", estimate.base.len()));
    }
    match findings {
        0 => {}
        1 => more.push("1 more finding".to_owned()),
        _ => more.push(format!("{findings} more findings")),
    }
    if more.is_empty() {
        return String::new();
    }
    format!("\n{}", paragraph(&format!("{}: add `-v`", more.join(", and ")), 2))
}

fn parameters(Identified { estimate, expressions, .. }: &Identified, verbose: bool) -> String {
    let declares = estimate.base.iter().any(|parameter| parameter.declared_std > 0.0);
    // In squares: what the robot file declares, and no residual shows.
    let declared = if declares { " | #of it declared" } else { "" };
    let meaning = if verbose { " | stands for" } else { "" };
    let mut table = Table::of(&format!("parameter | #value | #std{declared} | #95 % interval | # | unit{meaning}"));
    for (parameter, expression) in estimate.base.iter().zip(expressions) {
        let decimals = decimals(parameter.std);
        let shown = |number: f64| if number.is_finite() { format!("{number:.decimals$}") } else { "–".to_owned() };
        let [value, low, high] = [parameter.value, parameter.ci95[0], parameter.ci95[1]].map(shown);
        let std = format!("{:.decimals$}", parameter.std);
        let mut row = vec![parameter.name.clone(), value, std];
        if declares {
            row.push(format!("{:.decimals$}", parameter.declared_std));
        }
        row.extend([low, high, parameter.unit.clone()]);
        if verbose {
            row.push(if *expression == parameter.name { String::new() } else { expression.clone() });
        }
        table.row(row);
    }
    table.render(2)
}

/// What was found of position servos; nothing where nothing was unknown.
fn servo(estimate: &Estimate) -> String {
    if estimate.servo.is_empty() {
        return String::new();
    }
    let mut table = Table::of("servo | #guess | #value | #std | #95 % interval | # | unit");
    for part in &estimate.servo {
        let decimals = decimals(part.std);
        let shown = |number: f64| format!("{number:.decimals$}");
        let [value, std, low, high] = [part.value, part.std, part.ci95[0], part.ci95[1]].map(shown);
        table.row([part.name.clone(), number(part.stated), value, std, low, high, part.unit.clone()]);
    }
    format!("\n{}", table.render(2))
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
