//! `armid dynamics`

use std::fmt::Write;
use std::path::PathBuf;

use armid::dynamics::{Dynamics, States};
use armid::model::{Columns, Robot, StandardParameters};
use armid::regressor::JointTorqueRegressor;
use armid_io::table::{Third, parse_states};
use armid_io::{Error, LoadedRobot, Text};
use miette::Result;
use serde_json::{Value, json};

use crate::arguments::{RobotArguments, columns, one_of, read_parameter_map};
use crate::terminal::{Answer, Console, Ending};

const AFTER_HELP: &str = "\
S.csv has the headings q1..qn,qd1..qdn,qdd1..qddn, in rad, rad/s, rad/s² (m for a prismatic
joint); for `acceleration` tau1..taun, in N·m (N), stand in place of qdd. The answer is a CSV:

  torque         tau1..taun
  acceleration   qdd1..qddn
  mass-matrix    sample,row,m1..mn
  regressor      sample,joint,<parameter names>

Samples count from 0, joints and rows from 1.

P maps parameter names to values, TOML (mcx2 = 0.1) or JSON; those it leaves out are zero.

Examples:
  armid dynamics crs-a460 --states S.csv --quantity torque --parameters P.toml -o tau.csv
  armid dynamics crs-a460 --states S.csv --quantity regressor --columns rigid+rotor+friction
  armid dynamics arm.urdf --states S.csv --quantity mass-matrix";

/// What is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Torque,
    Regressor,
    MassMatrix,
    Acceleration,
}

impl Quantity {
    const ALL: [Self; 4] = [Self::Torque, Self::Regressor, Self::MassMatrix, Self::Acceleration];

    const fn name(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Regressor => "regressor",
            Self::MassMatrix => "mass-matrix",
            Self::Acceleration => "acceleration",
        }
    }
}

/// Evaluate the model on states
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// States: one row per sample
    #[arg(long, value_name = "S.csv")]
    states: PathBuf,
    /// What to evaluate
    #[arg(long, value_parser = one_of(&Quantity::ALL, Quantity::name))]
    quantity: Quantity,
    /// Parameter name → value, TOML or JSON; a URDF or MJCF has its own
    #[arg(long, value_name = "P")]
    parameters: Option<PathBuf>,
    /// Columns of the regressor
    #[arg(long, default_value = "rigid", value_parser = columns)]
    columns: Columns,
}

/// A table of numbers with headings; the first columns are counts.
struct Numbers {
    headings: Vec<String>,
    counts: usize,
    rows: Vec<Vec<f64>>,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let loaded = arguments.robot.load()?;
    let third = if arguments.quantity == Quantity::Acceleration { Third::Effort } else { Third::Acceleration };
    let states = parse_states(Text::read(&arguments.states)?, loaded.robot.dof(), third)?;
    let numbers = match arguments.quantity {
        Quantity::Regressor => regressor(&loaded, arguments.columns, &states)?,
        quantity => {
            let (parameters, robot) = parameters(&loaded, arguments)?;
            with_parameters(&robot, &parameters, quantity, &states)
        }
    };
    let json = json!({
        "robot": loaded.robot.name(),
        "quantity": arguments.quantity.name(),
        "headings": numbers.headings,
        "rows": numbers.rows.iter().map(|row| numbers.json_row(row)).collect::<Vec<_>>(),
    });
    console.answer(&Answer { text: numbers.csv(), json })?;
    Ok(Ending::Done)
}

/// The parameters, and the robot with the laws of friction that they are of.
fn parameters(loaded: &LoadedRobot, arguments: &Arguments) -> Result<(StandardParameters, Robot)> {
    if let Some(path) = &arguments.parameters {
        return Ok(read_parameter_map(path, &loaded.robot)?);
    }
    loaded.own.clone().map(|own| (own, loaded.robot.clone())).ok_or_else(|| {
        let message = format!(
            "--quantity {} of \"{}\" needs --parameters: its file has kinematics, limits and drives, and no inertia",
            arguments.quantity.name(),
            loaded.robot.name()
        );
        Error::new(message).help("expected a TOML or JSON map of parameter name → value, such as mcx2 = 0.1").into()
    })
}

fn with_parameters(robot: &Robot, parameters: &StandardParameters, quantity: Quantity, states: &States) -> Numbers {
    let n = robot.dof();
    let mut dynamics = Dynamics::new(robot, parameters);
    let mut rows = Vec::new();
    let numbered = |prefix: &str| (1..=n).map(|k| format!("{prefix}{k}")).collect::<Vec<_>>();
    for k in 0..states.len() {
        let (q, qd, third) = (states.q(k), states.qd(k), states.qdd(k));
        let mut out = vec![0.0; n];
        match quantity {
            Quantity::Acceleration => dynamics.forward(q, qd, third, &mut out),
            Quantity::MassMatrix => {
                let m = dynamics.mass_matrix(q);
                for i in 0..n {
                    rows.push([k as f64, (i + 1) as f64].into_iter().chain(m.row(i).iter().copied()).collect());
                }
                continue;
            }
            Quantity::Torque | Quantity::Regressor => dynamics.inverse(q, qd, third, &mut out),
        }
        rows.push(out);
    }
    match quantity {
        Quantity::Acceleration => Numbers { headings: numbered("qdd"), counts: 0, rows },
        Quantity::MassMatrix => {
            let headings = ["sample".to_owned(), "row".to_owned()].into_iter().chain(numbered("m")).collect();
            Numbers { headings, counts: 2, rows }
        }
        Quantity::Torque | Quantity::Regressor => Numbers { headings: numbered("tau"), counts: 0, rows },
    }
}

fn regressor(loaded: &LoadedRobot, columns: Columns, states: &States) -> Result<Numbers> {
    let regressor = JointTorqueRegressor::new(&loaded.robot, columns);
    let regressor = regressor.map_err(|fault| Error::new(format!("--columns {columns}: {fault}")))?;
    let (n, p) = (regressor.rows(), regressor.cols());
    let names = regressor.parameters().iter().map(ToString::to_string);
    let headings = ["sample".to_owned(), "joint".to_owned()].into_iter().chain(names).collect();
    let mut rows = Vec::with_capacity(states.len() * n);
    let mut y = vec![0.0; n * p];
    for k in 0..states.len() {
        regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut y);
        for (i, row) in y.chunks_exact(p).enumerate() {
            rows.push([k as f64, (i + 1) as f64].into_iter().chain(row.iter().copied()).collect());
        }
    }
    Ok(Numbers { headings, counts: 2, rows })
}

impl Numbers {
    /// Every number with the digits that bring back its bits.
    fn csv(&self) -> String {
        let mut text = self.headings.join(",");
        text.push('\n');
        for row in &self.rows {
            for (k, value) in row.iter().enumerate() {
                let _ = write!(text, "{}{value}", if k == 0 { "" } else { "," });
            }
            text.push('\n');
        }
        text
    }

    fn json_row(&self, row: &[f64]) -> Vec<Value> {
        let (counts, values) = row.split_at(self.counts);
        counts.iter().map(|&count| json!(count as u64)).chain(values.iter().map(|&value| json!(value))).collect()
    }
}
