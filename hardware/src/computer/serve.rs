//! The robot controller in real time: steps by the wall clock, orders from the network, events to it.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::mpsc::TryRecvError;
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
    /// How many goals are refused before the first is taken.
    pub refusals: u64,
}

/// Why the robot controller stopped.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum ServeError {
    /// No network.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The plant failed.
    #[error("the plant failed: {0}")]
    Plant(#[from] PlantError),
    /// No log.
    #[error("{path}: {reason}")]
    Log { path: String, reason: std::io::Error },
}

/// How it goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// By the robot's clock, s.
    pub t: f64,
    /// The state of the controller in words.
    pub state: String,
    /// How the deadlines are kept.
    pub deadlines: Deadlines,
    /// Orders that have arrived.
    pub orders: u64,
}

/// Time between two reports of the state in words, and between two of feedback about a motion, s.
const WORDS_S: f64 = 0.05;
/// How late answers are in [`FaultKind::LateAnswer`], s.
const LATE_S: f64 = 1.0;
/// How long the network is given to take the last events.
const FAREWELL: Duration = Duration::from_millis(50);

/// Serves until `go_on` says no or the time is over. `go_on` receives how it goes ten times a second.
///
/// # Errors
/// [`ServeError`] where the network or the log cannot be opened, the plant fails, or a thread of the middleware ends.
pub fn serve<P: Plant>(
    controller: &mut RobotController<P>,
    options: &ServeOptions,
    go_on: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Progress, ServeError> {
    let names = options.log.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
    let log_fault = |reason| ServeError::Log { path: names.clone(), reason };
    let mut log = StepLog::create(options.log.as_deref(), controller.robot().dof()).map_err(log_fault)?;
    let (limits, replacement) = (controller.limits().to_vec(), controller.replacement());
    let wire = Wire::open(&options.link, limits, replacement, options.refusals)?;
    let mut pace = Pace::new(controller.dt());
    let every = (WORDS_S / controller.dt()).round().max(1.0) as u64;
    let mut output = Vec::new();
    let (mut steps, mut orders, mut last_state) = (0_u64, 0_u64, String::new());
    let mut late: VecDeque<(f64, Event)> = VecDeque::new();
    let (mut goals, mut lost): (VecDeque<(f64, Order)>, bool) = (VecDeque::new(), false);
    loop {
        let mut due = Vec::new();
        loop {
            let order = match wire.orders.try_recv() {
                Ok(order) => order,
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return Err(LinkError::Thread.into()),
            };
            orders += 1;
            let is_goal = matches!(order, Order::Goal(..));
            let lost_s = controller.size_of(FaultKind::LostGoal).filter(|_| is_goal && !lost);
            lost |= lost_s.is_some();
            let late_s = controller.size_of(FaultKind::LateExecution).or(lost_s);
            // Goals keep their order: one behind a goal that is late waits for it.
            let before_s = goals.back().map(|(due_s, _)| *due_s);
            match late_s.map(|late_s| controller.t() + late_s).or(before_s).filter(|_| is_goal) {
                Some(due_s) => goals.push_back((before_s.map_or(due_s, |before_s| due_s.max(before_s)), order)),
                None => due.push(order),
            }
        }
        while goals.front().is_some_and(|(due_s, _)| *due_s <= controller.t()) {
            due.extend(goals.pop_front().map(|(_, order)| order));
        }
        for order in due {
            if let Some(answer) = execute(controller, order) {
                let due_s =
                    if controller.struck() == Some(FaultKind::LateAnswer) { controller.t() + LATE_S } else { 0.0 };
                late.push_back((due_s, answer));
            }
        }
        while late.front().is_some_and(|(due_s, _)| *due_s <= controller.t()) {
            late.drain(..1).for_each(|(_, answer)| send(&wire, answer));
        }
        if let Some(rate) = controller.size_of(FaultKind::Rate) {
            pace.set_rate(controller.dt(), rate);
        }
        let mut feedback = None;
        output.clear();
        controller.step(&mut output, &mut |report| {
            log.write(report);
            if report.doing == "follow" && steps.is_multiple_of(every) {
                feedback = Some((report.command.to_vec(), report.q.to_vec()));
            }
        })?;
        let state = controller.state();
        for out in output.drain(..) {
            match out {
                Output::State(state) => send(&wire, Event::State(state)),
                Output::Ended(..) if controller.struck() == Some(FaultKind::LostResult) => {}
                Output::Ended(outcome, reason) => send(&wire, Event::Ended(outcome, reason)),
                Output::Die => std::process::abort(),
            }
        }
        if !controller.is_frozen() {
            if state != last_state || steps.is_multiple_of(every) {
                send(&wire, Event::Words(state.clone()));
            }
            if let Some((desired, actual)) = feedback {
                send(&wire, Event::Feedback(Box::new(feedback_of(controller, desired, actual))));
            }
        }
        last_state = state;
        steps += 1;
        let over = options.duration_s.is_some_and(|duration| controller.t() >= duration);
        if over || steps.is_multiple_of(2 * every) {
            // The deadline of the last step is still to come.
            let deadlines = Deadlines { steps, ..pace.deadlines() };
            let progress = Progress { t: controller.t(), state: last_state.clone(), deadlines, orders };
            if over || !go_on(&progress) {
                std::thread::sleep(FAREWELL);
                return Ok(progress);
            }
        }
        pace.wait();
    }
}

/// Hands an event to the wire; where its thread has ended there is nothing to report to.
fn send(wire: &Wire, event: Event) {
    let _ = wire.events.send(event);
}

/// Carries out an order; a goal has an answer.
fn execute<P: Plant>(controller: &mut RobotController<P>, order: Order) -> Option<Event> {
    match order {
        Order::Goal(number, motion) => {
            let taken = motion.map_err(|unfit| unfit.reason).and_then(|motion| controller.follow(motion));
            return (!controller.is_frozen()).then_some(Event::Taken(number, taken));
        }
        Order::Motion(motion) => {
            // Only the log receives the reason.
            match motion {
                Ok(motion) => drop(controller.follow(motion)),
                Err(unfit) => controller.remark(&format!("motion refused: {}", unfit.reason)),
            }
        }
        Order::Cancel => {
            if !controller.cancel() {
                controller.remark("cancel received");
            }
        }
        Order::SetPoint(goal) => {
            controller.set_point(&goal);
        }
        Order::Disable => {
            if !controller.disable("disabled: as requested") {
                controller.remark("disable received");
            }
        }
    }
    None
}

fn feedback_of<P: Plant>(controller: &RobotController<P>, desired: Vec<f64>, actual: Vec<f64>) -> FollowFeedback {
    let point = |positions: Vec<f64>| TrajectoryPoint { positions, ..Default::default() };
    let error = desired.iter().zip(&actual).map(|(desired, actual)| desired - actual).collect();
    FollowFeedback {
        joint_names: controller.robot().joints().iter().map(|joint| joint.name.clone()).collect(),
        desired: point(desired),
        actual: point(actual),
        error: point(error),
        ..Default::default()
    }
}
