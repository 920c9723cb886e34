//! `armid controller`

use std::io::Write;
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use armid::experiment::{Effects, Plant, Sensing};
use armid::seed::Seed;
use armid_hardware::computer::{
    Fault as ControllerFault, Progress, Replacement, RobotController, ServeOptions, Watchdog, serve,
};
use armid_hardware::link::LinkSettings;
use armid_io::Error as Fault;
use armid_sim::{Engine, SimulatedArm};
use armid_workflow::simulated_arm;
use miette::Result;
use serde_json::json;

use crate::arguments::{RobotArguments, one_of};
use crate::arms::Experiment;
use crate::interrupt;
use crate::terminal::{Answer, Console, Ending, real_time, stated};

const AFTER_HELP: &str = "\
It accepts motions by the action follow_joint_trajectory or the topic joint_trajectory, and set-points on \
commands. It reports joint_states and robot_state. If set-points end in motion, it stops after 20 ms, with \
motors off after 100 ms.

--fault NAME@SECONDS injects a fault after so many seconds, NAME@motion+SECONDS counts from the first \
motion, NAME:S@SECONDS gives its size:
  freeze       the controller hangs; the brakes close
  drop         98 of 100 joint states are lost
  jitter       joint states are up to 200 ms late and out of order
  jump         the first joint's encoder jumps by 0.3 rad
  overcurrent  the first joint reports half as much again as its drive allows
  estop        the emergency stop is pressed
  die          the process ends at once
  order        the values of the first two joints are exchanged, their names are not
  nan          the first joint's position is not a number
  late-answer  motions begin at once, and the answer comes a second later
  lost-result  the end of a motion is never reported
  strange-state  the reported state is an unknown text
  oscillation  the first joint's current swings between its limit and zero
  clock:S      the robot's clock is stepped by S seconds (-2)
  rate:R       the robot, its clock and its motions are R times as fast as real time (2)
  gripper      joint states name a gripper's joint as well
  late-execution:S  every goal is taken S seconds late (0.4)
  lost-goal:S  the next goal, and those behind it, come S seconds late (0.4)

Examples:
  armid controller crs-a460 --arm analytic
  armid controller crs-a460 --arm mujoco --domain 7 --fault estop@motion+3.5 --log done.csv";

