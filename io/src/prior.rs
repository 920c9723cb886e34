//! Estimates as the information that a design may build on.

use std::path::PathBuf;

use armid::estimation::Estimate;
use armid::excitation::DesignProblem;
use armid::remedy::{Remedy, Setting, Task};

use crate::error::Error;
use crate::estimate::{check_robot, mismatch, read};
use crate::robot::LoadedRobot;

/// What makes an estimate that a design can add to.
fn again() -> Remedy {
    let again = Remedy::task(Task::Identify, "LOG").option(Setting::Estimator, "wls").option(Setting::Output, "E.json");
    again.say(" makes an estimate that a design can add to")
}

/// Sets a problem's noise and prior information by earlier estimates of the same robot and base parameters.
///
/// The noise and the number of equations are those of the last estimate: the next experiment is taken to be performed
/// and processed as that one was.
///
/// # Errors
/// [`Error`] where a file holds no estimate, one of something else, or one that carries no information.
pub fn set_prior(problem: &mut DesignProblem, loaded: &LoadedRobot, paths: &[PathBuf]) -> Result<(), Error> {
    let mut sum = None;
    for path in paths {
        let estimate = read(path)?;
        let name = path.display().to_string();
        check(&estimate, problem, loaded, &name)?;
        if let Some(bad) = estimate.noise_std.iter().find(|std| !(std.is_finite() && **std > 0.0)) {
            let message = format!("{name}: a noise_std is {bad}, expected a finite number above zero");
            return Err(Error::new(message).help(again()));
        }
        let information = estimate.information().ok_or_else(|| {
            Error::new(format!("{name}: the covariance is not positive definite, expected that of an identified base"))
                .help(again())
        })?;
        let known = match sum.take() {
            None => information,
            Some(before) => before + information,
        };
        let sum = sum.insert(known);
        problem
            .set_collected(sum, &estimate.noise_std, estimate.samples)
            .map_err(|fault| Error::new(format!("{name}: {fault}")))?;
    }
    Ok(())
}

/// Checks that robot, columns and base parameters agree, in one order.
fn check(estimate: &Estimate, problem: &DesignProblem, loaded: &LoadedRobot, name: &str) -> Result<(), Error> {
    check_robot(estimate, name, loaded)?;
    let columns = problem.objective().columns.to_string();
    if estimate.columns != columns {
        return Err(mismatch(name, "columns", &estimate.columns, &columns));
    }
    let (found, expected) = (estimate.names(), problem.base().names());
    if found.len() != expected.len() {
        let (found, expected) = (found.len().to_string(), expected.len().to_string());
        return Err(mismatch(name, "number of base parameters", &found, &expected));
    }
    match found.iter().zip(&expected).find(|(found, expected)| found != expected) {
        Some((found, expected)) => Err(mismatch(name, "base parameter", found, expected)),
        None => Ok(()),
    }
}
