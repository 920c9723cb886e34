//! `armid run`

use std::cell::Cell;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use armid::excitation::check;
use armid::experiment::{Ending as PlanEnding, Phase, Sink, Tracking};
use armid::model::{JointKind, Robot};
use miette::Result;
use serde_json::{Value, json};

use crate::answer::{Answer, Ending};
use crate::arms::{self, ArmKind, Performed};
use crate::choices::one_of;
use crate::console::Console;
use crate::fault::Fault;
use crate::files::experiment_toml::{self, Experiment};
use crate::files::file_sink::{CsvSink, FileSink};
use crate::files::recording_mcap::{McapSink, part_of};
use crate::progress;
use crate::resumption::{self, Found};
use crate::table::{Align, Table, number};

const AFTER_HELP: &str = "\
EXPERIMENT is a TOML file, a folder with experiment.toml, or a bundled name:

  robot = \"crs-a460\"            # as on the command line; paths begin beside this file
  trajectory = \"T.toml\"         # or table-one, the paper's
  rate_hz = 1000                # samples per second; a period holds a whole number of them
  settle_s = 1.0                # at rest before the motion
  ramp_s = 2.0                  # into the motion and out of it
  discarded_periods = 1         # performed and thrown away
  periods = 10                  # that count
  seed = 1                      # of every random number; run = 0, 1, … repeats it with others
  arm = \"analytic\"

  [sensing]                     # what the sensors do wrong; all true unless told otherwise
  encoders = true               # whole counts
  current_noise = true
  converters = true             # range and bits
  voltage = false               # the controller reports motor voltages, where the robot file has the circuits

R.mcap opens in any tool that reads ROS 2 joint states; -o R.csv writes t,q1..,current1.. (or
tau1..). It is written to R.mcap.part and takes its name when the experiment is complete.

Examples:
  armid run experiment.toml -o R.mcap
  armid run experiment.toml --seed 7 -o validation.mcap
  armid run experiment.toml --resume -o R.mcap   # after a crash, at the next period
  armid run experiment.toml --arm replay --recording R.mcap -o again.mcap";

/// Perform an experiment and write a recording
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The experiment: a TOML file, a folder, or a bundled name
    experiment: String,
    /// What performs it, in place of the file's `arm`
    #[arg(long, value_parser = one_of(&ArmKind::ALL, ArmKind::name))]
    arm: Option<ArmKind>,
    /// Seed of every random number, in place of the file's
    #[arg(long)]
    seed: Option<u64>,
    /// Repetition, in place of the file's: the same experiment with other noise
    #[arg(long)]
    run: Option<u64>,
    /// Periods that count, in place of the file's
    #[arg(long)]
    periods: Option<usize>,
    /// Continue what was cut short: keep the whole periods of R.mcap.part and perform those that are missing
    #[arg(long)]
    resume: bool,
    /// What `--arm replay` plays
    #[arg(long, value_name = "R.mcap")]
    recording: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let mut experiment = experiment_toml::load(&arguments.experiment)?;
    experiment.seed = arguments.seed.unwrap_or(experiment.seed);
    experiment.run = arguments.run.unwrap_or(experiment.run);
    experiment.arm = arguments.arm.unwrap_or(experiment.arm);
    experiment.plan.periods = arguments.periods.unwrap_or(experiment.plan.periods);
    let layout = experiment.plan.layout().map_err(|error| Fault::new(error.to_string()))?;
    experiment.plan.check_limits(&experiment.robot.robot).map_err(|error| {
        let help = "nothing has moved; another trajectory, a longer period or longer ramps stay inside";
        Fault::new(format!("{}: {error}", experiment.text.name)).help(help)
    })?;
    admit(&experiment)?;

    let path = console
        .output()
        .map_or_else(|| Path::new("reports").join(&experiment.name).join("recording.mcap"), Path::to_path_buf);
    let bar = progress::bar(console, layout.samples() as u64, "samples");
    let taken = Cell::new(0);
    let on_sample = |samples: usize| {
        taken.set(samples);
        if samples.is_multiple_of(1000) {
            bar.set_position(samples as u64);
        }
    };
    let csv = path.extension().is_some_and(|extension| extension == "csv");
    let resumption = match (arguments.resume, csv) {
        (false, _) => None,
        (true, true) => return Err(Fault::new("--resume continues an R.mcap, and -o names a CSV").into()),
        (true, false) => match resumption::find(&path, &experiment)? {
            Found::Nothing => {
                console.note(format!("{} is not there: nothing to continue, beginning", part_of(&path).display()));
                None
            }
            Found::Whole => {
                bar.finish_and_clear();
                console.show(&resumption::already_whole(&path))?;
                return Ok(Ending::Done);
            }
            Found::Part(part) => Some(part),
        },
    };
    let mut notes = notes(&experiment);
    let mut sink: Box<dyn FileSink + '_> = match &resumption {
        _ if csv => Box::new(CsvSink::new(&path, on_sample)),
        None => Box::new(McapSink::new(&path, notes, on_sample)),
        Some(part) => {
            notes.insert("sessions".to_owned(), part.sessions(experiment.plan.periods));
            Box::new(McapSink::new(&path, notes, on_sample).resuming(part.continuation.samples()))
        }
    };
    let performed = {
        let sink: &mut dyn Sink = &mut *sink;
        match &resumption {
            None => arms::perform(experiment.arm, &experiment, arguments.recording.as_deref(), sink)?,
            Some(part) => part.perform(&experiment, arguments.recording.as_deref(), sink)?,
        }
    };
    let written = sink.finish(&performed.ending)?;
    bar.finish_and_clear();

    let done = Done { experiment: &experiment, performed: &performed, samples: taken.get(), written: &written };
    console.show(&Answer { text: done.text(), json: done.json() })?;
    Ok(match performed.ending {
        PlanEnding::Completed => Ending::Done,
        PlanEnding::Stopped { .. } => Ending::Interrupted,
        PlanEnding::Diverged { .. } | PlanEnding::Tripped { .. } => Ending::Negative,
    })
}

