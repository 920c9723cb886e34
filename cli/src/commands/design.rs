//! `armid design`

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use armid::base::{Method, reduce};
use armid::excitation::criterion::PayloadOptimal;
use armid::excitation::{
    Criterion, CriterionKind, DEFAULT_EVALUATIONS, Design, DesignBudget, DesignLimits, DesignProblem, DesignSpace,
    EvaluationMotions, ExcitationError, best_of, design, design_from, nearest_of, random_design,
};
use armid::experiment::{EffectKind, Effects};
use armid::input::size::{DESIGNS, HARMONICS, PERIOD_S};
use armid::model::{Columns, Robot};
use armid::seed::Seed;
use armid::study::LimitExample;
use armid::trajectory::{Family, PeriodicTrajectory};
use armid_io::prior::set_prior;
use armid_io::robot::HeldShapes;
use armid_io::{Error, LoadedRobot, output, trajectory};
use armid_reports::{Figure, Heading, design_convergence, limits_figure};
use miette::Result;
use rayon::prelude::*;

use crate::answers::design::{DesignAnswer, Gain};
use crate::answers::separating::SeparatingExperiment;
use crate::arguments::{LimitArguments, MeshArguments, PayloadArguments, RobotArguments, columns, one_of};
use crate::interrupt;
use crate::terminal::{Answer, Console, Destination, Ending, progress, report_folder};

const AFTER_HELP: &str = "\
Every start begins at the first guess of Radkhah et al. (2007) from other random velocities and may
evaluate the criterion --evaluations times (a gradient counts as one more). The best start within all
limits is kept. Limits hold at every instant, also between samples and on the ramps of an experiment:
position (less --margin, where the guard of a real arm stops it), velocity, acceleration, jerk,
distances (of the robot's shapes: a URDF's boxes, balls and capsules, and the hulls of its cylinders and
meshes), and torque and current (peak and RMS) with the probability --confidence at each instant, by
the uncertainty of the nominal parameters (without one, below nine tenths of the limits). Where no
start holds them, the nearest is written, its excess is reported, and the exit status is 1. Equal seeds
give equal trajectories. The file contains the certificate.

The figures without a suffix are those of the rigid base columns for any criterion; those
of the chosen columns are beside them under …_all.

Examples:
  armid design crs-a460 --criterion d-optimal -o T.toml
  armid design crs-a460 --criterion condition --columns rigid --starts 8 --seed 3 --json -o T.toml
  armid design crs-a460 --criterion d-optimal --prior E.json --from T.toml -o T2.toml
  armid design crs-a460 --criterion model-error --expect load-friction,elasticity=3.0 -o T.toml
  armid design crs-a460 --criterion a-optimal --family cubic-b-spline --freeze wrist_roll=0 -o T.toml
  armid design crs-a460 --payload 1.5 --payload-centre 0,0,0.05 -o L.toml   # for identify --payload
  armid design arm.urdf --criterion condition-scaled --period 20 --harmonics 7 -o T.toml";

