//! How a motion is sent, and what the robot controller answers.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use ros2_client::action::{ActionClient, ActionClientQosPolicies, GoalId, GoalStatusEnum};
use ros2_client::action_msgs::CancelGoalResponseEnum;
use ros2_client::qos::Durability;
use ros2_client::request_id::RmwRequestId;
use ros2_client::{ActionTypeName, Publisher};

use super::node::{Asked, Peer};
use super::{Endpoint, LinkError, LinkSettings, Mode};
use crate::message::{Float64MultiArray, FollowFeedback, FollowGoal, FollowResult, JointTrajectory};

/// How long the robot controller may take to report whether it accepts a motion.
pub(crate) const ACCEPTANCE: Duration = Duration::from_millis(500);
/// Goals whose end is still of interest: the newest, and the one that it replaces.
const KEPT: usize = 2;

/// Every goal that this process has sent, over any connection: a first run has one for each of its speeds.
static OURS: Mutex<Vec<GoalId>> = Mutex::new(Vec::new());
/// A goal that was sent and has no answer.
struct Unanswered {
    request: RmwRequestId,
    sent: Instant,
    /// When its motion is over, by the motion's time, s: until then it can still be carried out.
    rest_s: f64,
    /// A newer goal was answered, which replaces it.
    replaced: bool,
}

/// One goal of ours.
struct Goal {
    id: GoalId,
    request: RmwRequestId,
    result_request: Option<RmwRequestId>,
    end: Option<(GoalStatusEnum, FollowResult)>,
}

type Client = ActionClient<FollowGoal, FollowResult, FollowFeedback>;

/// An action, and what is known of our goals.
struct Action {
    client: Client,
    goals: Vec<Goal>,
    /// Goals that have no answer yet, oldest first.
    unanswered: Vec<Unanswered>,
    /// Number of goals that were taken.
    taken: usize,
    cancels: Vec<RmwRequestId>,
    /// A goal of another client that is under way, by the newest list.
    stranger: Option<GoalId>,
}

enum Way {
    Action(Box<Action>),
    Topic(Publisher<JointTrajectory>),
    Stream(Publisher<Float64MultiArray>),
}

/// How the newest motion stands, as the robot controller says.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Standing {
    /// It was taken.
    pub(crate) accepted: bool,
    /// It was performed to its end.
    pub(crate) done: bool,
    /// It has ended, or a cancel that was asked for is carried out: nothing of ours moves the arm any more.
    pub(crate) over: bool,
}

/// Hands motions over, or set-points one by one, as the mode says.
pub(crate) struct Sender {
    way: Way,
    /// How far the arm is from the motion, as its controller sees it.
    feedback: Option<FollowFeedback>,
    /// Whether a cancel was asked for, and one that was asked for is carried out.
    cancel: (bool, bool),
}

impl Sender {
    /// Opens the topic or the action of `settings.mode`.
    pub(crate) fn open(endpoint: &mut Endpoint, settings: &LinkSettings) -> Result<Self, LinkError> {
        let qos = settings.command_qos();
        let way = match settings.mode {
            Mode::Trajectory => {
                let name = settings.full(&settings.action);
                let policies = ActionClientQosPolicies {
                    goal_service: qos.clone(),
                    result_service: qos.clone(),
                    cancel_service: qos.clone(),
                    feedback_subscription: qos.clone(),
                    // Goals that were there before are those of another client.
                    status_subscription: qos.durability(Durability::TransientLocal),
                };
                let kind = ActionTypeName::new("control_msgs", "FollowJointTrajectory");
                let client = endpoint
                    .node()
                    .create_action_client(settings.service_mapping.into(), &Endpoint::name(&name)?, &kind, policies)
                    .map_err(|error| LinkError::middleware(format!("action {name}"), &error))?;
                let (goals, cancels, unanswered) = (Vec::new(), Vec::new(), Vec::new());
                Way::Action(Box::new(Action { client, goals, unanswered, taken: 0, cancels, stranger: None }))
            }
            Mode::Topic => {
                let topic = settings.full(&settings.trajectory);
                // The newest alone: what a broken network has held back must not arrive later.
                Way::Topic(endpoint.publisher(
                    &topic,
                    ("trajectory_msgs", "JointTrajectory"),
                    &settings.newest_qos(),
                )?)
            }
            Mode::Stream => {
                let topic = settings.full(&settings.commands);
                Way::Stream(endpoint.publisher(&topic, ("std_msgs", "Float64MultiArray"), &settings.newest_qos())?)
            }
        };
        Ok(Self { way, feedback: None, cancel: (false, false) })
    }

