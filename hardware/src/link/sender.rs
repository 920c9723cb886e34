//! The way a motion goes out.

use ros2_client::action::{ActionClient, ActionClientQosPolicies, GoalId, GoalStatusEnum};
use ros2_client::request_id::RmwRequestId;
use ros2_client::{ActionTypeName, Publisher};

use super::node::Other;
use super::{Endpoint, LinkError, LinkSettings, Mode};
use crate::message::{Float64MultiArray, FollowFeedback, FollowGoal, FollowResult, JointTrajectory};

/// How far a motion that was handed over has come.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Progress {
    /// Nothing new.
    Pending,
    /// The robot's computer took it.
    Accepted,
    /// It was performed to its end.
    Done,
    /// It was cancelled, and the arm has come to rest.
    Cancelled,
}

/// The goal of the motion under way.
struct Goal {
    id: GoalId,
    request: RmwRequestId,
    result: Option<RmwRequestId>,
}

type Client = ActionClient<FollowGoal, FollowResult, FollowFeedback>;

enum Way {
    Action(Box<Client>, Option<Goal>),
    Topic(Publisher<JointTrajectory>),
    Stream(Publisher<Float64MultiArray>),
}

/// Hands motions over, or set-points one by one, as the mode says.
pub(crate) struct Sender {
    way: Way,
    /// How far the arm is from the motion, as its computer sees it.
    feedback: Option<FollowFeedback>,
}

impl Sender {
    /// Opens the way of `settings.mode`.
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
                    status_subscription: qos,
                };
                let kind = ActionTypeName::new("control_msgs", "FollowJointTrajectory");
                let client = endpoint
                    .node()
                    .create_action_client(settings.service_mapping.into(), &Endpoint::name(&name)?, &kind, policies)
                    .map_err(|error| LinkError::middleware(format!("action {name}"), &error))?;
                Way::Action(Box::new(client), None)
            }
            Mode::Topic => {
                let topic = settings.full(&settings.trajectory);
                Way::Topic(endpoint.publisher(&topic, ("trajectory_msgs", "JointTrajectory"), &qos)?)
            }
            Mode::Stream => {
                let topic = settings.full(&settings.commands);
                Way::Stream(endpoint.publisher(&topic, ("std_msgs", "Float64MultiArray"), &qos)?)
            }
        };
        Ok(Self { way, feedback: None })
    }

    /// Waits until somebody listens.
    pub(crate) fn wait(&self, endpoint: &Endpoint, settings: &LinkSettings) -> Result<(), LinkError> {
        let listener = |name: &str| {
            let full = settings.full(name);
            endpoint.wait(&format!("a listener to {full}"), &[(Other::Reader, format!("rt{full}"))])
        };
        match &self.way {
            Way::Action(..) => {
                // ROS 2 lays an action onto three services; each request has a topic that begins with "rq".
                let full = settings.full(&settings.action);
                let request = |part: &str| (Other::Reader, format!("rq{full}/_action/{part}Request"));
                let topics = ["send_goal", "cancel_goal", "get_result"].map(request);
                endpoint.wait(&format!("the action {full}"), &topics)
            }
            Way::Topic(_) => listener(&settings.trajectory),
            Way::Stream(_) => listener(&settings.commands),
        }
    }

    /// Hands a whole motion over. Nothing happens in the mode `stream`.
    pub(crate) fn hand_over(&mut self, trajectory: JointTrajectory) -> Result<(), LinkError> {
        match &mut self.way {
            Way::Action(client, goal) => {
                let sent = client.send_goal(FollowGoal { trajectory, ..Default::default() });
                let (request, id) = sent.map_err(|error| LinkError::middleware("goal", &error))?;
                *goal = Some(Goal { id, request, result: None });
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

    /// Whether the robot's computer tells when a motion has ended.
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

    /// Cancels the motion under way: the robot's computer brings the arm to rest. Set-points just end.
    pub(crate) fn cancel(&mut self) -> Result<(), LinkError> {
        match &mut self.way {
            Way::Action(client, Some(goal)) => {
                client.cancel_goal(goal.id).map(|_| ()).map_err(|error| LinkError::middleware("cancel", &error))
            }
            Way::Topic(publisher) => publisher
                .publish(JointTrajectory::default())
                .map_err(|error| LinkError::middleware("cancel", &error.forget_data())),
            Way::Action(_, None) | Way::Stream(_) => Ok(()),
        }
    }

    /// The last feedback about the motion under way.
    pub(crate) fn feedback(&self) -> Option<&FollowFeedback> {
        self.feedback.as_ref()
    }

    /// What the robot's computer has to say about the motion under way.
    pub(crate) fn poll(&mut self) -> Result<Progress, LinkError> {
        let Way::Action(client, under_way) = &mut self.way else { return Ok(Progress::Pending) };
        let Some(goal) = under_way else { return Ok(Progress::Pending) };
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware("action", error);
        while let Some(feedback) = client.receive_feedback(goal.id).map_err(|error| fault(&error))? {
            self.feedback = Some(feedback);
        }
        let Some(result) = goal.result else {
            let answer = client.receive_goal_response(goal.request).map_err(|error| fault(&error))?;
            let Some(answer) = answer else { return Ok(Progress::Pending) };
            if !answer.accepted {
                *under_way = None;
                return Err(LinkError::Refused { reason: "it does not accept the goal".to_owned() });
            }
            goal.result = Some(client.request_result(goal.id).map_err(|error| fault(&error))?);
            return Ok(Progress::Accepted);
        };
        let Some((status, result)) = client.receive_result(result).map_err(|error| fault(&error))? else {
            return Ok(Progress::Pending);
        };
        *under_way = None;
        match status {
            GoalStatusEnum::Succeeded => Ok(Progress::Done),
            GoalStatusEnum::Canceled => Ok(Progress::Cancelled),
            _ => Err(LinkError::Aborted { reason: format!("code {}: {}", result.error_code, result.error_string) }),
        }
    }
}