/// Design a trajectory that excites the parameters best within the limits
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Criterion
    #[arg(long, value_parser = one_of(&CriterionKind::ALL, CriterionKind::name), required_unless_present = "payload")]
    criterion: Option<CriterionKind>,
    #[command(flatten)]
    payload: PayloadArguments,
    /// Which parameters are to be estimated
    #[arg(long, default_value = "rigid+rotor+friction", value_parser = columns)]
    columns: Columns,
    /// Short for --columns rigid
    #[arg(long, conflicts_with = "columns")]
    no_friction: bool,
    /// Period, s
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    period: f64,
    /// Family of trajectories
    #[arg(long, default_value = "fourier", value_parser = one_of(&Family::ALL, Family::name))]
    family: Family,
    /// Harmonics of every joint, or a list with one number for each; splines have 2 N + 1 knots
    #[arg(long, value_name = "N", default_value = "5", value_delimiter = ',')]
    harmonics: Vec<usize>,
    /// Joint held fixed, and its position, rad; parameters that are then unidentifiable are left out
    #[arg(long, value_name = "JOINT=RAD", value_delimiter = ',', value_parser = frozen_joint)]
    freeze: Vec<(String, f64)>,
    /// Seed of the first guesses
    #[arg(long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Independent starts
    #[arg(long, value_name = "N", default_value_t = 8)]
    starts: u64,
    /// Trajectories of the same family, period and joints at which further starts begin
    #[arg(long, value_name = "T.toml", num_args = 1..)]
    from: Vec<String>,
    /// Evaluations of the criterion that each start may use
    #[arg(long, value_name = "N", default_value_t = DEFAULT_EVALUATIONS)]
    evaluations: usize,
    /// Steps of the optimiser that each start may take
    #[arg(long, value_name = "N")]
    iterations: Option<usize>,
    #[command(flatten)]
    limits: LimitArguments,
    #[command(flatten)]
    meshes: MeshArguments,
    /// Weight the rows of d-optimal by the noise of each joint's effort, from the robot's drives
    #[arg(long)]
    weighted: bool,
    /// Estimates of earlier experiments: the design adds to their information, with the noise that they found
    #[arg(long, value_name = "E.json", num_args = 1.., conflicts_with = "weighted")]
    prior: Vec<PathBuf>,
    /// Effects that model-error expects of the arm, each at its realistic level or a magnitude in its own unit; by default
    /// load-friction and elasticity
    #[arg(long, value_name = "EFFECT[=MAGNITUDE]", value_delimiter = ',', value_parser = expected_effect)]
    expect: Vec<(EffectKind, f64)>,
    /// Motions on which i-optimal and model-error predict torque; by default random ones, half of them slow
    #[arg(long, value_name = "T.toml", num_args = 1..)]
    predict: Vec<String>,
    /// Recorded periods that model-error expects of the experiment, at the robot's servo rate
    #[arg(long, value_name = "N", default_value_t = 10)]
    periods: usize,
    /// Skip the baseline: as many random trajectories as a start may evaluate
    #[arg(long)]
    no_baseline: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    check_sizes(arguments)?;
    let mut loaded = arguments.robot.load()?;
    let shapes = match arguments.limits.clearance() {
        Some(clearance) => loaded.hold_collision_shapes(&arguments.meshes.packages(), clearance)?,
        None => HeldShapes::default(),
    };
    let problem = problem(arguments, &loaded)?;
    let starts = starts(arguments, problem.robot())?;
    let destination = console.text_or(|| {
        let folder = format!("{}-{}", problem.robot().name(), problem.objective().criterion().name());
        Ok(report_folder("name of the robot", &folder)?.join("trajectory.toml"))
    })?;
    let began = Instant::now();
    let found = search(arguments, &problem, &starts, console)?;
    let seconds = began.elapsed().as_secs_f64();
    let interrupted = found.designs.len() < starts.len();
    let best = best_of(&found.designs);
    let feasible = best.is_some();
    let Some(best) = best.or_else(|| nearest_of(&found.designs)) else {
        return Ok(Ending::Interrupted);
    };
    console.deliver(&destination, &best.certificate.to_toml_with(&best.trajectory))?;
    let figures = match &destination {
        Destination::File(path) => draw(path, &problem, &found, best)?,
        Destination::StandardOutput => Vec::new(),
    };
    let done = DesignAnswer {
        seed: arguments.seed,
        problem: &problem,
        designs: &found.designs,
        baseline: found.baseline.as_ref(),
        best,
        seconds,
        destination,
        figures,
        remarks: &loaded.remarks,
        shapes: &shapes,
        payload: arguments.payload.load()?.map(|load| (load.mass, arguments.payload.centre())),
        separating: SeparatingExperiment::of(
            problem.robot().uncertainty(),
            &arguments.robot.robot,
            best.trajectory.period_s(),
        ),
        gain: Gain::of(&problem, best, arguments.prior.len()).map_err(|error| impossible(&error))?,
    };
    console.show(&Answer { text: done.text(console.verbose()), json: done.json(interrupted && !feasible) })?;
    Ok(match (interrupted, feasible) {
        (true, _) => Ending::Interrupted,
        (false, true) => Ending::Done,
        (false, false) => Ending::Negative,
    })
}