    /// Waits for a subscriber.
    pub(crate) fn wait(&self, endpoint: &Endpoint, settings: &LinkSettings, asked: Asked) -> Result<(), LinkError> {
        let listener = |name: &str| {
            let full = settings.full(name);
            endpoint.wait(&format!("a listener to {full}"), &[(Peer::Reader, format!("rt{full}"))], asked)
        };
        match &self.way {
            Way::Action(_) => {
                // ROS 2 lays an action onto three services; each request has a topic that begins with "rq".
                let full = settings.full(&settings.action);
                let request = |part: &str| (Peer::Reader, format!("rq{full}/_action/{part}Request"));
                let topics = ["send_goal", "cancel_goal", "get_result"].map(request);
                endpoint.wait(&format!("the action {full}"), &topics, asked)
            }
            Way::Topic(_) => listener(&settings.trajectory),
            Way::Stream(_) => listener(&settings.commands),
        }
    }

    /// Begins another motion: whatever was handed over before is past.
    pub(crate) fn begin(&mut self) {
        if let Way::Action(action) = &mut self.way {
            action.unanswered.clear();
        }
    }

    /// Hands a motion over, or a piece of one that rests at `rest_s` of the motion's time. It replaces what was handed
    /// over before. Nothing happens in the mode `stream`.
    pub(crate) fn hand_over(&mut self, trajectory: JointTrajectory, rest_s: f64) -> Result<(), LinkError> {
        let cancelled = std::mem::take(&mut self.cancel).0;
        match &mut self.way {
            Way::Action(action) => {
                if cancelled {
                    // A motion that begins after a cancel of ours: what is said of earlier goals is of no matter.
                    action.goals.clear();
                }
                let sent = action.client.send_goal(FollowGoal { trajectory, ..Default::default() });
                let (request, id) = sent.map_err(|error| LinkError::middleware("goal", &error))?;
                OURS.lock().unwrap_or_else(PoisonError::into_inner).push(id);
                action.unanswered.push(Unanswered { request, sent: Instant::now(), rest_s, replaced: false });
                action.goals.push(Goal { id, request, result_request: None, end: None });
                let old = action.goals.len().saturating_sub(KEPT);
                action.goals.drain(..old);
                Ok(())
            }
            Way::Topic(publisher) => {
                publisher.publish(trajectory).map_err(|error| LinkError::middleware("trajectory", &error.forget_data()))
            }
            Way::Stream(_) => Ok(()),
        }
    }

    /// Whether set-points are wanted.
    pub(crate) const fn streams(&self) -> bool {
        matches!(self.way, Way::Stream(_))
    }

    /// Whether the robot controller reports when a motion has ended.
    pub(crate) const fn tells_the_end(&self) -> bool {
        matches!(self.way, Way::Action(..))
    }

    /// Sends one set-point in the mode `stream`.
    pub(crate) fn set_point(&self, q: &[f64]) -> Result<(), LinkError> {
        let Way::Stream(publisher) = &self.way else { return Ok(()) };
        publisher
            .publish(Float64MultiArray::list(q.to_vec()))
            .map_err(|error| LinkError::middleware("set-point", &error.forget_data()))
    }

