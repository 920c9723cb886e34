//! Estimates as `armid identify` writes them: one, or a list where several estimators were asked.

use std::path::Path;

use armid::estimation::Estimate;
use armid::provenance::sha256;
use armid::remedy::{Remedy, Setting, Task};

use crate::error::Error;
use crate::robot::LoadedRobot;
use crate::text::Text;

const EXPECTED: &str = "expected an estimate";

/// Reads a file that holds one estimate.
///
/// # Errors
/// [`Error`] where it cannot be read or holds something else.
pub fn read(path: &Path) -> Result<Estimate, Error> {
    parse(&Text::read(path)?)
}

/// One estimate.
///
/// # Errors
/// [`Error`] with line and column where the text is not an estimate; [`Error`] where it is a list of them.
pub fn parse(text: &Text) -> Result<Estimate, Error> {
    if is_list(text) {
        let message = format!("{} holds a list of estimates, expected one", text.name);
        return Err(Error::new(message).help(Remedy::from("identify with one ").setting(Setting::Estimator)));
    }
    let estimate = serde_json::from_str(&text.content).map_err(|error| Error::of_json(text, &error).help(EXPECTED))?;
    check_lengths(&estimate, text)?;
    Ok(estimate)
}

/// One estimate, or the list that several estimators make; at least one.
///
/// # Errors
/// [`Error`] with line and column where the text holds something else, or an empty list.
pub fn parse_all(text: &Text) -> Result<Vec<Estimate>, Error> {
    if !is_list(text) {
        return Ok(vec![parse(text)?]);
    }
    let estimates: Vec<Estimate> =
        serde_json::from_str(&text.content).map_err(|error| Error::of_json(text, &error).help(EXPECTED))?;
    if estimates.is_empty() {
        let message = format!("{} holds an empty list, expected at least one estimate", text.name);
        let help = Remedy::task(Task::Identify, "LOG").option(Setting::Output, &text.name).say(" makes such a file");
        return Err(Error::new(message).help(help));
    }
    estimates.iter().try_for_each(|estimate| check_lengths(estimate, text))?;
    Ok(estimates)
}

/// Lists that have the lengths that they must have.
fn check_lengths(estimate: &Estimate, text: &Text) -> Result<(), Error> {
    let (base, joints) = (estimate.base.len(), estimate.residual_rms.len());
    let rows = estimate.covariance.iter().map(|row| ("a row of covariance", row.len(), base));
    let lists = [
        ("covariance", estimate.covariance.len(), base),
        ("noise_std", estimate.noise_std.len(), joints),
        ("units", estimate.units.len(), joints),
    ];
    match lists.into_iter().chain(rows).find(|(_, found, expected)| found != expected) {
        Some((what, found, expected)) => {
            let message = format!("{}: {what} has {found} entries, expected {expected}", text.name);
            Err(Error::new(message).help(EXPECTED))
        }
        None => Ok(()),
    }
}

fn is_list(text: &Text) -> bool {
    text.content.trim_start().starts_with('[')
}

/// An estimate is of this very robot: the same name and, where the estimate says it, the same file. `name` is what the
/// error calls the estimate.
///
/// # Errors
/// [`Error`] where it is of another one.
pub fn check_robot(estimate: &Estimate, name: &str, loaded: &LoadedRobot) -> Result<(), Error> {
    if estimate.robot != loaded.robot.name() {
        return Err(mismatch(name, "robot", &estimate.robot, loaded.robot.name()));
    }
    if let Some(provenance) = &estimate.provenance {
        let expected = sha256(&loaded.text.content);
        if provenance.robot_sha256 != expected {
            return Err(mismatch(name, "SHA-256 of the robot file", &provenance.robot_sha256, &expected));
        }
    }
    Ok(())
}

pub(crate) fn mismatch(name: &str, what: &str, found: &str, expected: &str) -> Error {
    Error::mismatch(format!("{name}: the {what} is \"{found}\", expected \"{expected}\"")).help(
        Remedy::task(Task::Identify, "LOG")
            .option(Setting::Robot, "…")
            .option(Setting::Output, name)
            .say(" estimates again, of the robot at hand"),
    )
}

#[cfg(test)]
mod tests {
    use super::{parse, parse_all};
    use crate::text::Text;

    #[test]
    fn what_is_no_estimate_is_refused_with_its_place() {
        let refused = |text: &str| parse_all(&Text::new("e.json", text)).unwrap_err().to_string();
        assert_eq!(refused("[]"), "e.json holds an empty list, expected at least one estimate");
        assert!(refused("{\n \"estimator\": 3}").starts_with("e.json:2:15: invalid type: integer `3`"));
        assert!(refused("[{}]").starts_with("e.json:1:3: missing field"));
        let list = parse(&Text::new("e.json", "[]")).unwrap_err();
        assert_eq!(list.to_string(), "e.json holds a list of estimates, expected one");
    }
}
