//! `armid design`

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use armid::excitation::{
    CriterionKind, DEFAULT_EVALUATIONS, Design, DesignProblem, ExcitationError, Family, PeriodicTrajectory,
    Termination, WorstUse, best_of, design, random_design,
};
use armid::model::{Columns, JointKind, Robot};
use armid::seed::Seed;
use miette::Result;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::answer::{Answer, Ending};
use crate::atomic_file;
use crate::choices::one_of;
use crate::console::Console;
use crate::fault::Fault;
use crate::files::prior::set_prior;
use crate::robot_source::{LoadedRobot, RobotArguments};
use crate::table::{Align, Table, number};
use crate::{interrupt, progress};

const AFTER_HELP: &str = "\
Every start begins at the paper's first guess from other random velocities and may evaluate the
criterion --evaluations times (a gradient counts as one more); the best start within all limits is
kept. Position, velocity and acceleration hold at every instant, the torque that the nominal
parameters ask for stays below nine tenths of the ratings. Equal seed, equal trajectory.

The figures without a suffix are those of the rigid base columns, whatever was optimised; those
of the chosen columns are beside them under …_all.

Examples:
  armid design crs-a460 --criterion d-optimal -o T.toml
  armid design crs-a460 --criterion condition --columns rigid --starts 8 --seed 3 --json -o T.toml
  armid design crs-a460 --criterion d-optimal --prior E.json -o T2.toml
  armid design crs-a460 --criterion a-optimal --family cubic-b-spline --freeze wrist_roll=0 -o T.toml
  armid design arm.urdf --criterion condition-scaled --period 20 --harmonics 7 -o T.toml";

/// Design a trajectory that excites the parameters best within the limits
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// What is optimised
    #[arg(long, value_parser = one_of(&CriterionKind::ALL, CriterionKind::name))]
    criterion: CriterionKind,
    /// Which parameters are to be estimated
    #[arg(long, default_value = "rigid+rotor+friction", value_parser = one_of(&Columns::ALL, Columns::name))]
    columns: Columns,
    /// Short for --columns rigid
    #[arg(long, conflicts_with = "columns")]
    no_friction: bool,
    /// Period, s
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    period: f64,
    /// In which family of trajectories
    #[arg(long, default_value = "fourier", value_parser = one_of(&Family::ALL, Family::name))]
    family: Family,
    /// Harmonics of every joint, or a list with one number for each; splines have 2 N + 1 knots
    #[arg(long, value_name = "N", default_value = "5", value_delimiter = ',')]
    harmonics: Vec<usize>,
    /// Joint that stands still, and where, rad; parameters that then stay hidden are left out
    #[arg(long, value_name = "JOINT=RAD", value_delimiter = ',', value_parser = frozen_joint)]
    freeze: Vec<(String, f64)>,
    /// Seed of the first guesses
    #[arg(long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Independent starts
    #[arg(long, value_name = "N", default_value_t = 8)]
    starts: u64,
    /// Evaluations of the criterion that each start may use
    #[arg(long, value_name = "N", default_value_t = DEFAULT_EVALUATIONS)]
    evaluations: usize,
    /// Steps of the optimiser that each start may take
    #[arg(long, value_name = "N")]
    iterations: Option<usize>,
    /// Largest acceleration of every joint, in place of the robot's own limits
    #[arg(long, value_name = "RAD_S2")]
    max_acceleration: Option<f64>,
    /// Weight the rows of d-optimal by the noise of each joint's effort, from the robot's drives
    #[arg(long)]
    weighted: bool,
    /// Estimates of earlier experiments: the design adds to what they know, with the noise that they found
    #[arg(long, value_name = "E.json", num_args = 1.., conflicts_with = "weighted")]
    prior: Vec<PathBuf>,
    /// Do not hold the torque ratings
    #[arg(long)]
    ignore_torque: bool,
    /// Also draw as many random trajectories as a start may evaluate, and say what the best of them is worth
    #[arg(long)]
    baseline: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let loaded = arguments.robot.load()?;
    let problem = problem(arguments, &loaded)?;
    let began = Instant::now();
    let found = search(arguments, &problem, console)?;
    let seconds = began.elapsed().as_secs_f64();
    let interrupted = found.designs.len() < usize::try_from(arguments.starts).unwrap_or(usize::MAX);
    let Some(best) = best_of(&found.designs) else {
        return none_found(&found, &problem, interrupted, console);
    };
    let path = console.output().map_or_else(
        || {
            Path::new("reports")
                .join(format!("{}-{}", problem.robot.name(), best.criterion.name()))
                .join("trajectory.toml")
        },
        Path::to_path_buf,
    );
    atomic_file::write_text(&path, &best.trajectory.to_toml())?;
    let done = Done { arguments, problem: &problem, found: &found, best, seconds, path };
    console.show(&Answer { text: done.text(console.verbose()), json: done.json() })?;
    Ok(if interrupted { Ending::Interrupted } else { Ending::Done })
}