    /// Asks for the end of the motion under way: the robot controller brings the arm to rest. On a topic, where there is no
    /// cancel, `hold` takes its place: current controllers refuse an empty trajectory (`ros2_controllers` pull request 902).
    /// Set-points just end.
    ///
    /// Every goal is cancelled, whichever client sent it.
    pub(crate) fn cancel(&mut self, hold: JointTrajectory) -> Result<(), LinkError> {
        self.cancel.0 = true;
        match &mut self.way {
            Way::Action(action) => {
                let one = action.goals.last().map(|goal| action.client.cancel_goal(goal.id));
                for sent in one.into_iter().chain([action.client.cancel_all_goals()]) {
                    action.cancels.push(sent.map_err(|error| LinkError::middleware("cancel", &error))?);
                }
                Ok(())
            }
            Way::Topic(publisher) => {
                publisher.publish(hold).map_err(|error| LinkError::middleware("cancel", &error.forget_data()))
            }
            Way::Stream(_) => Ok(()),
        }
    }

    /// When the last goal without an answer would end, by the motion's time, s. No cancel covers such a goal: the robot
    /// controller may take it after the cancel.
    pub(crate) fn unanswered_until_s(&self) -> Option<f64> {
        let Way::Action(action) = &self.way else { return None };
        action.unanswered.iter().map(|goal| goal.rest_s).reduce(f64::max)
    }

    /// How many goals were taken so far.
    pub(crate) fn taken(&self) -> usize {
        if let Way::Action(action) = &self.way { action.taken } else { 0 }
    }

    /// Ignores answers to the cancels sent so far: a goal was taken after them.
    pub(crate) fn forget_cancels(&mut self) {
        self.cancel.1 = false;
        if let Way::Action(action) = &mut self.way {
            action.cancels.clear();
        }
    }

    /// The last feedback about the motion under way.
    pub(crate) fn feedback(&self) -> Option<&FollowFeedback> {
        self.feedback.as_ref()
    }

    /// What the robot controller has said about the motion under way.
    ///
    /// That our own next piece ends the one before, in any way and however late (`ros2_controllers` issue 1519), is
    /// no fault: the newest goal counts. A goal that is refused is a fault, whichever it is.
    ///
    /// # Errors
    /// [`LinkError::Refused`] and [`LinkError::Aborted`] where it aborts the motion or another client cancels it,
    /// [`LinkError::Interference`] where it follows another client's goal, [`LinkError::NoAcceptance`] where it says
    /// nothing.
    pub(crate) fn poll(&mut self) -> Result<Standing, LinkError> {
        let Way::Action(action) = &mut self.way else { return Ok(Standing::default()) };
        let (asked, carried_out) = &mut self.cancel;
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware("action", error);
        let stranger = action.read_statuses()?;
        if let Some(id) = action.goals.last().map(|goal| goal.id) {
            while let Some(feedback) = action.client.receive_feedback(id).map_err(|error| fault(&error))? {
                self.feedback = Some(feedback);
            }
        }
        *carried_out |= action.read_cancels()?;
        let refused = action.read_acceptances()?;
        action.read_results()?;
        if refused && !*asked {
            let reason = "it does not accept the goal; where it replaces no motion under way, horizon_s = 0 hands the \
                          motion over whole"
                .to_owned();
            return Err(LinkError::Refused { reason });
        }
        let Some(newest) = action.goals.last() else {
            let standing = Standing { over: *carried_out, ..Standing::default() };
            return stranger.filter(|_| !*asked).map_or(Ok(standing), Err);
        };
        let accepted = newest.result_request.is_some();
        if !*asked {
            if let Some(stranger) = stranger {
                return Err(stranger);
            }
            let waited = action.unanswered.iter().find(|goal| !goal.replaced);
            let waited = waited.map_or(Duration::ZERO, |goal| goal.sent.elapsed());
            if waited > ACCEPTANCE {
                let ms = |time: Duration| 1e3 * time.as_secs_f64();
                return Err(LinkError::NoAcceptance { waited_ms: ms(waited), bound_ms: ms(ACCEPTANCE) });
            }
        }
        match &newest.end {
            None => Ok(Standing { accepted, done: false, over: *carried_out }),
            Some((GoalStatusEnum::Succeeded, _)) => Ok(Standing { accepted, done: true, over: true }),
            Some(_) if *asked => Ok(Standing { accepted, done: false, over: true }),
            Some((GoalStatusEnum::Canceled, _)) => {
                Err(LinkError::Aborted { reason: "another client cancelled it".to_owned() })
            }
            Some((_, result)) => {
                let reason = format!("code {}: {}", result.error_code, result.error_string);
                Err(LinkError::Aborted { reason })
            }
        }
    }
}

