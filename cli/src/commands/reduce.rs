//! `armid reduce`

use std::fmt::Write;

use armid::base::{BaseMotion, Category, Method};
use armid::model::Columns;
use armid_io::Error;
use armid_workflow::{ReductionAnswer, ReductionSettings, reduce};
use miette::Result;

use crate::arguments::{RobotArguments, columns, one_of};
use crate::terminal::{Answer, Console, Ending, Table};

const AFTER_HELP: &str = "\
All methods give the same base parameters: `structural` walks over the links without random numbers, `qr` \
factorises the regressor of random states, `paper` follows Radkhah et al. (2007). Columns that no torque \
sensor can tell apart (below 1e-6) are left out with a finding.

Examples:
  armid reduce crs-a460
  armid reduce crs-a460 --columns rigid+rotor+friction --json
  armid reduce crs-a460 --trajectory T.toml
  armid reduce crs-a460 --base moving";

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
    /// Motion of the base: known, without a measured base force
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
    let settings = ReductionSettings {
        columns: arguments.columns,
        method: arguments.method,
        trajectory: arguments.trajectory.clone(),
        base: arguments.base,
        seed: arguments.seed,
    };
    let answer = reduce(&arguments.robot.load()?, &settings)?;
    console.answer(&Answer { text: text(&answer), json: serde_json::to_value(&answer).map_err(Error::new)? })?;
    Ok(Ending::Done)
}

fn text(ReductionAnswer { robot, columns, base, expressions, trajectory, findings }: &ReductionAnswer) -> String {
    let mut text = format!(
        "{}: {} base parameters of {} ({})\nmethod {}, base {}{}\n\n",
        robot.name(),
        base.rank(),
        base.parameters.len(),
        columns,
        base.method.name(),
        base.base_motion.name(),
        trajectory.as_ref().map_or_else(String::new, |name| format!(", on {name}")),
    );
    let meaning = |category| match category {
        Category::Unidentifiable => "no torque shows them",
        Category::Identifiable => "found alone",
        Category::Representative => "each stands for a combination",
        Category::Combination => "found only within these combinations",
    };
    let mut counts = Table::of("category | #number | meaning");
    for category in Category::ALL {
        counts.row([category.name(), &base.count(category).to_string(), meaning(category)]);
    }
    text.push_str(&counts.render(2));
    for category in Category::ALL {
        if category == Category::Representative || base.count(category) == 0 {
            continue;
        }
        let of_category = base.parameters.iter().zip(&base.categories).filter(|(_, found)| **found == category);
        let names: Vec<String> = of_category.map(|(id, _)| id.to_string()).collect();
        let mut list = Table::of(category.name());
        list.row([names.join(" ")]);
        let _ = write!(text, "\n{}", list.render(2));
    }
    if base.count(Category::Representative) > 0 {
        let mut combinations = Table::of("representative | base parameter");
        for (row, &column) in base.kept.iter().enumerate() {
            if base.categories[column] == Category::Representative {
                combinations.row([base.parameters[column].to_string(), expressions[row].clone()]);
            }
        }
        let _ = write!(text, "\n{}", combinations.render(2));
    }
    for finding in findings {
        let _ = write!(text, "\n{finding}\n");
    }
    text
}
