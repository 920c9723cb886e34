//! `armid run`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use armid::excitation::effort::{EffortModel, ParameterSpread};
use armid::excitation::{Certificate, VerificationError, verify_certificate, verify_performance};
use armid::experiment::{Ending as PlanEnding, Sink};
use armid_hardware::guard::fastest_point;
use armid_io::Error as Fault;
use armid_io::output::write_text;
use armid_io::recording::{CsvSink, FileSink, McapSink, check_free, part_path, with_sink_thread};
use armid_reports::{Figure, poses_figure};
use miette::Result;

use crate::answers::run::{Done, answer};
use crate::arguments::{GuardArguments, MeshArguments, one_of};
use crate::arms::resumption::{Found, Part};
use crate::arms::{self, ArmKind, Experiment, Speed, resumption, speed};
use crate::interrupt;
use crate::terminal::{Answer, Console, Ending, bar, real_time, report_folder};

const AFTER_HELP: &str = "\
EXPERIMENT is a TOML file, a folder with experiment.toml, or a bundled name:

  robot = \"crs-a460\"            # as on the command line; paths begin beside this file
  trajectory = \"T.toml\"         # or table-one, of Radkhah et al. (2007)
  rate_hz = 1000                # samples per second; a period holds a whole number of them
  settle_s = 1.0                # at rest before the motion
  ramp_s = 2.0                  # into the motion and out of it
  discarded_periods = 1         # performed and discarded
  periods = 10                  # that are recorded
  seed = 1                      # of every random number; run = 0, 1, … repeats it with others
  arm = \"analytic\"

  [sensing]                     # errors of the sensors; all true by default
  encoders = true               # whole counts
  current_noise = true
  converters = true             # range and bits
  link_step = 1e-5              # encoders behind the transmissions, by steps in rad (m); none by default
  voltage = false               # the controller reports motor voltages, where the robot file has the circuits

  [guard]                       # always on for arm ros2; --guard guards a simulated arm too
  soft_margin_deg = 4           # soft limits inside the hard ones
  following_error_deg = 5       # and jump_deg, current_clamp, stale_ms, stop_window_ms, approach_speed

  [ros2]                        # how to reach a real arm
  domain = 0                    # and network, namespace, topics, mode: trajectory, topic or stream

R.mcap opens in any tool that reads ROS 2 joint states; -o R.csv writes t,q1..,current1.. (or tau1..). It is \
R.mcap.part until the experiment is complete.

Examples:
  armid run experiment.toml -o R.mcap
  armid run experiment.toml --seed 7 -o validation.mcap
  armid run experiment.toml --resume -o R.mcap   # after a crash, at the next period
  armid run experiment.toml --arm replay --recording R.mcap -o again.mcap
  armid run experiment.toml --arm ros2 --first-run -o R.mcap     # 10 %, 50 %, 100 % of the speed
  armid run experiment.toml --arm ros2 --earlier R.mcap -o next.mcap

Exit status: 0 done, 1 a guard tripped and the arm was seen at rest, 2 refused before anything moved, 3 NOT \
CONFIRMED: the arm was asked to stop and was not seen at rest, 130 interrupted, at rest.";

/// The warning where the arm was not seen at rest.
const NOT_CONFIRMED: &str = "NOT CONFIRMED: the arm was asked to stop and was not seen at rest. It may still be moving: \
                             press the emergency stop and look.";

/// Perform an experiment and write a recording
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The experiment: a TOML file, a folder, or a bundled name
    experiment: String,
    /// Arm that performs it, in place of the file's `arm`
    #[arg(long, value_parser = one_of(&ArmKind::ALL, ArmKind::name))]
    arm: Option<ArmKind>,
    /// Seed of every random number, in place of the file's
    #[arg(long)]
    seed: Option<u64>,
    /// Repetition, in place of the file's: the same experiment with other noise
    #[arg(long)]
    run: Option<u64>,
    /// Recorded periods, in place of the file's
    #[arg(long)]
    periods: Option<usize>,
    /// Resume R.mcap.part at its first missing period
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    guarding: GuardArguments,
    #[command(flatten)]
    meshes: MeshArguments,
    /// Panic after so many states, in builds for tests
    #[cfg(debug_assertions)]
    #[arg(long, value_name = "STATES", hide = true)]
    panic_after: Option<usize>,
    /// Recording that `--arm replay` plays
    #[arg(long, value_name = "R.mcap")]
    recording: Option<PathBuf>,
}

