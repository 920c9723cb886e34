//! Recordings as CSV: `t,q1..qn,tau1..taun` in s, rad (m), N·m (N), or `t,q1..qn,current1..currentn` with A; then,
//! where motor voltages were recorded, `voltage1..voltagen` in V.

use std::collections::BTreeMap;
use std::fmt::Write;

use armid::experiment::Recording;
use armid::model::EffortInterface;

use super::joint_log::Log;
use crate::error::Error;
use crate::table::NumberTable;
use crate::text::Text;

/// Reads a log from its text. The time steps must be equal within a hundredth of one.
///
/// # Errors
/// [`Error`] with line and column where the table is not as this format says.
pub fn parse(text: Text) -> Result<Log, Error> {
    let table = NumberTable::parse(text)?;
    let time = table.require("t").map_err(|fault| fault.help(EXPECTED))?;
    let dof = (1..).take_while(|k| table.find(&format!("q{k}")).is_some()).count();
    let q = table.numbered("q", dof.max(1)).map_err(|fault| fault.help(EXPECTED))?;
    let unit = if table.find("tau1").is_some() { EffortInterface::Torque } else { EffortInterface::Current };
    let prefix = prefix(unit);
    let effort = table.numbered(prefix, dof).map_err(|fault| fault.help(EXPECTED))?;
    let voltage = match table.find("voltage1") {
        Some(_) => table.numbered("voltage", dof).map_err(|fault| fault.help(EXPECTED))?,
        None => Vec::new(),
    };
    let known: Vec<usize> = q.iter().chain(&effort).chain(&voltage).copied().chain([time]).collect();
    let expected = format!("t,q1..q{dof},{prefix}1..{prefix}{dof}");
    table.only(&expected, |name| table.find(name).is_some_and(|column| known.contains(&column)))?;
    let rate_hz = rate(&table, time)?;
    let rows = 0..table.len();
    Ok(Log {
        name: table.text.name.clone(),
        joints: None,
        dof,
        rate_hz,
        effort_unit: Some(unit),
        q: rows.clone().flat_map(|row| table.pick(row, &q)).collect(),
        effort: rows.flat_map(|row| table.pick(row, &effort)).collect(),
        robot: None,
        recording: None,
        notes: BTreeMap::new(),
        complete: true,
    })
}

const EXPECTED: &str = "expected the headings t,q1..qn,tau1..taun (N·m) or t,q1..qn,current1..currentn (A)";

const fn prefix(unit: EffortInterface) -> &'static str {
    match unit {
        EffortInterface::Current => "current",
        EffortInterface::Torque => "tau",
    }
}

/// Samples per second; a fault where time stands, goes back or jumps.
fn rate(table: &NumberTable, time: usize) -> Result<f64, Error> {
    let n = table.len();
    if n < 2 {
        return Err(Error::new(format!("{} has {n} samples, expected at least 2", table.text.name)));
    }
    let step = (table.value(n - 1, time) - table.value(0, time)) / (n - 1) as f64;
    for row in 1..n {
        let found = table.value(row, time) - table.value(row - 1, time);
        if !(step > 0.0 && (found - step).abs() <= 0.01 * step) {
            let message = format!("t: found a step of {found:.6e} s, expected the mean step {step:.6e} s within 1 %");
            return Err(table.row_fault(row, message).help("equal time steps are needed; resample the log"));
        }
    }
    // A rate that is a whole number of Hz to the precision of the file is meant to be that.
    let rate = 1.0 / step;
    let whole = rate.round();
    Ok(if whole > 0.0 && (rate / whole - 1.0).abs() < 1e-6 { whole } else { rate })
}

/// A recording as such a table.
#[must_use]
pub fn write(recording: &Recording) -> String {
    let prefix = prefix(recording.effort_unit);
    let mut text = "t".to_owned();
    let voltage = (!recording.voltage.is_empty()).then_some("voltage");
    for name in ["q", prefix].into_iter().chain(voltage) {
        for k in 1..=recording.dof {
            let _ = write!(text, ",{name}{k}");
        }
    }
    text.push('\n');
    for k in 0..recording.len() {
        let _ = write!(text, "{}", recording.t[k]);
        for value in recording.q(k).iter().chain(recording.effort(k)).chain(recording.voltage(k)) {
            let _ = write!(text, ",{value}");
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::parse;
    use crate::text::Text;
    use armid::model::EffortInterface;

    #[test]
    fn rate_and_unit_are_read() {
        let log = parse(Text::new("r.csv", "t,q1,current1\n0,1,2\n0.002,3,4\n0.004,5,6\n")).unwrap();
        assert_eq!((log.rate_hz, log.dof, log.effort_unit), (500.0, 1, Some(EffortInterface::Current)));
        assert_eq!((log.q, log.effort), (vec![1.0, 3.0, 5.0], vec![2.0, 4.0, 6.0]));
    }

    #[test]
    fn faults_carry_line_and_column() {
        for (text, fault) in [
            ("q1,tau1\n0,1\n", "r.csv:1:1: heading \"t\" is missing"),
            ("t,tau1\n0,1\n", "r.csv:1:1: heading \"q1\" is missing"),
            ("t,q1,q2,tau1\n0,1,2,3\n", "r.csv:1:1: heading \"tau2\" is missing"),
            ("t,q1,tau1,gain\n0,1,2,3\n", "r.csv:1:11: found heading \"gain\", expected t,q1..q1,tau1..tau1"),
            ("t,q1,tau1\n0,1,2\n", "r.csv has 1 samples, expected at least 2"),
        ] {
            assert_eq!(parse(Text::new("r.csv", text)).unwrap_err().to_string(), fault);
        }
        let fault = parse(Text::new("r.csv", "t,q1,tau1\n0,1,2\n0.1,1,2\n0.4,1,2\n")).unwrap_err().to_string();
        assert!(fault.starts_with("r.csv:3:1: t: found a step of 1.000000e-1 s"), "{fault}");
    }
}