/// `wrist_roll=0.0` as a joint's name and its position.
fn frozen_joint(text: &str) -> std::result::Result<(String, f64), String> {
    let parts = text.split_once('=').and_then(|(name, place)| Some((name.to_owned(), place.parse::<f64>().ok()?)));
    parts.filter(|(_, place)| place.is_finite()).ok_or_else(|| "expected JOINT=RAD, as wrist_roll=0.0".to_owned())
}

fn impossible(error: &ExcitationError) -> Fault {
    Fault::new(error.to_string())
}

fn problem(arguments: &Arguments, loaded: &LoadedRobot) -> Result<DesignProblem> {
    let mut robot = loaded.robot.clone();
    if let Some(acceleration) = arguments.max_acceleration {
        robot = robot
            .with_joints(|joint| joint.limits.acceleration = acceleration)
            .map_err(|fault| Fault::new(format!("--max-acceleration: {fault}")))?;
    }
    if arguments.starts == 0 {
        return Err(Fault::new("--starts is 0, expected at least 1").into());
    }
    let columns = if arguments.no_friction { Columns::Rigid } else { arguments.columns };
    let mut problem = DesignProblem::new(robot, columns, arguments.criterion).map_err(|error| impossible(&error))?;
    problem.period_s = arguments.period;
    problem.family = arguments.family;
    problem.harmonics = match arguments.harmonics.as_slice() {
        [every] => vec![*every; problem.robot.dof()],
        each => each.to_vec(),
    };
    problem.samples = problem.samples.max(4 * problem.harmonics.iter().copied().max().unwrap_or(0));
    for (name, place) in &arguments.freeze {
        let names: Vec<&str> = problem.robot.joints().iter().map(|joint| joint.name.as_str()).collect();
        let Some(index) = names.iter().position(|known| known == name) else {
            let message = format!("--freeze names the joint \"{name}\", expected one of {}", names.join(", "));
            return Err(Fault::new(message).into());
        };
        problem.freeze(index, *place).map_err(|error| impossible(&error))?;
    }
    problem.max_evaluations = arguments.evaluations;
    problem.max_iterations = arguments.iterations.unwrap_or(problem.max_iterations);
    if !arguments.ignore_torque {
        problem.nominal = loaded.nominal.clone().or_else(|| loaded.own.clone());
    }
    if arguments.weighted {
        problem.sigma = Some(effort_noise(&problem.robot)?);
    }
    if !arguments.prior.is_empty() {
        if !arguments.criterion.is_weighted() {
            let message = format!(
                "--prior with --criterion {}, expected one of the information: d-optimal, a-optimal or e-optimal",
                arguments.criterion.name()
            );
            return Err(Fault::new(message).into());
        }
        set_prior(&mut problem, loaded, &arguments.prior)?;
    }
    Ok(problem)
}

