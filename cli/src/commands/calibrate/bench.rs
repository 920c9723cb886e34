//! One joint driven there and back at constant speeds, on any arm, and where its files go.

use std::path::{Path, PathBuf};

use armid::calibration::Measured;
use armid::experiment::Recording;
use armid::input::check_file_name;
use armid::model::{Joint, Robot};
use armid::trajectory::{ConstantSpeedTrajectory, PeriodicTrajectory};
use armid_io::output::pretty;
use armid_io::recording::{FileSink, McapSink, check_free};
use armid_io::{Error, LoadedRobot, Log, output};
use armid_reports::{
    Axis, Figure, GroupStyle, Heading, Reference, ScatterFigure, ScatterGroup, ScatterPanel, ScatterPoint,
};
use armid_sim::Engine;
use miette::Result;
use serde_json::Value;

use crate::arguments::{RobotArguments, one_of};
use crate::arms::{self, Experiment};
use crate::commands::run::notes;
use crate::interrupt;
use crate::terminal::{Console, Table, report_folder};

/// Which joint, how fast, on which arm.
#[derive(Debug, clap::Args)]
pub(super) struct BenchArguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// The joint: its name, or its number from one
    #[arg(long)]
    joint: String,
    /// Speeds, as shares of the joint's limit
    #[arg(long, value_delimiter = ',', default_value = "0.05,0.1,0.2,0.35,0.5,0.65", value_name = "SHARE,…")]
    speeds: Vec<f64>,
    /// Range of the joint; 80 % of its limits by default
    #[arg(long, value_delimiter = ',', value_name = "LOW,HIGH", allow_hyphen_values = true)]
    range_deg: Option<Vec<f64>>,
    /// Positions of the other joints; zero by default
    #[arg(long, value_delimiter = ',', value_name = "DEG,…", allow_hyphen_values = true)]
    pose_deg: Option<Vec<f64>>,
    /// Recorded periods
    #[arg(long, default_value_t = 5)]
    periods: usize,
    /// Samples per second
    #[arg(long, default_value_t = 1000.0)]
    rate_hz: f64,
    /// Seed of every random number
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Arm that performs it
    #[arg(long, default_value = "analytic", value_parser = one_of(&Engine::ALL, Engine::name))]
    arm: Engine,
    /// Write the motion and the experiment, and perform nothing
    #[arg(long, conflicts_with = "recording")]
    plan_only: bool,
    /// Evaluate this recording instead of performing the motion
    #[arg(long, value_name = "R.mcap")]
    recording: Option<PathBuf>,
}

/// What there is to evaluate.
pub(super) struct Bench {
    pub(super) loaded: LoadedRobot,
    /// From zero.
    pub(super) joint: usize,
    /// `None` after `--plan-only`.
    pub(super) recording: Option<Recording>,
    /// The files without their endings.
    stem: PathBuf,
    /// What was written.
    pub(super) written: Vec<PathBuf>,
}

impl BenchArguments {
    /// Loads, plans and performs, as the arguments say. `what` names the files.
    pub(super) fn prepare(&self, what: &str, voltage: bool, console: &Console) -> Result<Bench> {
        let loaded = self.robot.load()?;
        let joint = joint(&loaded.robot, &self.joint)?;
        let name = &loaded.robot.joints()[joint].name;
        let stem = match console.output() {
            Some(path) => path.with_extension(""),
            None => {
                let folder = report_folder("name of the robot", &format!("{}-{what}", loaded.robot.name()))?;
                check_file_name("name of the joint", name).map_err(Error::new)?;
                folder.join(name)
            }
        };
        let mut bench = Bench { loaded, joint, recording: None, stem, written: Vec::new() };
        let path = match &self.recording {
            Some(path) => path.clone(),
            None => {
                let path = bench.file("mcap");
                if !self.plan_only {
                    check_free(&path)?;
                }
                let experiment = self.write_experiment(what, voltage, &mut bench)?;
                if self.plan_only {
                    return Ok(bench);
                }
                self.perform(&experiment, &path)?;
                bench.written.push(path.clone());
                path
            }
        };
        bench.recording = Some(Log::read(&path)?.into_recording()?);
        Ok(bench)
    }

    fn write_experiment(&self, what: &str, voltage: bool, bench: &mut Bench) -> Result<PathBuf> {
        let robot = &bench.loaded.robot;
        let motion = self.motion(robot, bench.joint)?;
        let (trajectory, experiment) = (bench.file("trajectory.toml"), bench.file("experiment.toml"));
        output::write_text(&trajectory, &PeriodicTrajectory::from(motion).to_toml())?;
        // A path is good from any folder, a bundled name is no path.
        let named = Path::new(&self.robot.robot);
        let source = if named.exists() { named.canonicalize().ok() } else { None };
        let source = source.unwrap_or_else(|| named.to_path_buf());
        let beside = trajectory.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let quoted = |text: String| toml::Value::String(text);
        let (name, source) = (quoted(format!("{}-{what}", robot.name())), quoted(source.display().to_string()));
        let mut text = format!("name = {name}\nrobot = {source}\n");
        for (key, link) in [("base_link", &self.robot.chain.base_link), ("tip_link", &self.robot.chain.tip_link)] {
            if let Some(link) = link {
                text.push_str(&format!("{key} = {link:?}\n"));
            }
        }
        text.push_str(&format!(
            "trajectory = {beside:?}\nrate_hz = {:?}\nperiods = {}\nseed = {}\narm = \"{}\"\n",
            self.rate_hz,
            self.periods,
            self.seed,
            self.arm.name()
        ));
        if voltage {
            text.push_str("\n[sensing]\nvoltage = true\n");
        }
        output::write_text(&experiment, &text)?;
        bench.written.extend([trajectory, experiment.clone()]);
        Ok(experiment)
    }

