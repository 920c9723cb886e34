//! `armid dynamics`

use std::fmt::Write;
use std::path::PathBuf;

use armid::model::{Columns, Robot, StandardParameters};
use armid_io::table::{Third, parse_states};
use armid_io::{Error, LoadedRobot, Text};
use armid_workflow::{DynamicsAnswer, Quantity, dynamics, regressor};
use miette::Result;

use crate::arguments::{RobotArguments, columns, one_of, read_parameter_map};
use crate::terminal::{Answer, Console, Ending};

const AFTER_HELP: &str = "\
S.csv has the headings q1..qn,qd1..qdn,qdd1..qddn in rad, rad/s, rad/s² (m for prismatic joints). For \
`acceleration`, tau1..taun in N·m (N) replace qdd. The answer is a CSV:

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
    /// Parameters: name → value, TOML or JSON
    #[arg(long, value_name = "P")]
    parameters: Option<PathBuf>,
    /// Columns of the regressor
    #[arg(long, default_value = "rigid", value_parser = columns)]
    columns: Columns,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let loaded = arguments.robot.load()?;
    let third = if arguments.quantity == Quantity::Acceleration { Third::Effort } else { Third::Acceleration };
    let states = parse_states(Text::read(&arguments.states)?, loaded.robot.dof(), third)?;
    let numbers = match arguments.quantity {
        Quantity::Regressor => regressor(&loaded.robot, arguments.columns, &states)?,
        quantity => {
            let (parameters, robot) = parameters(&loaded, arguments)?;
            dynamics(&robot, &parameters, quantity, &states)?
        }
    };
    console.answer(&Answer { text: csv(&numbers), json: serde_json::to_value(&numbers).map_err(Error::new)? })?;
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

/// Every number with the digits that bring back its bits.
fn csv(numbers: &DynamicsAnswer) -> String {
    let mut text = numbers.headings.join(",");
    text.push('\n');
    for row in &numbers.rows {
        for (k, value) in row.iter().enumerate() {
            let _ = write!(text, "{}{value}", if k == 0 { "" } else { "," });
        }
        text.push('\n');
    }
    text
}
