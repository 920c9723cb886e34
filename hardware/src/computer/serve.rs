//! The robot's computer in real time: steps by the wall clock, orders from the network, news to it.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::Duration;

use armid::experiment::{Plant, PlantError};

use super::pace::Pace;
use super::wire::{Event, Order, Wire};
use super::{Deadlines, FaultKind, Output, RobotController, StepLog};
use crate::link::{LinkError, LinkSettings};
use crate::message::{FollowFeedback, TrajectoryPoint};

/// How to serve.
#[derive(Clone, Debug, Default)]
pub struct ServeOptions {
    /// The network and its names.
    pub link: LinkSettings,
    /// Where the log goes, if anywhere.
    pub log: Option<PathBuf>,
    /// How long, by the robot's clock; for ever where there is none, s.
    pub duration_s: Option<f64>,
}

/// Why the robot's computer stopped.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// No network.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The plant gave up.
    #[error("the plant gave up: {0}")]
    Plant(#[from] PlantError),
    /// No log.
    #[error("{path}: {reason}")]
    Log {
        /// Which file.
        path: String,
        /// What the system says.
        reason: std::io::Error,
    },
}

/// How it goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// By the robot's clock, s.
    pub t: f64,
    /// The state of the computer in words.
    pub state: String,
    /// How the deadlines are kept.
    pub deadlines: Deadlines,
    /// Orders that have arrived.
    pub orders: u64,
}

/// How often the state in words goes out, and feedback about a motion, in steps of the servo.
const WORDS_S: f64 = 0.05;
/// How late answers are in [`FaultKind::LateAnswer`], s.
const LATE_S: f64 = 1.0;
/// How long the network is given to take the last news.
const FAREWELL: Duration = Duration::from_millis(50);

/// Serves until `go_on` says no or the time is over. `go_on` receives how it goes ten times a second.
///
/// # Errors
/// [`ServeError`] where the network or the log cannot be opened, or the plant gives up.
pub fn serve<P: Plant>(
    computer: &mut RobotController<P>,
    options: &ServeOptions,
    go_on: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Progress, ServeError> {
    let names = options.log.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
    let log_fault = |reason| ServeError::Log { path: names.clone(), reason };
    let mut log = StepLog::create(options.log.as_deref(), computer.robot().dof()).map_err(log_fault)?;
    let wire = Wire::open(&options.link, computer.limits().to_vec(), computer.replacement())?;
    let mut pace = Pace::new(computer.dt());
    let every = (WORDS_S / computer.dt()).round().max(1.0) as u64;
    let mut output = Vec::new();
    let (mut steps, mut orders, mut last_state) = (0_u64, 0_u64, String::new());
    let mut late: VecDeque<(f64, Event)> = VecDeque::new();
    loop {
        for order in wire.orders.try_iter() {
            orders += 1;
            if let Some(answer) = obey(computer, order) {
                let due_s = if computer.struck() == Some(FaultKind::LateAnswer) { computer.t() + LATE_S } else { 0.0 };
                late.push_back((due_s, answer));
            }
        }
        while late.front().is_some_and(|(due_s, _)| *due_s <= computer.t()) {
            late.drain(..1).for_each(|(_, answer)| send(&wire, answer));
        }
        let mut feedback = None;
        output.clear();
        computer.step(&mut output, &mut |report| {
            log.write(report);
            if report.doing == "follow" && steps.is_multiple_of(every) {
                feedback = Some((report.command.to_vec(), report.q.to_vec()));
            }
        })?;
        let state = computer.state();
        for out in output.drain(..) {
            match out {
                Output::State(state) => send(&wire, Event::State(state)),
                Output::Ended(..) if computer.struck() == Some(FaultKind::LostResult) => {}
                Output::Ended(outcome, reason) => send(&wire, Event::Ended(outcome, reason)),
                Output::Die => std::process::abort(),
            }
        }
        if !computer.is_frozen() {
            if state != last_state || steps.is_multiple_of(every) {
                send(&wire, Event::Words(state.clone()));
            }
            if let Some((desired, actual)) = feedback {
                send(&wire, Event::Feedback(Box::new(feedback_of(computer, desired, actual))));
            }
        }
        last_state = state;
        steps += 1;
        let over = options.duration_s.is_some_and(|duration| computer.t() >= duration);
        if over || steps.is_multiple_of(2 * every) {
            // The deadline of the last step is still to come.
            let deadlines = Deadlines { steps, ..pace.deadlines() };
            let progress = Progress { t: computer.t(), state: last_state.clone(), deadlines, orders };
            if over || !go_on(&progress) {
                std::thread::sleep(FAREWELL);
                return Ok(progress);
            }
        }
        pace.wait();
    }
}

/// Hands news to the wire; where its thread is gone there is nobody to report.
fn send(wire: &Wire, news: Event) {
    let _ = wire.news.send(news);
}

/// Does what somebody wants; a goal has an answer.
fn obey<P: Plant>(computer: &mut RobotController<P>, order: Order) -> Option<Event> {
    match order {
        Order::Goal(number, motion) => {
            let taken = motion.map_err(|unfit| unfit.reason).and_then(|motion| computer.follow(motion));
            return (!computer.is_frozen()).then_some(Event::Taken(number, taken));
        }
        Order::Motion(motion) => {
            // Nobody receives why it is refused but the log.
            match motion {
                Ok(motion) => drop(computer.follow(motion)),
                Err(unfit) => computer.remark(&format!("motion refused: {}", unfit.reason)),
            }
        }
        Order::Cancel => {
            if !computer.cancel() {
                computer.remark("cancel heard");
            }
        }
        Order::SetPoint(goal) => {
            computer.set_point(&goal);
        }
        Order::Disable => {
            if !computer.disable("disabled: as requested") {
                computer.remark("disable heard");
            }
        }
    }
    None
}

fn feedback_of<P: Plant>(computer: &RobotController<P>, desired: Vec<f64>, actual: Vec<f64>) -> FollowFeedback {
    let point = |positions: Vec<f64>| TrajectoryPoint { positions, ..Default::default() };
    let error = desired.iter().zip(&actual).map(|(desired, actual)| desired - actual).collect();
    FollowFeedback {
        joint_names: computer.robot().joints().iter().map(|joint| joint.name.clone()).collect(),
        desired: point(desired),
        actual: point(actual),
        error: point(error),
        ..Default::default()
    }
}
