//! `armid calibrate payload`

use std::fmt::Write;
use std::path::{Path, PathBuf};

use armid::calibration::{HiddenLoad, KnownLoad, known_load, payload};
use armid::experiment::{Effects, ExperimentPlan, Sensing, record};
use armid::seed::Seed;
use armid::signal::{Derivatives, Processing, Samples, process};
use armid::spatial::Inertia;
use armid_io::output::pretty;
use armid_io::{Error, LoadedRobot, Log, output, trajectory};
use armid_reports::{Axis, Figure, Group, Heading, Interval, IntervalFigure, IntervalRow, Level};
use armid_sim::Engine;
use armid_workflow::simulated_arm;
use miette::Result;
use serde_json::{Value, json};

use crate::arguments::{RobotArguments, one_of};
use crate::terminal::{Answer, Console, Ending, Table, report_folder};

const AFTER_HELP: &str = "\
The known payload adds a known torque (N·m), and the motors add a measured current (A). Their ratio is the \
torque constant; no motor voltage is needed. Exit status 1 if the payload does not identify a joint, whose \
reason is listed. Motors that drive several joints need the back-EMF.

  armid run without.toml -o A.mcap
  # attach the payload
  armid run with.toml -o B.mcap
  armid calibrate payload crs-a460 --mass-kg 1 --centre-m 0,0,0.05 --unloaded A.mcap --loaded B.mcap

Without recordings both are simulated along --trajectory.";

/// Measure torque constants by what a known payload adds
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Mass of the payload
    #[arg(long, value_name = "KG")]
    mass_kg: f64,
    /// Its centre of mass in the frame of the last link, m
    #[arg(long, value_delimiter = ',', value_name = "X,Y,Z", required = true, allow_hyphen_values = true)]
    centre_m: Vec<f64>,
    /// Its moments of inertia about its centre, along those axes
    #[arg(long, value_delimiter = ',', value_name = "XX,YY,ZZ", default_value = "0,0,0")]
    inertia_kg_m2: Vec<f64>,
    /// The recording without the payload
    #[arg(long, value_name = "A.mcap", requires = "loaded")]
    unloaded: Option<PathBuf>,
    /// The recording with it
    #[arg(long, value_name = "B.mcap", requires = "unloaded")]
    loaded: Option<PathBuf>,
    /// The motion to simulate
    #[arg(long, default_value = "table-one", value_name = "T.toml")]
    trajectory: String,
    /// Periods to simulate
    #[arg(long, default_value_t = 10)]
    periods: usize,
    /// Seed of every random number
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Arm that performs it
    #[arg(long, default_value = "analytic", value_parser = one_of(&Engine::ALL, Engine::name))]
    arm: Engine,
}

pub(super) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let loaded = arguments.robot.load()?;
    let stem = match console.output() {
        Some(path) => path.with_extension(""),
        None => {
            report_folder("name of the robot", &format!("{}-payload", loaded.robot.name()))?.join("torque-constants")
        }
    };
    let load = arguments.load()?;
    let [without, with] = match (&arguments.unloaded, &arguments.loaded) {
        (Some(unloaded), Some(with)) => [recorded(unloaded, &loaded)?, recorded(with, &loaded)?],
        _ => [arguments.simulated(&loaded, None)?, arguments.simulated(&loaded, Some(&load))?],
    };
    let found = known_load(&loaded.robot, &without, &with, &load).map_err(Error::new)?;
    let finding = |hidden: &HiddenLoad| {
        json!({
            "joint": hidden.joint,
            "load_rms": hidden.load_rms,
            "unit": hidden.unit,
            "text": hidden.to_string(),
            "advice": hidden.advice(),
        })
    };
    let findings: Vec<Value> = found.hidden.iter().map(finding).collect();
    let json = json!({
        "robot": loaded.robot.name(),
        "mass_kg": arguments.mass_kg,
        "centre_m": arguments.centre_m,
        "joints": found.shown,
        "findings": findings,
    });
    let mut text = text(&found.shown, &loaded);
    for hidden in &found.hidden {
        let _ = writeln!(text, "  {hidden}\n    → {}\n", hidden.advice());
    }
    let svg = (!found.shown.is_empty()).then(|| figure(&found.shown, &loaded).svg()).transpose();
    let svg = svg.map_err(|fault| Error::new(format!("the figure: {fault}")))?;
    for (ending, content) in [("json", Some(pretty(&json))), ("svg", svg)] {
        let Some(content) = content else { continue };
        let path = stem.with_extension(ending);
        output::write_text(&path, &content)?;
        text.push_str(&format!("  {}\n", path.display()));
    }
    console.show(&Answer { text, json })?;
    Ok(if found.hidden.is_empty() { Ending::Done } else { Ending::Negative })
}