/// Draws how the design was found and what it uses of its limits, beside the trajectory.
fn draw(path: &Path, problem: &DesignProblem, found: &Found, best: &Design) -> Result<Vec<PathBuf>> {
    let robot = problem.robot().name();
    let joints: Vec<String> = problem.robot().joints().iter().map(|joint| joint.name.clone()).collect();
    let example = LimitExample::of(problem.robot(), problem.limits().nominal(), &best.trajectory);
    let heading = Heading::new("limits", format!("{robot}: the design against its limits"))
        .subtitle(format!("one period, optimised for {}", best.criterion));
    let convergence = design_convergence(robot, &found.designs, found.baseline.as_ref());
    let limits = limits_figure(&example, &joints, heading);
    let drawn =
        [convergence.map(|figure| ("convergence", figure.svg())), limits.map(|figure| ("limits", figure.svg()))];
    let mut written = Vec::new();
    for (name, svg) in drawn.into_iter().flatten() {
        let svg = svg.map_err(|fault| Error::new(format!("the figure \"{name}\" cannot be drawn: {fault}")))?;
        let mut file = path.with_extension("").into_os_string();
        file.push(format!("-{name}.svg"));
        let file = PathBuf::from(file);
        output::write_text(&file, &svg)?;
        written.push(file);
    }
    Ok(written)
}

/// `wrist_roll=0.0` as a joint's name and its position.
fn frozen_joint(text: &str) -> std::result::Result<(String, f64), String> {
    let parts = text.split_once('=').and_then(|(name, place)| Some((name.to_owned(), place.parse::<f64>().ok()?)));
    parts.filter(|(_, place)| place.is_finite()).ok_or_else(|| "expected JOINT=RAD, as wrist_roll=0.0".to_owned())
}

/// How much is asked for, before anything is made of it.
fn check_sizes(arguments: &Arguments) -> std::result::Result<(), Error> {
    arguments.harmonics.iter().try_for_each(|&one| HARMONICS.check_count("--harmonics", one))?;
    if arguments.period.is_finite() {
        PERIOD_S.check("--period", arguments.period)?;
    }
    DESIGNS.check("--starts", arguments.starts as f64)?;
    Ok(())
}

fn impossible(error: &ExcitationError) -> Error {
    Error::new(error.to_string())
}