impl Arguments {
    /// An experiment that is performed at its speed behind the guard: on a real arm by way of lower ones, and from where it ended.
    pub(super) fn guarded(experiment: String, is_real: bool, yes_the_estop_works: bool, meshes: MeshArguments) -> Self {
        let guarding =
            GuardArguments { guard: true, first_run: is_real, yes_the_estop_works, ..GuardArguments::default() };
        Self {
            experiment,
            arm: None,
            seed: None,
            run: None,
            periods: None,
            resume: is_real,
            guarding,
            meshes,
            #[cfg(debug_assertions)]
            panic_after: None,
            recording: None,
        }
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let (answer, ending) = run_at(arguments, None, console)?;
    console.show(&answer)?;
    warn(ending, console);
    Ok(ending)
}

/// Says where an arm was not seen at rest.
pub(super) fn warn(ending: Ending, console: &Console) {
    if ending == Ending::NotConfirmed {
        console.alarm(NOT_CONFIRMED);
    }
}

/// Performs an experiment, whose recording goes to a place or else where the console says.
pub(super) fn run_at(arguments: &Arguments, place: Option<PathBuf>, console: &Console) -> Result<(Answer, Ending)> {
    let mut experiment = Experiment::load(&arguments.experiment)?;
    experiment.planned.seed = arguments.seed.unwrap_or(experiment.planned.seed);
    experiment.planned.run = arguments.run.unwrap_or(experiment.planned.run);
    experiment.arm = arguments.arm.unwrap_or(experiment.arm);
    experiment.planned.plan.periods = arguments.periods.unwrap_or(experiment.planned.plan.periods);
    experiment.guarded = arguments.guarding.guard;
    hold_shapes(&mut experiment, &arguments.meshes, console)?;
    verify(&experiment)?;
    let name = &experiment.planned.name;
    let usual = || console.output_or(|| Ok::<_, Fault>(report_folder("name", name)?.join("recording.mcap")));
    let path = place.map_or_else(usual, Ok)?;

    let mut earlier = arguments.guarding.earlier.clone();
    let (mut steps, mut whole) = (Vec::new(), None);
    let reduced = reduced_use(&mut experiment, arguments.guarding.reduced_speed)?;
    let speeds = speeds(&experiment, &arguments.guarding, reduced);
    let place = |step: usize| {
        if step + 1 < speeds.len() { speed::step_path(&path, speeds[step]) } else { path.clone() }
    };
    if !arguments.resume {
        // Nothing moves before every recording has its place.
        (0..speeds.len()).try_for_each(|step| check_free(&place(step)))?;
    }
    for (step, &speed) in speeds.iter().enumerate() {
        let slowed = at_speed(&experiment, speed, arguments.guarding.first_run);
        fits(&slowed)?;
        if is_csv(&path) {
            slowed.planned.plan.check_held().map_err(|error| {
                Fault::new(format!("{}: {error}", slowed.planned.text.name))
                    .help("an R.mcap is written as it is performed")
            })?;
        }
        let path = place(step);
        let motion = experiment.planned.plan.trajectory.to_toml();
        let part = match left(arguments, console, &slowed, &path)? {
            Found::Nothing => None,
            Found::Whole => {
                // Where it is a step of a first run, the next one goes on from it.
                whole = Some(path.clone());
                earlier.push(path);
                continue;
            }
            Found::Part(part) => Some(part),
        };
        if experiment.arm == ArmKind::Ros2 {
            speed::check_earlier(&experiment, speed, &motion, &earlier)?;
            if experiment.confirmation.is_none() {
                show_poses(&experiment, &path, console)?;
                real_time::advise(console);
                experiment.confirmation = Some(arguments.guarding.confirmation(experiment.planned.robot.robot.name())?);
            }
        }
        let slowed = Experiment { confirmation: experiment.confirmation.clone(), ..slowed };
        let done = perform(arguments, console, &slowed, (speed, motion), &path, part.as_deref())?;
        let ended = done.performed.ending.is_complete();
        earlier.push(done.written.clone());
        steps.push(done);
        if !ended {
            break;
        }
    }
    let answer = match &whole {
        Some(path) if steps.is_empty() => resumption::already_whole(path),
        _ => answer(&steps),
    };
    let ending = steps.last().map_or(Ending::Done, |done| match done.performed.ending {
        _ if done.performed.ending.is_unconfirmed() => Ending::NotConfirmed,
        PlanEnding::Completed => Ending::Done,
        PlanEnding::Stopped { .. } => Ending::Interrupted,
        PlanEnding::Diverged { .. } | PlanEnding::Tripped { .. } => Ending::Negative,
    });
    Ok((answer, ending))
}

/// Draws how the arm will move, before anybody is asked whether it may.
fn show_poses(experiment: &Experiment, recording: &Path, console: &Console) -> Result<()> {
    let figure = poses_figure(&experiment.planned.robot.robot, &experiment.planned.plan.trajectory);
    let mut place = recording.with_extension("").into_os_string();
    place.push("-poses.svg");
    let place = PathBuf::from(place);
    let svg = figure.svg().map_err(|fault| Fault::new(format!("the poses cannot be drawn: {fault}")))?;
    write_text(&place, &svg)?;
    console.note(format!("how the arm will move: {}", place.display()));
    Ok(())
}

/// The speeds to go through, in order: below the limit of `--reduced-speed`, each once, in periods of whole samples.
fn speeds(experiment: &Experiment, guarding: &GuardArguments, reduced: f64) -> Vec<Speed> {
    let plan = &experiment.planned.plan;
    let allowed = |speed: Speed| speed.below(reduced).in_whole_samples(plan.trajectory.period_s(), plan.rate_hz);
    let mut speeds: Vec<Speed> = guarding.speeds().into_iter().map(allowed).collect();
    speeds.dedup();
    speeds
}

/// Sets the limit of `--reduced-speed`, and returns how much of it the fastest point uses at the designed speed.
fn reduced_use(experiment: &mut Experiment, line_mm_s: Option<f64>) -> Result<f64> {
    let Some(line) = line_mm_s else { return Ok(0.0) };
    if !(line > 0.0 && line <= 1000.0) {
        return Err(Fault::new(format!("--reduced-speed is {line}, expected more than 0 and at most 1000 mm/s")).into());
    }
    experiment.guard.reduced_speed_mm_s = line;
    let layout = experiment.planned.plan.layout().map_err(Fault::new)?;
    Ok(1e3 * fastest_point(&experiment.planned.robot.robot, &experiment.planned.plan, &layout).speed / line)
}

/// The experiment at a part of its speed; before full speed, one period shows what there is to see.
fn at_speed(experiment: &Experiment, speed: Speed, first_run: bool) -> Experiment {
    let mut slowed = experiment.clone();
    if speed != Speed::FULL {
        slowed.planned.plan = experiment.planned.plan.clone().at_speed(speed.part());
        if first_run {
            (slowed.planned.plan.discarded_periods, slowed.planned.plan.periods) = (0, 1);
        }
    }
    slowed
}

/// The plan can be performed and stays inside the robot's limits.
fn fits(experiment: &Experiment) -> Result<()> {
    let layout = experiment.planned.plan.layout().map_err(Fault::new)?;
    experiment.planned.plan.check_limits(&experiment.planned.robot.robot).map_err(|error| {
        let help = "nothing has moved; choose another trajectory, a longer period or longer ramps";
        miette::Report::from(Fault::new(format!("{}: {error}", experiment.planned.text.name)).help(help))
    })?;
    // What the certificate holds must hold on the plan's own ramps and at its own speed, too.
    let Some(certificate) = &experiment.planned.certificate else { return Ok(()) };
    let (plan, mut efforts) = (&experiment.planned.plan, efforts(experiment, certificate));
    let timeline = plan.timeline(&layout);
    verify_performance(&experiment.planned.robot.robot, &plan.trajectory, timeline, certificate, efforts.as_mut())
        .map_err(|error| refused(experiment, &error))
}

fn is_csv(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "csv")
}

