//! `armid monitor`

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use armid_hardware::link::Network;
use armid_hardware::monitor::{Monitor, Snapshot};
use armid_io::Error as Fault;
use miette::Result;
use serde_json::{Value, json};

use crate::arms::Experiment;
use crate::interrupt;
use crate::monitor::text;
use crate::terminal::{Answer, Console, Ending};

const AFTER_HELP: &str = "\
It receives joint states, the state of the controller and the reports of the run's guard. It sends nothing, \
not even acknowledgements, so it cannot delay the run. Ctrl-C ends it.

Examples:
  armid monitor experiment.toml
  armid monitor experiment.toml --once     # after two seconds";

/// Monitor a run on a real arm in the terminal (read-only)
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The experiment whose `[ros2]` states how the robot is reached
    experiment: String,
    /// ROS domain, in place of the file's
    #[arg(long)]
    domain: Option<u16>,
    /// Print the state once, then end
    #[arg(long)]
    once: bool,
    /// How long to listen before that, s
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    listen: f64,
}

/// How long one look takes: ten frames in a second.
const LOOK: Duration = Duration::from_millis(100);
/// Puts the cursor at the top of a terminal and clears it.
const CLEAR: &str = "\x1b[H\x1b[2J";

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let mut experiment = Experiment::load(&arguments.experiment)?;
    experiment.ros2.domain = arguments.domain.unwrap_or(experiment.ros2.domain);
    let robot = &experiment.planned.robot.robot;
    let mut monitor = Monitor::open(&experiment.ros2, robot).map_err(Fault::new)?;
    let network = match &experiment.ros2.network {
        Network::Loopback => "loopback",
        Network::Any => "every network",
        Network::Only(_) => "chosen networks",
    };
    let place = format!("ROS domain {}, {network}", experiment.ros2.domain);
    let shown = |snapshot: &Snapshot| text(robot, &experiment.guard, &place, snapshot);
    if arguments.once || console.global.json || !std::io::stdout().is_terminal() {
        let until = Instant::now() + Duration::from_secs_f64(arguments.listen.clamp(0.0, 3600.0));
        while Instant::now() < until && !interrupt::asked() {
            monitor.look(LOOK);
        }
        let snapshot = monitor.look(LOOK);
        console.answer(&Answer { text: shown(snapshot), json: json(robot.name(), snapshot) })?;
        return Ok(if snapshot.row.is_some() { Ending::Done } else { Ending::Negative });
    }
    while !interrupt::asked() {
        console.print(&format!("{CLEAR}{}\nCtrl-C ends\n", shown(monitor.look(LOOK))))?;
    }
    Ok(Ending::Done)
}

fn json(robot: &str, snapshot: &Snapshot) -> Value {
    let finite = |value: f64| value.is_finite().then_some(value);
    json!({
        "robot": robot,
        "rate_hz": snapshot.rate_hz,
        "age_s": finite(snapshot.age_s),
        "q": snapshot.row.as_ref().map(|row| &row.q),
        "effort": snapshot.row.as_ref().map(|row| &row.effort),
        "stamps": snapshot.stamps,
        "computer": snapshot.controller_state,
        "guard": snapshot.guard.as_ref().map(|(state, _)| state),
        "guard_age_s": snapshot.guard.as_ref().map(|(_, age)| age),
        "fault": snapshot.fault,
    })
}