impl Action {
    /// A running goal of another client, or a cancel of ours that we did not ask for: of the goal before the newest as
    /// well, whose next piece may have come while the arm braked for it.
    ///
    /// Who runs is what the newest list says: one who has just joined may receive older ones first. A cancel is looked for in
    /// all of them, which is why the subscription keeps more than one: the list after it says that the goal has ended, as it
    /// does of a goal that was replaced.
    fn read_statuses(&mut self) -> Result<Option<LinkError>, LinkError> {
        use GoalStatusEnum::{Accepted, Canceling, Executing};
        let mut cancelled = false;
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware("action status", error);
        while let Some(statuses) = self.client.receive_status().map_err(|error| fault(&error))? {
            let ours = OURS.lock().unwrap_or_else(PoisonError::into_inner);
            self.stranger = None;
            for status in statuses.status_list {
                let id = status.goal_info.goal_id;
                if !matches!(status.status, Accepted | Executing | Canceling) {
                    continue;
                }
                if !ours.iter().rev().any(|ours| *ours == id) {
                    self.stranger = Some(id);
                }
                cancelled |= status.status == Canceling && self.goals.iter().any(|goal| goal.id == id);
            }
        }
        Ok(match self.stranger {
            _ if cancelled => Some(LinkError::Interference("another client cancels the motion".to_owned())),
            Some(id) => {
                Some(LinkError::Interference(format!("the robot controller follows a goal of another client ({id:?})")))
            }
            None => None,
        })
    }

    /// Whether a cancel of ours is being carried out, or found nothing left to cancel.
    fn read_cancels(&mut self) -> Result<bool, LinkError> {
        let mut carried_out = false;
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware("cancel", error);
        let client = self.client.cancel_client();
        while let Some((request, answer)) = client.receive_response().map_err(|error| fault(&error))? {
            if !self.cancels.contains(&request) {
                continue;
            }
            carried_out |= match answer.return_code {
                // Whichever goal it names: ours, or the one of another client that moved the arm.
                CancelGoalResponseEnum::None => !answer.goals_canceling.is_empty(),
                CancelGoalResponseEnum::GoalTerminated => true,
                // A goal that it does not list may be one that it has not accepted yet.
                CancelGoalResponseEnum::Rejected | CancelGoalResponseEnum::UnknownGoal => false,
            };
        }
        Ok(carried_out)
    }

    /// Takes what is said of goals: whether one is refused. One that is taken is asked for its result.
    fn read_acceptances(&mut self) -> Result<bool, LinkError> {
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware("goal", error);
        let mut refused = false;
        while let Some((request, answer)) = self.client.goal_client().receive_response().map_err(|e| fault(&e))? {
            self.taken += usize::from(answer.accepted);
            if let Some(k) = self.unanswered.iter().position(|goal| goal.request == request) {
                self.unanswered.remove(k);
                self.unanswered[..k].iter_mut().for_each(|goal| goal.replaced = true);
                refused |= !answer.accepted;
            }
            let Some(k) = self.goals.iter().position(|goal| goal.request == request) else { continue };
            if answer.accepted {
                let asked = self.client.request_result(self.goals[k].id).map_err(|error| fault(&error))?;
                self.goals[k].result_request = Some(asked);
            } else {
                refused = true;
                self.goals.remove(k);
            }
        }
        Ok(refused)
    }

    fn read_results(&mut self) -> Result<(), LinkError> {
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware("result", error);
        while let Some((request, answer)) = self.client.result_client().receive_response().map_err(|e| fault(&e))? {
            if let Some(goal) = self.goals.iter_mut().find(|goal| goal.result_request == Some(request)) {
                goal.end = Some((answer.status, answer.result));
            }
        }
        Ok(())
    }
}
