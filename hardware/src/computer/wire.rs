//! The ROS 2 side of the robot controller, on a thread of its own: what arrives becomes orders, what happens goes out.

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use ros2_client::action::{
    ActionServer, ActionServerQosPolicies, GetResultResponse, GoalId, GoalInfo, GoalStatusEnum, SendGoalResponse,
};
use ros2_client::action_msgs::{CancelGoalResponse, CancelGoalResponseEnum, GoalStatus, GoalStatusArray};
use ros2_client::builtin_interfaces;
use ros2_client::qos::{Durability, History};
use ros2_client::request_id::RmwRequestId;
use ros2_client::{ActionTypeName, Publisher, Subscription};

use super::commander::Outcome;
use super::{JointLimits, Replacement, Spline, Unfit};
use crate::link::{Endpoint, JointMap, LinkError, LinkSettings};
use crate::message::{Float64MultiArray, FollowFeedback, FollowGoal, FollowResult, JointState, JointTrajectory, Text};

/// An order from the network.
pub(crate) enum Order {
    /// A motion as a goal of the action, by its number; checked already.
    Goal(u64, Result<Spline, Unfit>),
    /// A motion on the topic.
    Motion(Result<Spline, Unfit>),
    /// Come to rest.
    Cancel,
    /// One set-point, in the order of the robot file.
    SetPoint(Vec<f64>),
    /// Motors off.
    Disable,
}

/// What is sent to the network.
pub(crate) enum Event {
    State(JointState),
    Words(String),
    /// Whether a goal was taken, by its number.
    Taken(u64, Result<(), String>),
    /// How the goal under way has ended.
    Ended(Outcome, String),
    Feedback(Box<FollowFeedback>),
}

/// How long the thread sleeps when there is nothing to say, at most.
const NAP: Duration = Duration::from_millis(1);
/// Time between two looks at whether the middleware still works.
const LOOK_EVERY: Duration = Duration::from_millis(100);

type Server = ActionServer<FollowGoal, FollowResult, FollowFeedback>;

/// The other end of the thread; its orders end where the middleware has.
pub(crate) struct Wire {
    pub(crate) orders: Receiver<Order>,
    pub(crate) events: Sender<Event>,
}

impl Wire {
    /// Opens every topic and the action of `settings` for joints called `joints`.
    pub(crate) fn open(
        settings: &LinkSettings,
        limits: Vec<JointLimits>,
        replacement: Replacement,
        refusals: u64,
    ) -> Result<Self, LinkError> {
        let names: Vec<String> = limits.iter().map(|joint| joint.name.clone()).collect();
        let map = JointMap::new(&names, settings)?;
        let mut endpoint = Endpoint::join(settings, "robot_computer")?;
        let (state, qos, reports) = (settings.state_qos(), settings.command_qos(), settings.report_qos());
        let text = ("std_msgs", "String");
        let optional = |name: &str| (!name.is_empty()).then(|| settings.full(name));
        let action = Endpoint::name(&settings.full(&settings.action))?;
        let policies = ActionServerQosPolicies {
            goal_service: qos.clone(),
            result_service: qos.clone(),
            cancel_service: qos.clone(),
            feedback_publisher: reports.clone(),
            // As in rcl: who joins later receives the newest list.
            status_publisher: reports
                .clone()
                .durability(Durability::TransientLocal)
                .history(History::KeepLast { depth: 1 }),
        };
        let kind = ActionTypeName::new("control_msgs", "FollowJointTrajectory");
        let server = endpoint
            .node()
            .create_action_server(settings.service_mapping.into(), &action, &kind, policies)
            .map_err(|error| LinkError::middleware(format!("action {}", settings.action), &error))?;
        let joint_states =
            endpoint.publisher(&settings.full(&settings.joint_states), ("sensor_msgs", "JointState"), &state)?;
        let trajectories = endpoint.subscription(
            &settings.full(&settings.trajectory),
            ("trajectory_msgs", "JointTrajectory"),
            &qos,
        )?;
        let commands =
            endpoint.subscription(&settings.full(&settings.commands), ("std_msgs", "Float64MultiArray"), &qos)?;
        let words =
            optional(&settings.robot_state).map(|name| endpoint.publisher(&name, text, &reports)).transpose()?;
        let requests =
            optional(&settings.robot_request).map(|name| endpoint.subscription(&name, text, &qos)).transpose()?;
        let (orders_in, orders) = channel();
        let (events, events_out) = channel();
        let mut thread = Thread {
            endpoint,
            map,
            limits,
            server,
            joint_states,
            trajectories,
            commands,
            words,
            requests,
            orders: orders_in,
            goals: BTreeMap::new(),
            results: Vec::new(),
            under_way: None,
            replacement,
            refusals,
            count: 0,
        };
        std::thread::Builder::new()
            .name("wire".to_owned())
            .spawn(move || thread.run(&events_out))
            .map_err(|error| LinkError::middleware("wire", &error))?;
        Ok(Self { orders, events })
    }
}