/// What `--resume` finds to continue.
fn left(arguments: &Arguments, console: &Console, experiment: &Experiment, path: &Path) -> Result<Found> {
    if !arguments.resume {
        return Ok(Found::Nothing);
    }
    if is_csv(path) {
        return Err(Fault::new("--resume continues an R.mcap, and -o names a CSV").into());
    }
    let found = resumption::find(path, experiment)?;
    if matches!(found, Found::Nothing) {
        console
            .note(format!("{} not found: nothing to continue, starting from the beginning", part_path(path).display()));
    }
    Ok(found)
}

/// Performs one experiment and writes its recording.
fn perform(
    arguments: &Arguments,
    console: &Console,
    experiment: &Experiment,
    (speed, motion): (Speed, String),
    path: &Path,
    part: Option<&Part>,
) -> Result<Done> {
    let layout = experiment.planned.plan.layout().map_err(Fault::new)?;
    let bar = bar(console, layout.samples() as u64, "samples");
    let taken = AtomicUsize::new(0);
    let on_sample = |samples: usize| {
        taken.store(samples, Ordering::Relaxed);
        if samples.is_multiple_of(1000) {
            bar.set_position(samples as u64);
        }
    };
    let mut notes = notes(experiment);
    notes.insert("speed".to_owned(), speed.part().to_string());
    notes.insert("motion".to_owned(), motion);
    let robot = &experiment.planned.robot.robot;
    let mut sink: Box<dyn FileSink + '_> = match part {
        _ if is_csv(path) => Box::new(CsvSink::new(path, on_sample).stopping_when(interrupt::asked)),
        None => Box::new(McapSink::new(path, notes, on_sample).with_robot(robot).stopping_when(interrupt::asked)),
        Some(part) => {
            notes.insert("sessions".to_owned(), part.sessions(experiment.planned.plan.periods));
            let sink = McapSink::new(path, notes, on_sample).with_robot(robot).resuming(part.continuation.samples());
            Box::new(sink.stopping_when(interrupt::asked))
        }
    };
    let work = |sink: &mut dyn Sink| {
        #[cfg(debug_assertions)]
        let mut failing = arms::Failing::new(sink, arguments.panic_after.unwrap_or(usize::MAX));
        #[cfg(debug_assertions)]
        let sink: &mut dyn Sink = &mut failing;
        match part {
            None => arms::perform(experiment.arm, experiment, arguments.recording.as_deref(), sink),
            Some(part) => part.perform(experiment, arguments.recording.as_deref(), sink),
        }
    };
    let (performed, passed_on) = if experiment.arm == ArmKind::Ros2 {
        // No signal ends this process before the arm is at rest.
        let _moving = interrupt::moving();
        with_sink_thread(&mut *sink, interrupt::asked, work)
    } else {
        (work(&mut *sink), Ok(()))
    };
    let performed = performed?;
    let finished = sink.finish(&performed.ending, performed.remarks());
    bar.finish_and_clear();
    let written = match passed_on.and(finished) {
        Ok(written) => written,
        // That nobody saw the arm at rest counts more than the file, and decides the exit status.
        Err(error) if performed.ending.is_unconfirmed() => {
            console.alarm(&format!("the recording is not whole: {error}"));
            part_path(path)
        }
        Err(error) => {
            if let Some(rest) = performed.ending.rest() {
                console.note(format!("the arm was stopped: {rest}"));
            }
            return Err(error.into());
        }
    };
    Ok(Done { experiment: experiment.clone(), performed, samples: taken.into_inner(), written, speed })
}

