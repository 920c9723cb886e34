//! `armid monitor`

use std::time::{Duration, Instant};

use armid_hardware::link::Network;
use armid_hardware::monitor::Monitor;
use armid_io::Error as Fault;
use miette::Result;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyModifiers};
use serde_json::{Value, json};

use crate::arms::Experiment;
use crate::interrupt;
use crate::monitor::{View, draw, text};
use crate::terminal::{Answer, Console, Ending};

const AFTER_HELP: &str = "\
It receives the robot's joint states, the state of its controller and the reports of the guard of
the run, and sends nothing, no acknowledgements either: it cannot delay the run. q ends it.

Examples:
  armid monitor experiment.toml
  armid monitor experiment.toml --once     # one frame as text, after two seconds";

/// Monitor a run on a real arm in the terminal (read-only)
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The experiment whose `[ros2]` states how the robot is reached
    experiment: String,
    /// ROS domain, in place of the file's
    #[arg(long)]
    domain: Option<u16>,
    /// Print one frame as text and end
    #[arg(long)]
    once: bool,
    /// How long to listen before that frame, s
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    listen: f64,
}

/// How long one look takes: ten frames in a second.
const LOOK: Duration = Duration::from_millis(100);
/// Columns of a frame that goes to no terminal.
const COLUMNS: u16 = 100;

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let mut experiment = Experiment::load(&arguments.experiment)?;
    experiment.ros2.domain = arguments.domain.unwrap_or(experiment.ros2.domain);
    let mut monitor = Monitor::open(&experiment.ros2, &experiment.planned.robot.robot)
        .map_err(|error| Fault::new(error.to_string()))?;
    if arguments.once || console.json() {
        let until = Instant::now() + Duration::from_secs_f64(arguments.listen.clamp(0.0, 3600.0));
        while Instant::now() < until && !interrupt::asked() {
            monitor.look(LOOK);
        }
        let view = view(&experiment, &mut monitor);
        let received = view.snapshot.row.is_some();
        console.answer(&Answer { text: text(&view, COLUMNS), json: json(&view) })?;
        return Ok(if received { Ending::Done } else { Ending::Negative });
    }
    let fault = |error: std::io::Error| Fault::new(format!("the terminal: {error}")).help("--once needs none");
    let mut terminal = ratatui::try_init().map_err(fault)?;
    let ended = watch(&experiment, &mut monitor, &mut terminal);
    ratatui::restore();
    ended.map_err(fault)?;
    Ok(Ending::Done)
}

/// Draws frames until the user quits.
fn watch(
    experiment: &Experiment,
    monitor: &mut Monitor,
    terminal: &mut ratatui::DefaultTerminal,
) -> std::io::Result<()> {
    while !interrupt::asked() {
        let view = view(experiment, monitor);
        terminal.draw(|frame| draw(frame, &view))?;
        if event::poll(Duration::ZERO)?
            && let Event::Key(key) = event::read()?
        {
            // In raw mode Ctrl-C is a key.
            let interrupted = key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL);
            if interrupted || matches!(key.code, KeyCode::Char('q') | KeyCode::Esc) {
                break;
            }
        }
    }
    Ok(())
}

fn view(experiment: &Experiment, monitor: &mut Monitor) -> View {
    let network = match &experiment.ros2.network {
        Network::Loopback => "loopback",
        Network::Any => "every network",
        Network::Only(_) => "chosen networks",
    };
    let place = format!("ROS domain {}, {network}", experiment.ros2.domain);
    View::new(&experiment.planned.robot.robot, &experiment.guard, &place, monitor.look(LOOK))
}

fn json(view: &View) -> Value {
    let snapshot = &view.snapshot;
    let finite = |value: f64| value.is_finite().then_some(value);
    json!({
        "robot": view.robot,
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