struct Goal {
    id: GoalId,
    request: RmwRequestId,
    status: GoalStatusEnum,
    end: Option<(GoalStatusEnum, FollowResult)>,
}

struct Thread {
    /// Keeps the node on the network.
    endpoint: Endpoint,
    map: JointMap,
    limits: Vec<JointLimits>,
    server: Server,
    joint_states: Publisher<JointState>,
    trajectories: Subscription<JointTrajectory>,
    commands: Subscription<Float64MultiArray>,
    words: Option<Publisher<Text>>,
    requests: Option<Subscription<Text>>,
    orders: Sender<Order>,
    goals: BTreeMap<u64, Goal>,
    /// Who has asked for which result.
    results: Vec<(RmwRequestId, GoalId)>,
    under_way: Option<u64>,
    replacement: Replacement,
    refusals: u64,
    count: u64,
}

impl Thread {
    /// Runs until the controller or the middleware has ended. What cannot be sent is lost, as on any network: who misses it will trip.
    fn run(&mut self, events: &Receiver<Event>) {
        let mut looked = Instant::now();
        loop {
            if looked.elapsed() > LOOK_EVERY {
                looked = Instant::now();
                if !self.endpoint.is_alive() {
                    return;
                }
            }
            match events.recv_timeout(NAP) {
                Ok(first) => {
                    self.publish(first);
                    while let Ok(more) = events.try_recv() {
                        self.publish(more);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            if self.listen().is_err() {
                return;
            }
            self.answer();
        }
    }

    fn publish(&mut self, event: Event) {
        match event {
            Event::State(state) => {
                let _ = self.joint_states.publish(state);
            }
            Event::Words(data) => {
                if let Some(words) = &self.words {
                    let _ = words.publish(Text { data });
                }
            }
            Event::Taken(number, taken) => self.taken(number, taken),
            Event::Ended(outcome, reason) => self.ended(outcome, reason),
            Event::Feedback(feedback) => {
                if let Some(goal) = self.under_way.and_then(|number| self.goals.get(&number)) {
                    let _ = self.server.send_feedback(goal.id, *feedback);
                }
            }
        }
    }

    fn taken(&mut self, number: u64, taken: Result<(), String>) {
        let Some(goal) = self.goals.get_mut(&number) else { return };
        let stamp = builtin_interfaces::Time::now();
        let _ = self.server.send_goal_response(goal.request, SendGoalResponse { accepted: taken.is_ok(), stamp });
        if taken.is_ok() {
            goal.status = GoalStatusEnum::Executing;
            // The goal that it replaces has ended.
            let old = self.under_way.replace(number).filter(|_| self.replacement != Replacement::LateEnd);
            if let Some(old) = old.and_then(|old| self.goals.get_mut(&old)) {
                let error_string = "replaced by another goal".to_owned();
                old.status = GoalStatusEnum::Aborted;
                old.end = Some((old.status, FollowResult { error_code: FollowResult::INVALID_GOAL, error_string }));
            }
            self.publish_statuses();
        } else {
            self.goals.remove(&number);
        }
    }

    fn ended(&mut self, outcome: Outcome, reason: String) {
        let Some(goal) = self.under_way.take().and_then(|number| self.goals.get_mut(&number)) else { return };
        let (status, error_code) = match outcome {
            Outcome::Succeeded => (GoalStatusEnum::Succeeded, FollowResult::SUCCESSFUL),
            Outcome::Cancelled => (GoalStatusEnum::Canceled, FollowResult::SUCCESSFUL),
            Outcome::Aborted => (GoalStatusEnum::Aborted, FollowResult::PATH_TOLERANCE_VIOLATED),
        };
        goal.status = status;
        goal.end = Some((status, FollowResult { error_code, error_string: reason }));
        // Goals that were replaced and are not said to have ended yet.
        let said = |status| matches!(status, GoalStatusEnum::Executing | GoalStatusEnum::Canceling);
        for old in self.goals.values_mut().filter(|old| old.end.is_none() && said(old.status)) {
            old.status = GoalStatusEnum::Canceled;
            old.end = Some((old.status, FollowResult::default()));
        }
        self.publish_statuses();
    }

    fn publish_statuses(&self) {
        let stamp = builtin_interfaces::Time::now();
        let status = |goal: &Goal| GoalStatus { goal_info: GoalInfo { goal_id: goal.id, stamp }, status: goal.status };
        let _ =
            self.server.send_goal_statuses(GoalStatusArray { status_list: self.goals.values().map(status).collect() });
    }

    /// Turns what has arrived into orders. Bytes that are no message are passed over.
    fn listen(&mut self) -> Result<(), std::sync::mpsc::SendError<Order>> {
        while let Ok(Some((request, goal))) = self.server.receive_goal() {
            self.count += 1;
            let motion = if self.count > self.refusals {
                Spline::new(&goal.goal.trajectory, &self.map, &self.limits)
            } else {
                Err(Unfit { code: FollowResult::INVALID_GOAL, reason: "one of the first goals".to_owned() })
            };
            let status = GoalStatusEnum::Accepted;
            self.goals.insert(self.count, Goal { id: goal.goal_id, request, status, end: None });
            self.orders.send(Order::Goal(self.count, motion))?;
        }
        // Only one goal is ever under way, so a cancel of any goal means that one.
        while let Ok(Some((request, _))) = self.server.receive_cancel_request() {
            let stamp = builtin_interfaces::Time::now();
            let goal = self.under_way.and_then(|number| self.goals.get(&number));
            let goals_canceling: Vec<GoalInfo> =
                goal.map(|goal| GoalInfo { goal_id: goal.id, stamp }).into_iter().collect();
            let return_code = if goals_canceling.is_empty() {
                CancelGoalResponseEnum::GoalTerminated
            } else {
                CancelGoalResponseEnum::None
            };
            self.orders.send(Order::Cancel)?;
            let _ = self.server.send_cancel_response(request, CancelGoalResponse { return_code, goals_canceling });
            if let Some(goal) = self.under_way.and_then(|number| self.goals.get_mut(&number)) {
                goal.status = GoalStatusEnum::Canceling;
                self.publish_statuses();
            }
        }
        while let Ok(Some((request, wanted))) = self.server.receive_result_request() {
            self.results.push((request, wanted.goal_id));
        }
        while let Ok(Some((trajectory, _))) = self.trajectories.take() {
            // One without points is refused, as by current controllers (ros2_controllers pull request 902).
            self.orders.send(Order::Motion(Spline::new(&trajectory, &self.map, &self.limits)))?;
        }
        while let Ok(Some((command, _))) = self.commands.take() {
            self.orders.send(Order::SetPoint(command.data))?;
        }
        while let Some(Ok(Some((text, _)))) = self.requests.as_ref().map(Subscription::take) {
            if text.data == "disable" {
                self.orders.send(Order::Disable)?;
            }
        }
        Ok(())
    }

    /// Answers those who asked for a result that is there now; an unknown goal is answered too.
    fn answer(&mut self) {
        let (server, goals) = (&self.server, &mut self.goals);
        let mut answered = None;
        self.results.retain(|(request, id)| {
            let found = goals.iter().find(|(_, goal)| goal.id == *id);
            let (status, result) = match found {
                Some((_, Goal { end: None, .. })) => return true,
                Some((number, Goal { end: Some(end), .. })) => {
                    answered = Some(*number);
                    end.clone()
                }
                None => (GoalStatusEnum::Unknown, FollowResult { error_code: -1, error_string: "unknown goal".into() }),
            };
            let _ = server.send_result(*request, GetResultResponse { status, result });
            false
        });
        if let Some(answered) = answered {
            // Goals that ended before it have been asked for, or never will be.
            goals.retain(|number, _| *number >= answered);
        }
    }
}