/// Standard deviation of one sample of each joint's effort by the noise of its current sensor.
fn effort_noise(robot: &Robot) -> Result<Vec<f64>> {
    let noise: Vec<f64> =
        robot.joints().iter().map(|joint| joint.drive.current_noise * joint.drive.torque_per_ampere()).collect();
    match robot.joints().iter().zip(&noise).find(|(_, noise)| **noise <= 0.0) {
        Some((joint, _)) => {
            let message = format!("--weighted: the current of joint \"{}\" has no noise in the robot file", joint.name);
            Err(Fault::new(message).into())
        }
        None => Ok(noise),
    }
}

/// What came of the starts.
struct Found {
    designs: Vec<Design>,
    baseline: Option<Design>,
}

fn search(arguments: &Arguments, problem: &DesignProblem, console: &Console) -> Result<Found> {
    let seed = Seed::new(arguments.seed);
    let bar = progress::bar(console, arguments.starts, "starts");
    let designs: std::result::Result<Vec<Option<Design>>, ExcitationError> = (0..arguments.starts)
        .into_par_iter()
        .map(|start| {
            if interrupt::asked() {
                return Ok(None);
            }
            let found = design(problem, seed, start)?;
            bar.inc(1);
            Ok(Some(found))
        })
        .collect();
    bar.finish_and_clear();
    let designs = designs.map_err(|error| impossible(&error))?.into_iter().flatten().collect();
    let baseline = if arguments.baseline && !interrupt::asked() {
        Some(random_design(problem, seed, 0).map_err(|error| impossible(&error))?)
    } else {
        None
    };
    Ok(Found { designs, baseline })
}

/// No start found a trajectory within the limits.
fn none_found(found: &Found, problem: &DesignProblem, interrupted: bool, console: &Console) -> Result<Ending> {
    let mut table = Table::new(&[("start", Align::Right), ("ended", Align::Left)]);
    for (start, design) in found.designs.iter().enumerate() {
        table.row([start.to_string(), ending(design, &problem.robot)]);
    }
    let text = format!(
        "{}: no trajectory within the limits was found in {} start{}\n\n{}",
        problem.robot.name(),
        found.designs.len(),
        if found.designs.len() == 1 { "" } else { "s" },
        table.render(2)
    );
    let starts: Vec<Value> = found.designs.iter().map(start_json).collect();
    let json = json!({
        "criterion": problem.criterion.name(),
        "termination": if interrupted { "interrupted" } else { "infeasible" },
        "trajectory": null,
        "starts": starts,
    });
    console.show(&Answer { text, json })?;
    Ok(if interrupted { Ending::Interrupted } else { Ending::Negative })
}

/// How a start ended, in words.
fn ending(design: &Design, robot: &Robot) -> String {
    match &design.termination {
        Termination::Infeasible { limit, worst, .. } => format!("infeasible: {limit} {}", used(worst, limit, robot)),
        other => other.name().to_owned(),
    }
}

/// Where a limit is used most.
fn used(worst: &WorstUse, quantity: &str, robot: &Robot) -> String {
    let joint = &robot.joints()[worst.joint];
    let unit = match (quantity, joint.kind) {
        ("torque", kind) => kind.effort_unit().to_owned(),
        ("velocity", kind) => format!("{}/s", kind.unit()),
        ("acceleration", kind) => format!("{}/s²", kind.unit()),
        (_, JointKind::Revolute) => "rad".to_owned(),
        (_, JointKind::Prismatic) => "m".to_owned(),
    };
    let (value, limit) = (number(worst.value), number(worst.limit));
    format!("{value} of {limit} {unit} at joint \"{}\", t = {:.3} s", joint.name, worst.t)
}

fn start_json(design: &Design) -> Value {
    json!({
        "value": design.value,
        "termination": design.termination.name(),
        "iterations": design.iterations,
        "evaluations": design.evaluations,
    })
}

/// The trajectory under the keys of its file.
fn trajectory_json(trajectory: &PeriodicTrajectory) -> Value {
    toml::from_str(&trajectory.to_toml()).expect("a trajectory file is TOML with finite numbers")
}

struct Done<'a> {
    arguments: &'a Arguments,
    problem: &'a DesignProblem,
    found: &'a Found,
    best: &'a Design,
    seconds: f64,
    path: PathBuf,
}

