//! Recordings as CSV: `t,q1..qn,tau1..taun` in s, rad (m), N·m (N), or `t,q1..qn,current1..currentn` with A; then,
//! where motor voltages were recorded, `voltage1..voltagen` in V, and where links have encoders of their own, `q_link1..q_linkn` in rad (m).

use std::fmt::Write;

use armid::experiment::Recording;
use armid::model::EffortInterface;

use super::foreign_csv;
use super::joint_log::Log;
use crate::error::Error;
use crate::text::Text;

/// Reads a log from its text, whose headings say what its columns are; see [`super::parse_tables`] for other headings.
///
/// # Errors
/// [`Error`] with line and column where the table is not as this format says.
pub fn parse(text: Text) -> Result<Log, Error> {
    foreign_csv::parse(vec![text], None, None)
}

const fn prefix(unit: EffortInterface) -> &'static str {
    match unit {
        EffortInterface::Current => "current",
        EffortInterface::Torque => "tau",
    }
}

/// A recording as such a table.
pub fn write(recording: &Recording) -> String {
    let prefix = prefix(recording.effort_unit);
    let mut text = "t".to_owned();
    let voltage = (!recording.voltage.is_empty()).then_some("voltage");
    let links = (!recording.link_q.is_empty()).then_some("q_link");
    for name in ["q", prefix].into_iter().chain(voltage).chain(links) {
        for k in 1..=recording.dof {
            let _ = write!(text, ",{name}{k}");
        }
    }
    text.push('\n');
    for k in 0..recording.len() {
        let _ = write!(text, "{}", recording.t[k]);
        for values in [recording.q(k), recording.effort(k), recording.voltage(k), recording.link_q(k)] {
            for value in values {
                let _ = write!(text, ",{value}");
            }
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::parse;
    use crate::log::Mapping;
    use crate::text::Text;
    use armid::model::EffortInterface;

    #[test]
    fn rate_and_unit_are_read() {
        let log = parse(Text::new("r.csv", "t,q1,current1\n0,1,2\n0.002,3,4\n0.004,5,6\n")).unwrap();
        assert_eq!((log.rate_hz, log.dof, log.effort_unit), (500.0, 1, Some(EffortInterface::Current)));
        assert_eq!((log.q, log.effort), (vec![1.0, 3.0, 5.0], vec![2.0, 4.0, 6.0]));
    }

    #[test]
    fn headings_may_count_from_zero_and_a_single_joint_needs_no_number() {
        for between in ["", "_"] {
            let log = parse(Text::new(
                "r.csv",
                format!("t,q{between}0,q{between}1,tau{between}0,tau{between}1\n0,1,2,3,4\n1,5,6,7,8\n"),
            ));
            let log = log.unwrap();
            assert_eq!((log.dof, log.q, log.effort), (2, vec![1.0, 2.0, 5.0, 6.0], vec![3.0, 4.0, 7.0, 8.0]));
        }
        let log = parse(Text::new("r.csv", "time,position,torque\n0,1,2\n1,3,4\n")).unwrap();
        assert_eq!((log.dof, log.q, log.effort), (1, vec![1.0, 3.0], vec![2.0, 4.0]));
    }

    #[test]
    fn the_torque_of_a_joint_may_be_left_out_and_its_position_not() {
        let text = "t,q1,q2,q3,tau1,tau3\n0,1,2,3,4,5\n1,6,7,8,9,10\n";
        let of = |map: &str| {
            crate::log::parse_tables(vec![Text::new("r.csv", text)], Some(&Mapping::parse(map).unwrap()), None)
        };
        let log = of("t=t, q=q[1-3], tau=tau1/-/tau3").unwrap();
        assert_eq!(log.effort, [4.0, 0.0, 5.0, 9.0, 0.0, 10.0]);
        assert_eq!(log.excluded, [false, true, false, false, true, false]);
        assert_eq!(log.origin.remarks, ["joint 2: its effort is left out, and it gives no equation of its own"]);
        assert_eq!(log.origin.columns[2], "tau from tau1 - tau3 in Nm");
        for map in ["t=t, q=q1/-/q3, tau=tau1/tau1/tau3", "t=t, q=q[1-2], tau=-/-"] {
            let fault = of(map).unwrap_err().to_string();
            assert!(fault.contains("found \"-\", expected a column"), "{fault}");
        }
    }

    #[test]
    fn faults_carry_line_and_column() {
        for (text, fault) in [
            ("q1,tau1\n0,1\n", "r.csv:1:1: heading \"t\" is missing"),
            ("t,tau1\n0,1\n", "r.csv:1:1: heading \"q1\" is missing"),
            ("t,q1,q2,tau1\n0,1,2,3\n", "r.csv:1:1: heading \"tau2\" is missing"),
            ("t,q1,tau1\n0,1,2\n", "r.csv has 1 samples, expected at least 2"),
            (
                "t,q1,q2,tau1,tau2\n0,1,1,2,nan\n1,1,1,2,nan\n2,1,1,2,nan\n",
                "r.csv has 0 samples, expected at least 2: no row has a number in \"tau2\" (tau)",
            ),
        ] {
            assert_eq!(parse(Text::new("r.csv", text)).unwrap_err().to_string(), fault);
        }
    }

    #[test]
    fn uneven_stamps_are_resampled_and_other_columns_named() {
        let rows: String =
            (0..400).map(|k| format!("{},{k},2,3\n", f64::from(k) * 0.01 + f64::from(k % 2) * 0.003)).collect();
        let log = parse(Text::new("r.csv", format!("time_s,q1,tau1,gain\n{rows}"))).unwrap();
        assert_eq!((log.rate_hz, log.dof, log.q.len()), (100.0, 1, 400));
        assert_eq!(log.origin.skipped_columns, ["gain"]);
        let said = log.origin.sentences().join("; ");
        assert!(said.contains("steps of 7.000 to 13.000 ms: brought onto 100 Hz"), "{said}");
    }
}