/// The last look at the certificate, before anything moves.
fn admit(experiment: &Experiment) -> Result<()> {
    let Some(certificate) = &experiment.certificate else { return Ok(()) };
    let (name, help) = (&experiment.text.name, "nothing has moved; `armid design` writes a certificate that fits");
    check(&experiment.robot.robot, &experiment.plan.trajectory, certificate)
        .map_err(|fault| Fault::new(format!("{name}: {fault}")).help(help))?;
    match certificate.ramp_s {
        Some(certified) if experiment.plan.ramp_s < certified - 1e-9 => {
            let found = experiment.plan.ramp_s;
            let message =
                format!("{name}: ramp_s is {found}, expected {certified} or more, as the certificate holds for");
            Err(Fault::new(message).help(help).into())
        }
        _ => Ok(()),
    }
}

/// What goes into the recording beside what the arm says of it.
pub(super) fn notes(experiment: &Experiment) -> BTreeMap<String, String> {
    let mut notes = BTreeMap::new();
    let mut note = |key: &str, value: Option<String>| {
        if let Some(value) = value {
            notes.insert(key.to_owned(), value);
        }
    };
    note("name", Some(experiment.name.clone()));
    note("question", experiment.question.clone());
    note("experiment", Some(experiment.text.content.to_string()));
    note("arm", Some(experiment.arm.name().to_owned()));
    note("seed", Some(experiment.seed.to_string()));
    note("run", Some(experiment.run.to_string()));
    note("nominal_file", experiment.robot.nominal_text.as_ref().map(|text| text.content.to_string()));
    note("base_link", experiment.chain.base_link.clone());
    note("tip_link", experiment.chain.tip_link.clone());
    notes
}

struct Done<'a> {
    experiment: &'a Experiment,
    performed: &'a Performed,
    samples: usize,
    written: &'a Path,
}