fn problem(arguments: &Arguments, loaded: &LoadedRobot) -> Result<DesignProblem> {
    let robot = arguments.limits.robot(loaded)?;
    if arguments.starts == 0 && arguments.from.is_empty() {
        return Err(Error::new("--starts is 0, expected at least 1, or a trajectory --from which to start").into());
    }
    let columns = if arguments.no_friction { Columns::RIGID } else { arguments.columns };
    let load = arguments.payload.load()?;
    let criterion = criterion(arguments, &robot, columns)?;
    let mut problem = DesignProblem::new(robot, columns, criterion).map_err(|error| impossible(&error))?;
    let harmonics = match arguments.harmonics.as_slice() {
        [every] => vec![*every; problem.robot().dof()],
        each => each.to_vec(),
    };
    let mut space =
        DesignSpace::new(arguments.family, arguments.period, harmonics).map_err(|error| impossible(&error))?;
    for (name, place) in &arguments.freeze {
        let names: Vec<&str> = problem.robot().joints().iter().map(|joint| joint.name.as_str()).collect();
        let Some(index) = names.iter().position(|known| known == name) else {
            let message = format!("--freeze names the joint \"{name}\", expected one of {}", names.join(", "));
            return Err(Error::new(message).into());
        };
        space = space.with_frozen(index, *place).map_err(|error| impossible(&error))?;
    }
    problem.set_space(space).map_err(|error| impossible(&error))?;
    let budget = DesignBudget::new(arguments.evaluations).map_err(|error| impossible(&error))?;
    problem.set_budget(arguments.iterations.map_or(budget, |iterations| budget.with_iterations(iterations)));
    let limits = arguments.limits.limits(problem.robot(), loaded)?;
    let limits = load.iter().copied().fold(limits, DesignLimits::with_payload);
    problem.set_limits(limits).map_err(|error| impossible(&error))?;
    // A load is estimated with rows that are weighted by their noise.
    if arguments.weighted || (load.is_some() && effort_noise(problem.robot()).is_ok()) {
        let noise = effort_noise(problem.robot())?;
        problem.set_noise(noise).map_err(|error| impossible(&error))?;
    }
    declare_use(arguments, loaded, &mut problem)?;
    if !arguments.prior.is_empty() {
        let criterion = problem.objective().criterion();
        if !criterion.is_weighted() {
            let message = format!(
                "--prior with --criterion {}, expected one of the information: d-optimal, a-optimal, e-optimal, i-optimal \
                 or model-error",
                criterion.name()
            );
            return Err(Error::new(message).into());
        }
        set_prior(&mut problem, loaded, &arguments.prior)?;
    }
    Ok(problem)
}

/// What is minimised: a criterion of the list, or that of a load.
fn criterion(arguments: &Arguments, robot: &Robot, columns: Columns) -> Result<Arc<dyn Criterion>> {
    if let Some(kind) = arguments.criterion {
        return Ok(kind.into());
    }
    let base = reduce(robot, columns, Method::Structural, Seed::new(0))
        .map_err(|error| Error::new(format!("robot \"{}\": {error}", robot.name())))?;
    match PayloadOptimal::of(&base) {
        Some(criterion) => Ok(Arc::new(criterion)),
        None => {
            let message = format!("the joints of robot \"{}\" show nothing of a load on the last link", robot.name());
            Err(Error::new(message).into())
        }
    }
}

/// What the estimate is for, and what is expected of the arm.
fn declare_use(arguments: &Arguments, loaded: &LoadedRobot, problem: &mut DesignProblem) -> Result<()> {
    let Some(kind) = arguments.criterion else { return Ok(()) };
    let is_model_error = kind == CriterionKind::ModelError;
    let refused = |option: &str, expected: &str| -> Result<()> {
        let message = format!("{option} with --criterion {}, expected {expected}", kind.name());
        Err(Error::new(message).help("`armid design --help` says what each criterion asks for").into())
    };
    if !arguments.expect.is_empty() && !is_model_error {
        return refused("--expect", "model-error");
    }
    if !arguments.predict.is_empty() {
        if !kind.criterion().asks_for_prediction() {
            return refused("--predict", "i-optimal or model-error");
        }
        let named = arguments.predict.iter();
        let motions = named.map(|name| trajectory::load(name, None, problem.robot())).collect::<Result<_, Error>>()?;
        let motions = EvaluationMotions::new(motions, problem.robot().dof()).map_err(|error| impossible(&error))?;
        problem.set_evaluation(motions).map_err(|error| impossible(&error))?;
    }
    if !is_model_error {
        return Ok(());
    }
    let Some(nominal) = loaded.nominal.as_ref().or(loaded.own.as_ref()) else {
        return refused(
            "a robot without nominal parameters",
            "one of the others: the torque of effects is found by them",
        );
    };
    // Noise against bias: both in N·m.
    problem.set_noise(effort_noise(problem.robot())?).map_err(|error| impossible(&error))?;
    let robot = problem.robot();
    let rows = robot.dof() as f64 * arguments.period * robot.servo().rate_hz * arguments.periods as f64;
    let declared = arguments.expect.iter().fold(Effects::none(), |all, &(effect, size)| all.with(effect, size));
    let effects = if declared.is_none() { Effects::expected_by_default() } else { declared };
    let expected = effects.expected(robot, nominal).map_err(|error| Error::new(format!("--expect: {error}")))?;
    problem.set_rows(rows).map_err(|error| impossible(&error))?;
    problem.set_expected(expected).map_err(|error| impossible(&error))?;
    Ok(())
}

