//! An estimate as source code, and its operations against the regressor.

use std::fmt::Write;

use armid::base::BaseReduction;
use armid::codegen::{BaseModel, Language};
use armid::conformance::chains::random_state;
use armid::estimation::{Estimate, EstimationError};
use armid::model::Robot;
use armid::seed::Seed;
use armid_io::{Error, LoadedRobot};
use serde_json::json;

use crate::terminal::{Answer, Destination, number};

/// States at which the operations are compared.
const STATES: usize = 200;

/// Relative difference that rounding explains.
const ROUNDING: f64 = 1e-9;

/// Source code of an identified arm.
pub(crate) struct SourceAnswer<'a> {
    estimate: &'a Estimate,
    language: Language,
    /// The file.
    pub(crate) text: String,
    operations: usize,
    /// Largest difference of the operations from `Y_b β`, over the largest torque of the joint.
    difference: f64,
    /// Joints whose constant offset the gravity torque has.
    offset_in_weight: Vec<String>,
    remarks: Vec<String>,
}

impl<'a> SourceAnswer<'a> {
    /// The source of an estimate, which errors call `name`.
    pub(crate) fn new(
        name: &str,
        estimate: &'a Estimate,
        base: &BaseReduction,
        loaded: &LoadedRobot,
        language: Language,
    ) -> Result<Self, Error> {
        let robot = &loaded.robot;
        if estimate.names() != base.names() {
            let fault = EstimationError::OtherBase { found: estimate.names(), expected: base.names() };
            let help =
                "identify with every joint moving; `armid identify --list` names the estimators of all parameters";
            return Err(Error::new(format!("{name}: {fault}")).help(help));
        }
        let model = BaseModel::new(robot, base, &estimate.beta())
            .map_err(|fault| Error::new(format!("{name}: {fault}")).help("identify with other --columns"))?;
        let of = |joint: &usize| robot.joints()[*joint].name.clone();
        Ok(Self {
            estimate,
            language,
            text: model.source(language, &header(estimate, robot)),
            operations: model.operations(),
            difference: difference(&model, estimate, base, robot),
            offset_in_weight: model.offset_in_weight().iter().map(of).collect(),
            remarks: loaded.remarks.clone(),
        })
    }

    /// Whether the operations are the model.
    pub(crate) fn is_sound(&self) -> bool {
        self.difference <= ROUNDING
    }

    pub(crate) fn answer(&self, destination: &Destination) -> Answer {
        let estimate = self.estimate;
        let mut text = format!("{destination}\n{}: inverse dynamics of {} operations", estimate.robot, self.operations);
        let _ = writeln!(text, " in {} base parameters, gravity torque, mass matrix", estimate.base.len());
        let _ = writeln!(
            text,
            "its torque is that of the regressor to {} of the largest, over {STATES} random states",
            number(self.difference)
        );
        for joint in &self.offset_in_weight {
            let _ = writeln!(
                text,
                "the gravity torque of joint \"{joint}\" has its constant offset: no motion tells them apart"
            );
        }
        for remark in &self.remarks {
            let _ = writeln!(text, "{remark}");
        }
        let json = json!({
            "robot": estimate.robot,
            "estimator": estimate.estimator,
            "to": self.language.name(),
            "file": destination.path(),
            "operations": self.operations,
            "base": estimate.base,
            "reload": { "states": STATES, "largest_relative_difference": self.difference },
            "offset_in_gravity": self.offset_in_weight,
            "remarks": self.remarks,
        });
        Answer { text, json }
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
    let n = robot.dof();
    let Some(columns) = armid::model::Columns::parse(&estimate.columns) else { return f64::INFINITY };
    let Ok(regressor) = estimate.regressor(robot, columns) else { return f64::INFINITY };
    let mut phi = vec![0.0; base.parameters.len()];
    for (&column, value) in base.kept.iter().zip(&estimate.base) {
        phi[column] = value.value;
    }
    let (mut y, mut tau) = (vec![0.0; n * phi.len()], vec![0.0; n]);
    let (mut largest, mut differences) = (vec![0.0_f64; n], vec![0.0_f64; n]);
    let mut rng = Seed::new(0).stream("read back", 0);
    for _ in 0..STATES {
        let (q, qd, qdd) = random_state(&mut rng, n);
        regressor.evaluate(&q, &qd, &qdd, &mut y);
        model.inverse_dynamics(&q, &qd, &qdd, &mut tau);
        for (i, row) in y.chunks_exact(phi.len()).enumerate() {
            let expected: f64 = row.iter().zip(&phi).map(|(y, phi)| y * phi).sum();
            largest[i] = largest[i].max(expected.abs());
            differences[i] = differences[i].max((tau[i] - expected).abs());
        }
    }
    let relative = differences.iter().zip(&largest).map(|(d, size)| d / size.max(f64::MIN_POSITIVE));
    relative.fold(0.0, f64::max)
}