/// The efforts by the nominal parameters at hand, with the uncertainty that the certificate includes.
fn efforts(experiment: &Experiment, certificate: &Certificate) -> Option<EffortModel> {
    let loaded = &experiment.planned.robot;
    let nominal = loaded.nominal.as_ref().or(loaded.own.as_ref())?;
    let multiple = certificate.uncertainty_multiple;
    let spread = loaded.uncertainty.as_ref().filter(|_| multiple > 0.0);
    let spread = spread.map(|shares| ParameterSpread::new(&loaded.robot, nominal, shares, multiple));
    Some(EffortModel::new(&loaded.robot, nominal, spread.as_ref()))
}

/// Why nothing moves.
fn refused(experiment: &Experiment, error: &VerificationError) -> miette::Report {
    let help = "nothing has moved; `armid design` writes a certificate that fits";
    Fault::new(format!("{}: {error}", experiment.planned.text.name)).help(help).into()
}

/// Holds the collision shapes of a URDF where the design did, and says which are missing.
fn hold_shapes(experiment: &mut Experiment, meshes: &MeshArguments, console: &Console) -> Result<()> {
    let designed = experiment.planned.certificate.as_ref().and_then(|made| made.worst_limit_use.clearance_m);
    if designed.is_none() {
        return Ok(());
    }
    let shapes = experiment.planned.robot.hold_collision_shapes(&meshes.packages(), 0.0)?;
    for shape in shapes.left_out {
        console.note(format!("no clearance is held against a {} of \"{}\": {}", shape.kind, shape.body, shape.reason));
    }
    Ok(())
}

/// The last look at the certificate, before anything moves.
fn verify(experiment: &Experiment) -> Result<()> {
    let Some(certificate) = &experiment.planned.certificate else { return Ok(()) };
    let mut efforts = efforts(experiment, certificate);
    verify_certificate(
        &experiment.planned.robot.robot,
        &experiment.planned.plan.trajectory,
        certificate,
        efforts.as_mut(),
    )
    .map_err(|error| refused(experiment, &error))
}

/// What goes into the recording beside the notes of the arm.
pub(super) fn notes(experiment: &Experiment) -> BTreeMap<String, String> {
    let mut notes = BTreeMap::new();
    let mut note = |key: &str, value: Option<String>| {
        if let Some(value) = value {
            notes.insert(key.to_owned(), value);
        }
    };
    note("name", Some(experiment.planned.name.clone()));
    note("question", experiment.planned.question.clone());
    note("experiment", Some(experiment.planned.text.content.to_string()));
    note("arm", Some(experiment.arm.name().to_owned()));
    note("seed", Some(experiment.planned.seed.to_string()));
    note("run", Some(experiment.planned.run.to_string()));
    note("nominal_file", experiment.planned.robot.nominal_text.as_ref().map(|text| text.content.to_string()));
    note("base_link", experiment.planned.chain.base.clone());
    note("tip_link", experiment.planned.chain.tip.clone());
    notes
}
