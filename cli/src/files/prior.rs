//! Estimates as the information that a design may build on.

use std::path::{Path, PathBuf};

use armid::estimation::Estimate;
use armid::excitation::DesignProblem;
use armid::provenance::sha256;
use miette::Result;

use crate::atomic_file::read_text;
use crate::fault::{Fault, Text};
use crate::robot_source::LoadedRobot;

/// Sets a problem's noise and prior information by earlier estimates of the same robot and base parameters.
///
/// The noise and the number of equations are those of the last estimate: the next experiment is taken to be performed
/// and processed as that one was.
pub(crate) fn set_prior(problem: &mut DesignProblem, loaded: &LoadedRobot, paths: &[PathBuf]) -> Result<()> {
    let mut sum = None;
    for path in paths {
        let estimate = read(path)?;
        check(&estimate, problem, loaded, path)?;
        if let Some(bad) = estimate.noise_std.iter().find(|std| !(std.is_finite() && **std > 0.0)) {
            return Err(fault(path, &format!("a noise_std is {bad}, expected a finite number above zero")));
        }
        let information = estimate.information().ok_or_else(|| {
            fault(path, "the covariance is not positive definite, expected that of an identified base")
        })?;
        let known = match sum.take() {
            None => information,
            Some(before) => before + information,
        };
        let sum = sum.insert(known);
        problem.set_prior(sum, &estimate.noise_std, estimate.samples);
    }
    Ok(())
}

fn fault(path: &Path, message: &str) -> miette::Report {
    Fault::new(format!("--prior {}: {message}", path.display())).into()
}

/// One estimate of a file of `armid identify`.
fn read(path: &Path) -> Result<Estimate> {
    let text: Text = read_text(path)?;
    if text.content.trim_start().starts_with('[') {
        return Err(fault(
            path,
            "a list of estimates is found, expected one: name one --estimator in `armid identify`",
        ));
    }
    serde_json::from_str(&text.content).map_err(|error| {
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        let shown = Fault::new(message).at_line(&text, error.line(), error.column());
        shown.help("expected an estimate of `armid identify`").into()
    })
}

/// The same robot, the same columns, the same base parameters in the same order.
fn check(estimate: &Estimate, problem: &DesignProblem, loaded: &LoadedRobot, path: &Path) -> Result<()> {
    let mismatch = |what: &str, found: &str, expected: &str| {
        Err(fault(path, &format!("the {what} is \"{found}\", expected \"{expected}\"")))
    };
    if estimate.robot != problem.robot.name() {
        return mismatch("robot", &estimate.robot, problem.robot.name());
    }
    if let Some(provenance) = &estimate.provenance {
        let expected = sha256(&loaded.text.content);
        if provenance.robot_sha256 != expected {
            return mismatch("SHA-256 of the robot file", &provenance.robot_sha256, &expected);
        }
    }
    if estimate.columns != problem.columns.name() {
        return mismatch("columns", &estimate.columns, problem.columns.name());
    }
    let (found, expected) = (estimate.names(), problem.base.names());
    if found.len() != expected.len() {
        let (found, expected) = (found.len().to_string(), expected.len().to_string());
        return mismatch("number of base parameters", &found, &expected);
    }
    match found.iter().zip(&expected).find(|(found, expected)| found != expected) {
        Some((found, expected)) => mismatch("base parameter", found, expected),
        None => Ok(()),
    }
}