    fn motion(&self, robot: &Robot, joint: usize) -> Result<ConstantSpeedTrajectory> {
        let limits = &robot.joints()[joint].limits;
        let si = |degrees: &f64| degrees.to_radians();
        let (low, high) = match self.range_deg.as_deref() {
            Some([low, high]) => (si(low), si(high)),
            Some(other) => {
                return Err(Error::new(format!("--range-deg has {} angles, expected 2", other.len())).into());
            }
            _ if (limits.position.1 - limits.position.0).is_finite() => {
                let (low, high) = limits.position;
                let (middle, half) = (0.5 * (low + high), 0.4 * (high - low));
                (middle - half, middle + half)
            }
            _ => (-1.5, 1.5),
        };
        let nearest_to_zero = |joint: &Joint| 0.0_f64.clamp(joint.limits.position.0, joint.limits.position.1);
        let pose: Vec<f64> = match &self.pose_deg {
            Some(pose) if pose.len() == robot.dof() => pose.iter().map(si).collect(),
            Some(pose) => {
                let message = format!("--pose-deg has {} angles, expected {}", pose.len(), robot.dof());
                return Err(Error::new(message).into());
            }
            None => robot.joints().iter().map(nearest_to_zero).collect(),
        };
        let top = if limits.velocity.is_finite() { limits.velocity } else { 1.0 };
        let mut speeds: Vec<f64> = self.speeds.iter().map(|share| share * top).collect();
        speeds.sort_by(f64::total_cmp);
        if speeds.iter().any(|&speed| !(speed.is_finite() && speed > 0.0)) || speeds.is_empty() {
            return Err(Error::new(format!("--speeds is {:?}, expected shares above zero", self.speeds)).into());
        }
        ConstantSpeedTrajectory::there_and_back(robot, joint, &speeds, &pose, (low, high))
            .map_err(|fault| Error::new(fault).help("lower --speeds or a wider --range-deg").into())
    }

    fn perform(&self, experiment: &Path, path: &Path) -> Result<()> {
        let experiment = Experiment::load(&experiment.display().to_string())?;
        experiment.planned.plan.check_limits(&experiment.planned.robot.robot).map_err(Error::new)?;
        let mut sink = Box::new(McapSink::new(path, notes(&experiment), |_| {}).stopping_when(interrupt::asked));
        let performed = arms::perform(experiment.arm, &experiment, None, &mut *sink)?;
        if !performed.ending.is_complete() {
            let part = sink.finish(&performed.ending, performed.remarks())?;
            let message = format!("the motion ended early ({:?}); what there is: {}", performed.ending, part.display());
            return Err(Error::new(message).into());
        }
        sink.finish(&performed.ending, performed.remarks())?;
        Ok(())
    }
}

impl Bench {
    /// Name of the joint.
    pub(super) fn joint_name(&self) -> &str {
        &self.loaded.robot.joints()[self.joint].name
    }

    /// Points of this joint, and the line that was fitted to them.
    pub(super) fn figure(
        &self,
        heading: Heading,
        [x, y]: [Axis; 2],
        (label, points): (&str, Vec<ScatterPoint>),
        line: Reference,
    ) -> ScatterFigure {
        let group = ScatterGroup { label: label.to_owned(), style: GroupStyle::nth(0), points };
        let subtitle = format!("{}, joint \"{}\"", self.loaded.robot.name(), self.joint_name());
        ScatterFigure {
            heading: heading.subtitle(subtitle),
            columns: 1,
            panels: vec![ScatterPanel { title: String::new(), x, y, groups: vec![group], references: vec![line] }],
        }
    }

    /// `<stem>.<ending>`
    fn file(&self, ending: &str) -> PathBuf {
        let mut name = self.stem.as_os_str().to_owned();
        name.push(".");
        name.push(ending);
        name.into()
    }

    /// Writes the result and its figure.
    pub(super) fn write(&mut self, json: &Value, figure: &ScatterFigure) -> Result<()> {
        let svg = figure.svg().map_err(|fault| Error::new(format!("the figure cannot be drawn: {fault}")))?;
        for (ending, text) in [("json", pretty(json)), ("svg", svg)] {
            let path = self.file(ending);
            output::write_text(&path, &text)?;
            self.written.push(path);
        }
        Ok(())
    }

    /// The files, a line each.
    pub(super) fn list(&self) -> String {
        self.written.iter().map(|path| format!("  {}\n", path.display())).collect()
    }
}

/// What was measured with its intervals: name, value, decimals, unit.
pub(super) fn values(rows: &[(&str, Option<Measured>, usize, &str)]) -> Table {
    let mut table = Table::of(" | #value | #std | #95 % interval | # | unit");
    for &(name, value, decimals, unit) in rows {
        let Some(Measured { value, std, ci95: [low, high] }) = value else { continue };
        let [value, std, low, high] = [value, std, low, high].map(|x| format!("{x:.decimals$}"));
        table.row([name.to_owned(), value, std, low, high, unit.to_owned()]);
    }
    table
}

/// A joint by its name, or by its number from one; from zero.
fn joint(robot: &Robot, wanted: &str) -> Result<usize> {
    let number = wanted.parse::<usize>().ok().filter(|&n| (1..=robot.dof()).contains(&n)).map(|n| n - 1);
    number.or_else(|| robot.joint_index(wanted)).ok_or_else(|| {
        let names: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
        let message = format!("--joint is \"{wanted}\", expected 1 to {} or one of {}", robot.dof(), names.join(", "));
        Error::new(message).into()
    })
}