/// Run a simulated robot controller: ROS 2, real time, faults on demand
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Engine that simulates the arm
    #[arg(long, default_value = "analytic", value_parser = one_of(&Engine::ALL, Engine::name))]
    arm: Engine,
    /// Take [ros2] from this experiment
    #[arg(long, value_name = "EXPERIMENT")]
    experiment: Option<String>,
    /// ROS domain, in place of the experiment's
    #[arg(long, value_name = "ID")]
    domain: Option<u16>,
    /// Joint states per second; divides the servo rate, the default
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Initial positions, rad (m), in place of zero
    #[arg(long, value_name = "Q1,…", value_delimiter = ',', allow_hyphen_values = true)]
    pose: Option<Vec<f64>>,
    /// The arm is not homed: it reports so and does not move
    #[arg(long)]
    not_homed: bool,
    /// How a new motion replaces a running one
    #[arg(long, default_value = "at-once", value_parser = one_of(&Replacement::ALL, Replacement::name))]
    replacement: Replacement,
    /// Refuse the first goals, so many of them
    #[arg(long, value_name = "N", default_value_t = 0)]
    refusals: u64,
    /// Fault to inject, and when
    #[arg(long, value_name = "NAME@SECONDS", value_parser = ControllerFault::parse)]
    fault: Option<ControllerFault>,
    /// Write every servo step here: time, command, current, position, events
    #[arg(long, value_name = "L.csv")]
    log: Option<PathBuf>,
    /// Stop after so many seconds
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Seed of the sensors' noise
    #[arg(long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// Age of the last set-point that stops a moving arm
    #[arg(long, value_name = "MS", default_value_t = 20.0)]
    hold_ms: f64,
    /// Age of the last set-point that disables the motors
    #[arg(long, value_name = "MS", default_value_t = 100.0)]
    disable_ms: f64,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let loaded = arguments.robot.load()?;
    let mut link = match &arguments.experiment {
        Some(name) => Experiment::load(name)?.ros2,
        None => LinkSettings::default(),
    };
    link.domain = arguments.domain.unwrap_or(link.domain);
    link.check().map_err(Fault::new)?;
    let simulated = simulated_arm(&loaded, arguments.arm, Effects::none())?;
    let mut plant = simulated.plant().map_err(Fault::new)?;
    stand(arguments, &simulated, &mut plant)?;
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos());
    let rate = arguments.rate.unwrap_or(simulated.robot.servo().rate_hz);
    let (seed, epoch_ns) = (Seed::new(arguments.seed), i64::try_from(now).unwrap_or(0));
    let (robot, nominal) = (&simulated.robot, &simulated.nominal);
    let watchdog = Watchdog { hold_s: 1e-3 * arguments.hold_ms, disable_s: 1e-3 * arguments.disable_ms };
    let mut controller = RobotController::new(robot, nominal, plant, &Sensing::default(), seed, 0, rate, epoch_ns)
        .map_err(Fault::new)?
        .with_fault(arguments.fault)
        .with_homed(!arguments.not_homed)
        .with_replacement(arguments.replacement)
        .with_watchdog(watchdog);
    if !simulated.truth.motors.is_empty() {
        controller = controller.with_motors(&simulated.truth.motors);
    }
    console.note(format!(
        "{} simulated by {} in ROS domain {}, {} joint states per second; Ctrl-C ends it",
        simulated.robot.name(),
        arguments.arm.name(),
        link.domain,
        stated(rate),
    ));
    real_time::advise(console);
    let options =
        ServeOptions { link, log: arguments.log.clone(), duration_s: arguments.duration, refusals: arguments.refusals };
    let mut go_on = |progress: &Progress| {
        if console.talks() {
            let _ = write!(std::io::stderr(), "\r{:<100}", line(progress));
        }
        !interrupt::asked()
    };
    let done = serve(&mut controller, &options, &mut go_on).map_err(Fault::new)?;
    if console.talks() {
        let _ = writeln!(std::io::stderr());
    }
    let deadlines = done.deadlines;
    let json = json!({
        "robot": simulated.robot.name(),
        "arm": arguments.arm.name(),
        "domain": options.link.domain,
        "seconds": done.t,
        "state": done.state,
        "orders": done.orders,
        "steps": deadlines.steps,
        "missed_deadlines": deadlines.missed,
        "latest_ms": 1e3 * deadlines.latest_s,
        "behind_ms": 1e3 * deadlines.behind_s,
        "log": options.log,
    });
    console.answer(&Answer { text: format!("{}\n", line(&done)), json })?;
    Ok(Ending::Done)
}

/// Puts the arm at its initial positions.
fn stand(arguments: &Arguments, simulated: &SimulatedArm, plant: &mut Box<dyn Plant>) -> Result<()> {
    let robot = &simulated.robot;
    let n = robot.dof();
    let pose = arguments.pose.clone().unwrap_or_else(|| vec![0.0; n]);
    if pose.len() != n {
        return Err(Fault::new(format!("--pose has {} numbers, expected {n}, one for each joint", pose.len())).into());
    }
    for (joint, q) in robot.joints().iter().zip(&pose) {
        let (low, high) = joint.limits.position;
        if !(*q >= low && *q <= high) {
            let unit = joint.kind.unit();
            let message = format!("joint \"{}\" is at {q} {unit}, expected {low:.4} to {high:.4} {unit}", joint.name);
            return Err(Fault::new(message).help("--pose puts it elsewhere").into());
        }
    }
    plant.reset(&pose, &vec![0.0; n]);
    Ok(())
}

fn line(progress: &Progress) -> String {
    let deadlines = progress.deadlines;
    format!(
        "{:.1} s  {}  {} orders  {} of {} deadlines missed, latest by {:.1} ms",
        progress.t,
        progress.state,
        progress.orders,
        deadlines.missed,
        deadlines.steps,
        1e3 * deadlines.latest_s
    )
}
