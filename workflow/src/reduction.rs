//! Which combinations of parameters does torque reveal?

use std::collections::BTreeMap;

use armid::base::{BaseMotion, BaseReduction, Category, Method, reduce_on, reduce_with_base};
use armid::model::{Columns, Robot};
use armid::seed::Seed;
use armid_io::{Error, LoadedRobot, trajectory};
use serde::{Serialize, Serializer};
use serde_json::json;

/// Samples of a trajectory over one period.
const SAMPLES: usize = 1000;

/// How base parameters are found.
#[derive(Clone, Debug)]
pub struct ReductionSettings {
    /// Parameters of the model.
    pub columns: Columns,
    /// The method; by default the structural one, or `paper` on a motion.
    pub method: Option<Method>,
    /// The motion, by name or file, whose base is sought; that of all motions where `None`.
    pub trajectory: Option<String>,
    /// How the robot's base moves.
    pub base: BaseMotion,
    /// Seed of the random states of the methods that draw them.
    pub seed: u64,
}

impl Default for ReductionSettings {
    fn default() -> Self {
        Self { columns: Columns::RIGID, method: None, trajectory: None, base: BaseMotion::Fixed, seed: 1 }
    }
}

/// Base parameters of a robot. It serialises to the keys of the command's answer.
#[derive(Clone, Debug)]
pub struct ReductionAnswer {
    /// The robot.
    pub robot: Robot,
    /// Parameters of the model.
    pub columns: Columns,
    /// The base parameters.
    pub base: BaseReduction,
    /// Each as a formula in the robot's lengths.
    pub expressions: Vec<String>,
    /// The motion that they are of.
    pub trajectory: Option<String>,
    /// What was read of the robot otherwise than it is written, and columns that no torque sensor tells apart.
    pub findings: Vec<String>,
}

/// Finds the base parameters of a robot.
///
/// # Errors
/// [`Error`] where the motion cannot be read or is given for a moving base, or the robot has no base parameters.
pub fn reduce(loaded: &LoadedRobot, settings: &ReductionSettings) -> Result<ReductionAnswer, Error> {
    let ReductionSettings { columns, method, trajectory, base, seed } = settings;
    let robot = &loaded.robot;
    let reduction = match trajectory {
        None if *base == BaseMotion::Fixed => {
            armid::base::reduce(robot, *columns, method.unwrap_or_default(), Seed::new(*seed))
        }
        None => reduce_with_base(robot, *columns, *base, method.unwrap_or_default(), Seed::new(*seed)),
        Some(name) if *base == BaseMotion::Fixed => {
            let states = trajectory::load(name, None, robot)?.sample(SAMPLES);
            reduce_on(robot, *columns, method.unwrap_or(Method::Radkhah2007), &states)
        }
        Some(_) => {
            return Err(Error::new(format!("found a trajectory with base {}, expected a fixed base", base.name())));
        }
    };
    let base = reduction.map_err(Error::new)?;
    let findings = loaded.remarks.iter().cloned().chain(base.nearly_dependent.iter().map(ToString::to_string));
    Ok(ReductionAnswer {
        robot: robot.clone(),
        columns: *columns,
        findings: findings.collect(),
        expressions: base.expressions(robot),
        base,
        trajectory: trajectory.clone(),
    })
}

impl Serialize for ReductionAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let base = &self.base;
        let (names, expressions) = (base.names(), &self.expressions);
        let parameters = base.parameters.iter().zip(&base.categories);
        let row = |row: usize| {
            let term = |(id, coefficient): (armid::model::ParameterId, f64)| json!({ "parameter": id.to_string(), "coefficient": coefficient });
            let terms: Vec<_> = base.terms(row).into_iter().map(term).collect();
            json!({ "name": names[row], "expression": expressions[row], "terms": terms })
        };
        json!({
            "robot": self.robot.name(),
            "columns": self.columns.to_string(),
            "method": base.method.name(),
            "base_motion": base.base_motion.name(),
            "trajectory": self.trajectory,
            "rank": base.rank(),
            "structural_rank": base.nearly_dependent.as_ref().map_or(base.rank(), |left_out| left_out.structural_rank),
            "findings": self.findings,
            "counts": Category::ALL.map(|c| (c.name(), base.count(c))).into_iter().collect::<BTreeMap<_, _>>(),
            "parameters": parameters
                .map(|(id, category)| json!({ "name": id.to_string(), "category": category.name() }))
                .collect::<Vec<_>>(),
            "base": (0..base.rank()).map(row).collect::<Vec<_>>(),
        })
        .serialize(serializer)
    }
}