impl Done<'_> {
    fn json(&self) -> Value {
        let (best, certificate) = (self.best, &self.best.certificate);
        json!({
            "robot": self.problem.robot.name(),
            "criterion": best.criterion.name(),
            "columns": self.problem.columns.name(),
            "family": self.problem.family.name(),
            "seed": self.arguments.seed,
            "value": best.value,
            "condition": certificate.condition,
            "condition_scaled": certificate.condition_scaled,
            "log_det_information": certificate.log_det_information,
            "condition_all": certificate.condition_all,
            "condition_scaled_all": certificate.condition_scaled_all,
            "log_det_information_all": certificate.log_det_information_all,
            "spectrum_all": certificate.spectrum,
            "deviations_all": certificate.deviations,
            "worst_limit_use": certificate.worst_limit_use,
            "worst": certificate.worst,
            "certificate_samples": certificate.samples,
            "iterations": best.iterations,
            "evaluations": best.evaluations,
            "seconds": self.seconds,
            "termination": best.termination.name(),
            "trajectory": trajectory_json(&best.trajectory),
            "file": self.path,
            "starts": self.found.designs.iter().map(start_json).collect::<Vec<_>>(),
            "baseline": self.found.baseline.as_ref().map(start_json),
            "history": best.history,
        })
    }

    fn text(&self, verbose: bool) -> String {
        let (best, certificate) = (self.best, &self.best.certificate);
        let mut text = format!(
            "{}: {} over {} base parameters ({}), the best of {} starts in {:.2} s\n{} after {} iterations and {} \
             evaluations; {}\n\n",
            self.problem.robot.name(),
            best.criterion.name(),
            self.problem.base.rank(),
            self.problem.columns.name(),
            self.found.designs.len(),
            self.seconds,
            best.termination.name(),
            best.iterations,
            best.evaluations,
            self.path.display(),
        );
        let mut worth =
            Table::new(&[("", Align::Left), ("rigid columns", Align::Right), ("all columns", Align::Right)]);
        for (name, rigid, all) in [
            ("condition number", certificate.condition, certificate.condition_all),
            ("with columns of unit length", certificate.condition_scaled, certificate.condition_scaled_all),
            ("ln det of the information", certificate.log_det_information, certificate.log_det_information_all),
        ] {
            worth.row([name.to_owned(), number(rigid), number(all)]);
        }
        text.push_str(&worth.render(2));
        let mut limits = Table::new(&[("limit", Align::Left), ("used", Align::Right), ("most", Align::Left)]);
        let worst = &certificate.worst;
        let cases = [
            ("position", Some(worst.position)),
            ("velocity", Some(worst.velocity)),
            ("acceleration", Some(worst.acceleration)),
            ("torque", worst.torque),
        ];
        for (quantity, case) in cases {
            let Some(case) = case else { continue };
            let share = format!("{:.1} %", 100.0 * case.ratio);
            limits.row([quantity.to_owned(), share, used(&case, quantity, &self.problem.robot)]);
        }
        let _ = write!(text, "\n{}", limits.render(2));
        if let Some(clearance) = certificate.worst_limit_use.clearance_m {
            let _ = writeln!(text, "  clearance {} m", number(clearance));
        }
        if let Some(baseline) = &self.found.baseline {
            let _ = writeln!(
                text,
                "\n  the best of {} random trajectories: {}; the design: {}",
                baseline.evaluations,
                number(baseline.value),
                number(best.value)
            );
        }
        if verbose {
            let mut starts = Table::new(&[
                ("start", Align::Right),
                ("value", Align::Right),
                ("iterations", Align::Right),
                ("evaluations", Align::Right),
                ("ended", Align::Left),
            ]);
            for (start, design) in self.found.designs.iter().enumerate() {
                starts.row([
                    start.to_string(),
                    number(design.value),
                    design.iterations.to_string(),
                    design.evaluations.to_string(),
                    ending(design, &self.problem.robot),
                ]);
            }
            let _ = write!(text, "\n{}", starts.render(2));
        }
        text
    }
}
