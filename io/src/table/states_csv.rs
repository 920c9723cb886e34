//! States as CSV: `q1..qn,qd1..qdn,qdd1..qddn`, or `tau1..taun` in place of `qdd`.

use armid::dynamics::States;

use super::number_table::NumberTable;
use crate::error::Error;
use crate::text::Text;

/// What the third group of columns holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Third {
    /// Accelerations `qdd`.
    Acceleration,
    /// Efforts `tau`; they stand where the accelerations would.
    Effort,
}

impl Third {
    const fn prefix(self) -> &'static str {
        match self {
            Self::Acceleration => "qdd",
            Self::Effort => "tau",
        }
    }
}

/// Reads the states of a robot of `dof` joints from their text. Columns may stand in any order, and a time column `t`
/// beside them.
///
/// # Errors
/// [`Error`] with line and column where the table is not as this format says.
pub fn parse(text: Text, dof: usize, third: Third) -> Result<States, Error> {
    let table = NumberTable::parse(text)?;
    let prefix = third.prefix();
    let expected = format!("q1..q{dof},qd1..qd{dof},{prefix}1..{prefix}{dof} for this robot of {dof} joints");
    let group = |prefix: &str| {
        table.numbered(prefix, dof).map_err(|fault| fault.help(format!("expected the headings {expected}")))
    };
    let (q, qd, qdd) = (group("q")?, group("qd")?, group(prefix)?);
    let known: Vec<usize> = q.iter().chain(&qd).chain(&qdd).copied().collect();
    table.only(&expected, |name| name == "t" || table.find(name).is_some_and(|column| known.contains(&column)))?;
    if table.len() == 0 {
        let message = format!("{} holds no states, expected at least one row", table.text.name);
        return Err(Error::new(message).help(format!("the headings are {expected}, and each further line is a state")));
    }
    let mut states = States::new(dof);
    for row in 0..table.len() {
        states.push(&table.pick(row, &q), &table.pick(row, &qd), &table.pick(row, &qdd));
    }
    Ok(states)
}

#[cfg(test)]
mod tests {
    use super::{Third, parse};
    use crate::text::Text;

    #[test]
    fn columns_are_found_by_name() {
        let text = Text::new("s.csv", "t,qd1,q1,tau1\n0,2,1,3\n0.1,5,4,6\n");
        let states = parse(text, 1, Third::Effort).unwrap();
        assert_eq!((states.q(1), states.qd(1), states.qdd(1)), (&[4.0][..], &[5.0][..], &[6.0][..]));
    }

    #[test]
    fn a_header_for_another_robot_is_refused() {
        let text = || Text::new("s.csv", "q1,q2,qd1,qd2,qdd1,qdd2\n1,2,3,4,5,6\n");
        let fault = parse(text(), 1, Third::Acceleration).unwrap_err().to_string();
        assert!(fault.starts_with("s.csv:1:4: found heading \"q2\", expected q1..q1,qd1..qd1,qdd1..qdd1"), "{fault}");
        let fault = parse(text(), 3, Third::Acceleration).unwrap_err();
        assert_eq!(fault.to_string(), "s.csv:1:1: heading \"q3\" is missing");
        assert!(fault.hint().unwrap().contains("3 joints"));
    }
}