impl Arguments {
    /// The payload about the origin of the last link's frame.
    fn load(&self) -> Result<Inertia> {
        for (option, numbers) in [("--centre-m", &self.centre_m), ("--inertia-kg-m2", &self.inertia_kg_m2)] {
            if numbers.len() != 3 {
                return Err(Error::new(format!("{option} has {} numbers, expected 3", numbers.len())).into());
            }
        }
        let [x, y, z] = [self.centre_m[0], self.centre_m[1], self.centre_m[2]];
        let numbers = || self.centre_m.iter().chain(&self.inertia_kg_m2);
        if !(self.mass_kg.is_finite() && self.mass_kg > 0.0) || numbers().any(|x| !x.is_finite()) {
            return Err(Error::new("the payload needs a mass above zero and finite numbers").into());
        }
        let inertia = [self.inertia_kg_m2[0], self.inertia_kg_m2[1], self.inertia_kg_m2[2]];
        Ok(payload(self.mass_kg, [x, y, z], inertia))
    }

    /// Samples of a simulated experiment, with the payload on the last link where there is one.
    fn simulated(&self, loaded: &LoadedRobot, load: Option<&Inertia>) -> Result<Samples> {
        let mut truth = loaded.truth()?;
        if let (Some(load), Some(last)) = (load, truth.parameters.links.last_mut()) {
            *last += *load;
        }
        let motion = trajectory::load(&self.trajectory, None, &loaded.robot)?;
        let plan = ExperimentPlan::new(motion).with_periods(self.periods);
        let run = u64::from(load.is_some());
        let fault = |error: &dyn std::fmt::Display| Error::new(format!("arm {}: {error}", self.arm.name()));
        let simulated = simulated_arm(loaded, self.arm, Effects::none())?.with_truth(&truth);
        let mut servo =
            simulated.servo(&Sensing::default()).map_err(|error| fault(&error))?.with_seed(Seed::new(self.seed), run);
        let (recording, ending) = record(&mut servo, &plan).map_err(|error| fault(&error))?;
        if !ending.is_complete() {
            return Err(Error::new(format!("the simulated motion ended early: {ending:?}")).into());
        }
        process(&recording, &loaded.robot, &processing()).map_err(|error| fault(&error).into())
    }
}

fn recorded(path: &Path, loaded: &LoadedRobot) -> Result<Samples> {
    let log = Log::read(path)?;
    let name = log.name.clone();
    process(&log.into_recording()?, &loaded.robot, &processing())
        .map_err(|error| Error::new(format!("{name}: {error}")).into())
}

fn processing() -> Processing {
    Processing { derivatives: Derivatives::Fourier, samples_per_period: 250, ..Processing::default() }
}

fn text(found: &[KnownLoad], loaded: &LoadedRobot) -> String {
    let mut table = Table::of("joint | #torque constant | #95 % interval | # | #assumed | #load RMS");
    for joint in found {
        let constant = joint.torque_constant;
        table.row([
            joint.joint.clone(),
            format!("{:.6} N·m/A", constant.value),
            format!("{:.6}", constant.ci95[0]),
            format!("{:.6}", constant.ci95[1]),
            format!("{:.6}", joint.assumed),
            format!("{:.3} N·m", joint.load_rms),
        ]);
    }
    format!("{}: torque constants by what a known payload adds\n\n{}\n", loaded.robot.name(), table.render(2))
}

fn figure(found: &[KnownLoad], loaded: &LoadedRobot) -> IntervalFigure {
    let rows = found.iter().map(|joint| {
        let share = joint.torque_constant.scaled(100.0 / joint.assumed);
        let high = share.ci95[1];
        let cell = high.is_finite().then(|| Interval::new(share.value, share.ci95[0], high));
        IntervalRow { label: joint.joint.clone(), cells: vec![cell] }
    });
    let shares = found.iter().map(|joint| 100.0 * joint.torque_constant.value / joint.assumed);
    let (least, most) =
        shares.fold((f64::INFINITY, 0.0_f64), |(least, most), share| (least.min(share), most.max(share)));
    let title = format!("Torque constants are {least:.1} to {most:.1} % of the robot file's");
    IntervalFigure {
        heading: Heading::new("torque-constants", title)
            .subtitle(loaded.robot.name())
            .caption("Points: torque constants by what a known payload adds, with 95 % intervals."),
        value: Axis::linear("torque constant, share of the robot file's", "%"),
        groups: Group::assign(["known payload"]),
        rows: rows.collect(),
        levels: vec![Level::new(100.0, "robot file")],
        band: None,
    }
}