impl Done<'_> {
    fn ending(&self) -> (&'static str, String) {
        let at = |t: f64, phase: Phase| format!("at t = {t:.3} s ({})", phase.name());
        match &self.performed.ending {
            PlanEnding::Completed => ("completed", String::new()),
            PlanEnding::Stopped { t, phase } => ("stopped", at(*t, *phase)),
            PlanEnding::Diverged { t, phase, reason } => ("diverged", format!("{}: {reason}", at(*t, *phase))),
            PlanEnding::Tripped { t, phase, trip } => ("tripped", format!("{}: {trip}", at(*t, *phase))),
        }
    }

    /// Which guard tripped, why, and what it did; null where none did.
    fn trip(&self) -> Value {
        let PlanEnding::Tripped { t, phase, trip } = &self.performed.ending else { return Value::Null };
        json!({
            "name": trip.trip,
            "reason": trip.reason,
            "action": trip.action.name(),
            "bound_ms": trip.bound_ms,
            "t_s": t,
            "phase": phase.name(),
        })
    }

    fn json(&self) -> Value {
        let plan = &self.experiment.plan;
        let (ending, detail) = self.ending();
        json!({
            "recording": self.written,
            "robot": self.experiment.robot.robot.name(),
            "arm": self.experiment.arm.name(),
            "seed": self.experiment.seed,
            "run": self.experiment.run,
            "ending": ending,
            "detail": detail,
            "trip": self.trip(),
            "samples": self.samples,
            "rate_hz": plan.rate_hz,
            "period_s": plan.trajectory.period_s(),
            "periods": plan.periods,
            "certificate": self.experiment.certificate.as_ref().map(|certificate| json!({
                "trajectory_sha256": certificate.trajectory_sha256,
                "robot_sha256": certificate.robot_sha256,
                "worst_limit_use": certificate.worst_limit_use,
            })),
            "tracking": self.performed.tracking.as_ref().map(|tracking| json!({
                "peak_error": tracking.peak_error,
                "rms_error": tracking.rms_error,
                "error_units": self.experiment.robot.robot.joints().iter().map(|j| j.kind.unit()).collect::<Vec<_>>(),
                "peak_effort": tracking.peak_effort,
                "effort_units": self.experiment.robot.robot.joints().iter().map(|j| j.kind.effort_unit()).collect::<Vec<_>>(),
                "peak_current_a": tracking.peak_current,
                "saturated_steps": tracking.saturated_steps,
            })),
        })
    }

    fn text(&self) -> String {
        let plan = &self.experiment.plan;
        let (ending, detail) = self.ending();
        let mut text = format!(
            "{}: {} {}, {} samples at {} Hz, {} periods of {} s that count\n{}\n",
            self.experiment.name,
            ending,
            if detail.is_empty() { format!("on arm {}", self.experiment.arm.name()) } else { detail },
            self.samples,
            plan.rate_hz,
            plan.periods,
            plan.trajectory.period_s(),
            self.written.display(),
        );
        if let Some(tracking) = &self.performed.tracking {
            let _ = write!(text, "\n{}", followed(&self.experiment.robot.robot, tracking).render(2));
            if tracking.saturated_steps > 0 {
                let _ = writeln!(text, "\n  a current was at its limit in {} servo steps", tracking.saturated_steps);
            }
        }
        text
    }
}

/// How the servo followed while it counted.
fn followed(robot: &Robot, tracking: &Tracking) -> Table {
    let mut table = Table::new(&[
        ("joint", Align::Left),
        ("error RMS", Align::Right),
        ("peak", Align::Right),
        ("effort peak", Align::Right),
        ("of rating", Align::Right),
        ("current peak", Align::Right),
        ("of limit", Align::Right),
    ]);
    for (i, joint) in robot.joints().iter().enumerate() {
        let error = |value: f64| match joint.kind {
            JointKind::Revolute => format!("{} mdeg", number(1e3 * value.to_degrees())),
            JointKind::Prismatic => format!("{} µm", number(1e6 * value)),
        };
        let share = |value: f64, limit: f64| {
            if limit.is_finite() { format!("{:.0} %", 100.0 * value / limit) } else { String::new() }
        };
        table.row([
            joint.name.clone(),
            error(tracking.rms_error[i]),
            error(tracking.peak_error[i]),
            format!("{} {}", number(tracking.peak_effort[i]), joint.kind.effort_unit()),
            share(tracking.peak_effort[i], joint.limits.torque),
            format!("{} A", number(tracking.peak_current[i])),
            share(tracking.peak_current[i], joint.drive.current_limit),
        ]);
    }
    table
}