/// `elasticity` or `elasticity=3.0` as an effect and its magnitude.
fn expected_effect(text: &str) -> std::result::Result<(EffectKind, f64), String> {
    let (name, size) = text.split_once('=').map_or((text, None), |(name, size)| (name, Some(size)));
    let names = || Effects::EXPECTABLE.map(EffectKind::name).join(", ");
    let kind = EffectKind::parse(name).filter(|kind| Effects::EXPECTABLE.contains(kind));
    let kind = kind.ok_or_else(|| format!("expected one of {}", names()))?;
    let entry = kind.entry();
    let size = size.map_or(Some(entry.realistic), |size| size.parse().ok());
    let size = size.filter(|size| (f64::MIN_POSITIVE..=entry.most).contains(size));
    size.map(|size| (kind, size))
        .ok_or_else(|| format!("expected a magnitude above 0 and at most {} {}", entry.most, entry.unit))
}

/// Standard deviation of one sample of each joint's effort by the noise of its current sensor.
fn effort_noise(robot: &Robot) -> Result<Vec<f64>> {
    let noise: Vec<f64> =
        robot.joints().iter().map(|joint| joint.drive.current_noise * joint.drive.torque_per_ampere()).collect();
    match robot.joints().iter().zip(&noise).find(|(_, noise)| **noise <= 0.0) {
        Some((joint, _)) => {
            let message = format!("--weighted: the current of joint \"{}\" has no noise in the robot file", joint.name);
            let help = "current_noise_a of a drive states it; `armid robot ROBOT -o robot.toml` begins a robot file";
            Err(Error::new(message).help(help).into())
        }
        None => Ok(noise),
    }
}

/// Where one search begins.
enum Start {
    /// At a trajectory of a file, named for messages.
    Given(String, PeriodicTrajectory),
    /// At the first guess of this number.
    Drawn(u64),
}

impl Start {
    fn design(&self, problem: &DesignProblem, seed: Seed) -> Result<Design> {
        match self {
            Self::Given(name, trajectory) => {
                design_from(problem, trajectory).map_err(|error| Error::new(format!("--from {name}: {error}")).into())
            }
            Self::Drawn(number) => design(problem, seed, *number).map_err(|error| impossible(&error).into()),
        }
    }
}

/// Trajectories that were named, then first guesses.
fn starts(arguments: &Arguments, robot: &Robot) -> Result<Vec<Start>> {
    let given = arguments.from.iter().map(|name| Ok(Start::Given(name.clone(), trajectory::load(name, None, robot)?)));
    given.chain((0..arguments.starts).map(|number| Ok(Start::Drawn(number)))).collect()
}

/// The results of the starts.
struct Found {
    designs: Vec<Design>,
    baseline: Option<Design>,
}

fn search(arguments: &Arguments, problem: &DesignProblem, starts: &[Start], console: &Console) -> Result<Found> {
    let seed = Seed::new(arguments.seed);
    let bar = progress::bar(console, starts.len() as u64, "starts");
    let designs: Result<Vec<Option<Design>>> = starts
        .par_iter()
        .map(|start| {
            if interrupt::asked() {
                return Ok(None);
            }
            let found = start.design(problem, seed)?;
            bar.inc(1);
            Ok(Some(found))
        })
        .collect();
    bar.finish_and_clear();
    let designs = designs?.into_iter().flatten().collect();
    let baseline = if !arguments.no_baseline && !interrupt::asked() {
        Some(random_design(problem, seed, 0).map_err(|error| impossible(&error))?)
    } else {
        None
    };
    Ok(Found { designs, baseline })
}
