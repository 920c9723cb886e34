//! `armid trajectory`

use std::fmt::Write;
use std::path::{Path, PathBuf};

use armid::experiment::{ExperimentPlan, PlanError};
use armid::model::Robot;
use armid::trajectory::{PeriodicTrajectory, TrajectoryError};
use armid_io::{Error, Text, experiment};
use armid_workflow::{PointFormat, SetPoints};
use miette::Result;

use crate::arguments::{ChainArguments, one_of};
use crate::arms::Speed;
use crate::terminal::{Answer, Console, Ending, Table, report_folder, stated};

const AFTER_HELP: &str = "\
FILE is an experiment, or a trajectory alone. A trajectory alone gets --settle, --ramp and --periods, and \
--robot names the arm whose limits of position, speed and acceleration are checked.

  csv               t,q1..qn,qd1..qdn,qdd1..qddn in s, rad, rad/s, rad/s² (m)
  joint-trajectory  trajectory_msgs/JointTrajectory of ROS 2, as JSON, which is YAML too
  urscript          a program for Universal Robots: movej to the beginning, then servoj

The arm must stand where the motion begins. armid guards nothing here: the controller has to.

Examples:
  armid trajectory sample T.toml --robot arm.urdf --rate 500 -o points.csv
  armid trajectory sample experiment.toml --rate 500 --to urscript -o motion.script";

/// Write a motion for the controller of any robot
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  armid trajectory sample T.toml --robot arm.urdf --rate 500 -o points.csv")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    Sample(Sample),
}

/// Write the set-points of a trajectory or experiment
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
struct Sample {
    /// An experiment or a trajectory
    file: PathBuf,
    /// Set-points in a second
    #[arg(long, value_name = "HZ")]
    rate: f64,
    /// Format of the file
    #[arg(long, default_value = "csv", value_parser = one_of(&PointFormat::ALL, PointFormat::name))]
    to: PointFormat,
    /// Share of the designed speed, such as 10%, on the same path
    #[arg(long, value_name = "PERCENT")]
    speed: Option<Speed>,
    /// Periods of the motion
    #[arg(long)]
    periods: Option<usize>,
    /// Time from rest into the motion, and back, s
    #[arg(long, value_name = "SECONDS")]
    ramp: Option<f64>,
    /// Time at rest before it, s
    #[arg(long, value_name = "SECONDS")]
    settle: Option<f64>,
    /// The arm whose limits a trajectory must keep
    #[arg(long)]
    robot: Option<String>,
    #[command(flatten)]
    chain: ChainArguments,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let What::Sample(sample) = &arguments.what;
    let (mut plan, mut robot) = read(&sample.file)?;
    if let Some(name) = &sample.robot {
        robot = Some(sample.chain.load(name)?.robot);
    }
    plan.rate_hz = sample.rate;
    plan.periods = sample.periods.unwrap_or(plan.periods);
    plan.ramp_s = sample.ramp.unwrap_or(plan.ramp_s);
    plan.settle_s = sample.settle.unwrap_or(plan.settle_s);
    let speed = sample.speed.unwrap_or(Speed::FULL).in_whole_samples(plan.trajectory.period_s(), plan.rate_hz);
    let plan = plan.at_speed(speed.part());
    let named = |fault: PlanError| Error::new(format!("{}: {fault}", sample.file.display()));
    if let Some(robot) = &robot {
        plan.check_limits(robot).map_err(named)?;
    }
    let points = SetPoints::new(&plan)?;
    let destination = console.text_or(|| {
        let name = sample.file.file_stem().map_or_else(|| "motion".into(), |stem| stem.to_string_lossy().into_owned());
        Ok(report_folder("name of the trajectory", &name)?.join(format!("points.{}", sample.to.extension())))
    })?;
    console.deliver(&destination, &points.text(sample.to)?)?;
    let text = format!("{destination}\n{}", words(&points, robot.as_ref().map(Robot::name)));
    console.show(&Answer { text, json: serde_json::to_value(&points).map_err(Error::new)? })?;
    Ok(Ending::Done)
}

/// The plan of an experiment and its robot, or a trajectory with the usual plan around it.
fn read(path: &Path) -> Result<(ExperimentPlan, Option<Robot>), Error> {
    let is_experiment = path.is_dir() || {
        let text = Text::read(path)?;
        toml::from_str::<toml::Table>(&text.content).is_ok_and(|table| table.contains_key("trajectory"))
    };
    if is_experiment {
        let found = experiment::load(&path.to_string_lossy())?;
        return Ok((found.plan, Some(found.robot.robot)));
    }
    let text = Text::read(path)?;
    let trajectory = PeriodicTrajectory::from_toml(&text.content).map_err(|fault| match fault {
        TrajectoryError::File { line, column, message } => Error::new(message).at_line(&text, line, column),
        other => Error::new(format!("{}: {other}", text.name)),
    })?;
    Ok((ExperimentPlan::new(trajectory), None))
}

fn words(points: &SetPoints, robot: Option<&str>) -> String {
    let mut text = format!(
        "{} points at {} Hz, {} s from rest to rest; periods of {} s from {} s\n",
        points.rows.len(),
        stated(points.rate_hz),
        stated(points.duration_s),
        stated(points.period_s),
        stated(points.periodic_from_s)
    );
    let mut table = Table::of("joint | #begins at, rad (m) | #largest speed, rad/s | #largest acceleration, rad/s²");
    for ((joint, start), [_, speed, acceleration]) in points.joints.iter().zip(&points.rows[0]).zip(&points.largest) {
        table.row([joint.clone(), stated(*start), stated(*speed), stated(*acceleration)]);
    }
    text.push_str(&table.render(2));
    let _ = match robot {
        Some(robot) => {
            writeln!(text, "inside the position, speed and acceleration limits of \"{robot}\" at every point")
        }
        None => writeln!(text, "no limits were checked: --robot names the arm"),
    };
    text
}
