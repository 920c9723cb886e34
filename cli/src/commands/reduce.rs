//! `armid reduce`

use std::fmt::Write;

use armid::base::{BaseMotion, BaseReduction, Category, Method, reduce, reduce_on, reduce_with_base};
use armid::model::{Columns, Robot};
use armid::seed::Seed;
use armid_io::{Error, trajectory};
use miette::Result;
use serde_json::json;

use crate::arguments::{RobotArguments, columns, one_of};
use crate::terminal::{Align, Answer, Console, Ending, Table};

const AFTER_HELP: &str = "\
The methods give the same base parameters: `structural` is a recursion over the links without random
numbers, `qr` factorises a regressor of random states, `paper` takes steps 1 to 5 of Radkhah et al.
(2007). Columns that no torque sensor tells from the others, by 1e-6 over random states, are left out
with a finding. With --trajectory the categories are those of that motion alone (`paper` or `qr`).

Examples:
  armid reduce crs-a460
  armid reduce crs-a460 --columns rigid+rotor+friction --json
  armid reduce crs-a460 --trajectory T.toml
  armid reduce crs-a460 --base moving";

/// Samples of a trajectory over one period.
const SAMPLES: usize = 1000;

/// Find the base parameters: the combinations that torque identifies
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Method
    #[arg(long, value_parser = one_of(&Method::ALL, Method::name))]
    method: Option<Method>,
    /// Categories for this trajectory: a TOML file, or table-one
    #[arg(long, value_name = "T.toml")]
    trajectory: Option<String>,
    /// How the robot's base moves; its motion is known, the force on it is not
    #[arg(long, default_value = "fixed", value_parser = one_of(&BaseMotion::ALL, BaseMotion::name))]
    base: BaseMotion,
    /// Which parameters the model has
    #[arg(long, default_value = "rigid", value_parser = columns)]
    columns: Columns,
    /// Seed of the random states of `paper` and `qr`
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let loaded = arguments.robot.load()?;
    let robot = &loaded.robot;
    let columns = arguments.columns;
    let refused = |message: String| -> Result<BaseReduction> { Err(Error::new(message).into()) };
    let reduction = match (&arguments.trajectory, arguments.base) {
        (None, BaseMotion::Fixed) => {
            let method = arguments.method.unwrap_or_default();
            reduce(robot, columns, method, Seed::new(arguments.seed)).map_err(|error| Error::new(error.to_string()))?
        }
        (None, motion) => {
            let (method, seed) = (arguments.method.unwrap_or_default(), Seed::new(arguments.seed));
            reduce_with_base(robot, columns, motion, method, seed).map_err(|error| Error::new(error.to_string()))?
        }
        (Some(name), BaseMotion::Fixed) => {
            let states = trajectory::load(name, None, robot)?.sample(SAMPLES);
            let method = arguments.method.unwrap_or(Method::Radkhah2007);
            reduce_on(robot, columns, method, &states).map_err(|error| Error::new(error.to_string()))?
        }
        (Some(_), motion) => refused(format!("--trajectory with --base {}, expected a fixed base", motion.name()))?,
    };
    console.answer(&answer(robot, columns, &reduction, arguments.trajectory.as_deref(), &loaded.remarks))?;
    Ok(Ending::Done)
}

fn answer(
    robot: &Robot,
    columns: Columns,
    base: &BaseReduction,
    trajectory: Option<&str>,
    remarks: &[String],
) -> Answer {
    let names = base.names();
    let expressions = base.expressions(robot);
    let parameters: Vec<_> = base
        .parameters
        .iter()
        .zip(&base.categories)
        .map(|(id, category)| json!({ "name": id.to_string(), "category": category.name() }))
        .collect();
    let rows: Vec<_> = (0..base.rank())
        .map(|row| {
            let terms: Vec<_> = base
                .terms(row)
                .into_iter()
                .map(|(id, coefficient)| json!({ "parameter": id.to_string(), "coefficient": coefficient }))
                .collect();
            json!({ "name": names[row], "expression": expressions[row], "terms": terms })
        })
        .collect();
    let json = json!({
        "robot": robot.name(),
        "columns": columns.to_string(),
        "method": base.method.name(),
        "base_motion": base.base_motion.name(),
        "trajectory": trajectory,
        "rank": base.rank(),
        "structural_rank": base.nearly_dependent.as_ref().map_or(base.rank(), |left_out| left_out.structural_rank),
        "findings": remarks.iter().cloned().chain(base.nearly_dependent.iter().map(ToString::to_string)).collect::<Vec<_>>(),
        "counts": Category::ALL.map(|c| (c.name(), base.count(c))).into_iter().collect::<std::collections::BTreeMap<_, _>>(),
        "parameters": parameters,
        "base": rows,
    });
    let mut text = text(robot, columns, base, trajectory, &expressions);
    for finding in remarks.iter().cloned().chain(base.nearly_dependent.iter().map(ToString::to_string)) {
        let _ = write!(text, "\n{finding}\n");
    }
    Answer { text, json }
}

fn text(
    robot: &Robot,
    columns: Columns,
    base: &BaseReduction,
    trajectory: Option<&str>,
    expressions: &[String],
) -> String {
    let mut text = format!(
        "{}: {} base parameters of {} ({})\nmethod {}, base {}{}\n\n",
        robot.name(),
        base.rank(),
        base.parameters.len(),
        columns,
        base.method.name(),
        base.base_motion.name(),
        trajectory.map_or_else(String::new, |name| format!(", on {name}")),
    );
    let meaning = |category| match category {
        Category::Unidentifiable => "no torque shows them",
        Category::Identifiable => "found alone",
        Category::Representative => "each stands for a combination",
        Category::Combination => "found only within these combinations",
    };
    let mut counts = Table::new(&[("category", Align::Left), ("number", Align::Right), ("meaning", Align::Left)]);
    for category in Category::ALL {
        counts.row([category.name(), &base.count(category).to_string(), meaning(category)]);
    }
    text.push_str(&counts.render(2));
    for category in Category::ALL {
        if category == Category::Representative || base.count(category) == 0 {
            continue;
        }
        let names: Vec<String> = base
            .parameters
            .iter()
            .zip(&base.categories)
            .filter(|(_, found)| **found == category)
            .map(|(id, _)| id.to_string())
            .collect();
        let mut list = Table::new(&[(category.name(), Align::Left)]);
        list.row([names.join(" ")]);
        let _ = write!(text, "\n{}", list.render(2));
    }
    if base.count(Category::Representative) > 0 {
        let mut combinations = Table::new(&[("representative", Align::Left), ("base parameter", Align::Left)]);
        for (row, &column) in base.kept.iter().enumerate() {
            if base.categories[column] == Category::Representative {
                combinations.row([base.parameters[column].to_string(), expressions[row].clone()]);
            }
        }
        let _ = write!(text, "\n{}", combinations.render(2));
    }
    text
}
