//! An estimate as source code, and its operations against the regressor.

use std::fmt::Write;
use std::path::PathBuf;

use armid::base::{BaseReduction, Method, reduce};
use armid::codegen::{BaseModel, Language};
use armid::estimation::{BaseEstimate, Estimate, EstimationError};
use armid::model::Robot;
use armid::remedy::{Remedy, Setting, Task};
use armid::seed::Seed;
use armid_io::{Error, LoadedRobot};
use serde::Serialize;

use super::read_back::{STATES, largest_difference};
use crate::payload::columns_of;

/// Relative difference that rounding explains.
const ROUNDING: f64 = 1e-9;

/// Source code of an identified arm. It serialises to the keys of the command's answer.
#[derive(Clone, Debug, Serialize)]
pub struct SourceFile {
    /// Name of the robot.
    pub robot: String,
    /// The estimator.
    pub estimator: String,
    /// Name of the language.
    pub to: &'static str,
    /// Where the text will stand.
    pub file: Option<PathBuf>,
    /// The file.
    #[serde(skip)]
    pub text: String,
    /// Additions and multiplications of inverse dynamics.
    pub operations: usize,
    /// The base parameters.
    pub base: Vec<BaseEstimate>,
    /// Whether the file has accelerations too: not where friction depends on the load.
    pub forward_dynamics: bool,
    /// The operations against the regressor.
    pub reload: Recomputed,
    /// Joints whose constant offset the gravity torque has: no motion tells them apart.
    pub offset_in_gravity: Vec<String>,
    /// What was read of the robot otherwise than it is written.
    pub remarks: Vec<String>,
}

/// What source code computes, against `Y_b β`.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Recomputed {
    /// Random states.
    pub states: usize,
    /// Largest difference over the largest torque of the joint.
    pub largest_relative_difference: f64,
}

/// Writes an estimate, which errors call `name`, as source code that will stand in `file`.
///
/// # Errors
/// [`Error`] where the estimate is of another robot, lacks base parameters, or has terms that source code has not.
pub fn export_source(
    estimate: &Estimate,
    name: &str,
    loaded: &LoadedRobot,
    language: Language,
    file: Option<PathBuf>,
) -> Result<SourceFile, Error> {
    let columns = columns_of(estimate, name)?;
    // With the shape parameters of the estimate.
    let robot = &estimate.robot(&loaded.robot, columns).map_err(|error| Error::mismatch(format!("{name}: {error}")))?;
    let base = reduce(robot, columns, Method::Structural, Seed::new(0))
        .map_err(|error| Error::new(format!("robot \"{}\": {error}", robot.name())))?;
    if estimate.names() != base.names() {
        let fault = EstimationError::OtherBase { found: estimate.names(), expected: base.names() };
        let help =
            Remedy::from("identify with every joint moving; ").perform(Task::Identify, "").option(Setting::List, "");
        let help = help.say(" names the estimators of all parameters");
        return Err(Error::new(format!("{name}: {fault}")).help(help));
    }
    let model = BaseModel::new(robot, &base, &estimate.beta()).map_err(|fault| {
        Error::new(format!("{name}: {fault}")).help(Remedy::from("identify with other ").setting(Setting::Columns))
    })?;
    let of = |joint: &usize| robot.joints()[*joint].name.clone();
    Ok(SourceFile {
        robot: estimate.robot.clone(),
        estimator: estimate.estimator.clone(),
        to: language.name(),
        file,
        text: model.source(language, &header(estimate, robot)),
        operations: model.operations(),
        forward_dynamics: model.has_forward_dynamics(),
        base: estimate.base.clone(),
        reload: Recomputed { states: STATES, largest_relative_difference: difference(&model, estimate, &base, robot) },
        offset_in_gravity: model.offset_in_weight.iter().map(of).collect(),
        remarks: loaded.remarks.clone(),
    })
}

impl SourceFile {
    /// Whether the operations are the model.
    pub fn is_sound(&self) -> bool {
        self.reload.largest_relative_difference <= ROUNDING
    }
}

/// The comment at the top: whose it is, the joints, the base parameters.
fn header(estimate: &Estimate, robot: &Robot) -> String {
    let mut text = format!(
        "{} identified by {} ({} columns, {} samples, {} periods); armid {}.\nJoints, in the order of every list:",
        estimate.robot,
        estimate.estimator,
        estimate.columns,
        estimate.samples,
        estimate.periods,
        env!("CARGO_PKG_VERSION"),
    );
    for joint in robot.joints() {
        let _ = write!(text, "\n  {} ({})", joint.name, joint.kind.unit());
    }
    text.push_str("\nBase parameters, with standard deviations:");
    for parameter in &estimate.base {
        let _ =
            write!(text, "\n  {} = {:?} ± {:.2e} {}", parameter.name, parameter.value, parameter.std, parameter.unit);
    }
    text
}

/// Largest difference of the operations from the regressor times the base parameters in their places.
fn difference(model: &BaseModel, estimate: &Estimate, base: &BaseReduction, robot: &Robot) -> f64 {
    let Some(columns) = armid::model::Columns::parse(&estimate.columns) else { return f64::INFINITY };
    let Ok(regressor) = estimate.regressor(robot, columns) else { return f64::INFINITY };
    let mut phi = vec![0.0; base.parameters.len()];
    for (&column, value) in base.kept.iter().zip(&estimate.base) {
        phi[column] = value.value;
    }
    largest_difference(&regressor, &phi, |q, qd, qdd, tau| model.inverse_dynamics(q, qd, qdd, tau))
}
