"""Another client on the robot's network: cancels, commands, or answers in its place, by Cyclone DDS.

    foreign.py foreign-cancel|foreign-goal|foreign-state|second-robot DOMAIN
"""

import sys
import time
from dataclasses import dataclass

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import array, float64, sequence, uint8, uint16
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

from ros2_types import LOOPBACK, QOS, Duration_, Header_, JointState_, JointTrajectory_, JointTrajectoryPoint_, String_, Time_

ACTION = "rq/joint_trajectory_controller/follow_joint_trajectory/_action"
JOINTS = ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch", "tool_roll"]


@dataclass
@final
class UUID_(IdlStruct, typename="unique_identifier_msgs.msg.dds_.UUID_"):
    uuid: array[uint8, 16]


@dataclass
@final
class GoalInfo_(IdlStruct, typename="action_msgs.msg.dds_.GoalInfo_"):
    goal_id: UUID_
    stamp: Time_


@dataclass
@final
class CancelGoal_Request_(IdlStruct, typename="action_msgs.srv.dds_.CancelGoal_Request_"):
    goal_info: GoalInfo_


@dataclass
@final
class Nothing_(IdlStruct, typename="geometry_msgs.msg.dds_.Nothing_"):
    """Stands for messages of which every list is empty."""

    value: float64


@dataclass
@final
class MultiDOFJointTrajectory_(IdlStruct, typename="trajectory_msgs.msg.dds_.MultiDOFJointTrajectory_"):
    header: Header_
    joint_names: sequence[str]
    points: sequence[Nothing_]


@dataclass
@final
class JointTolerance_(IdlStruct, typename="control_msgs.msg.dds_.JointTolerance_"):
    name: str
    position: float64
    velocity: float64
    acceleration: float64


@dataclass
@final
class JointComponentTolerance_(IdlStruct, typename="control_msgs.msg.dds_.JointComponentTolerance_"):
    joint_name: str
    component: uint16
    position: float64
    velocity: float64
    acceleration: float64


@dataclass
@final
class FollowJointTrajectory_Goal_(IdlStruct, typename="control_msgs.action.dds_.FollowJointTrajectory_Goal_"):
    trajectory: JointTrajectory_
    multi_dof_trajectory: MultiDOFJointTrajectory_
    path_tolerance: sequence[JointTolerance_]
    component_path_tolerance: sequence[JointComponentTolerance_]
    goal_tolerance: sequence[JointTolerance_]
    component_goal_tolerance: sequence[JointComponentTolerance_]
    goal_time_tolerance: Duration_


@dataclass
@final
class SendGoal_Request_(IdlStruct, typename="control_msgs.action.dds_.FollowJointTrajectory_SendGoal_Request_"):
    goal_id: UUID_
    goal: FollowJointTrajectory_Goal_


def header():
    return Header_(Time_(0, 0), "")


def cancel():
    """Every goal of any client."""
    return CancelGoal_Request_(GoalInfo_(UUID_([0] * 16), Time_(0, 0)))


def goal():
    """Two seconds to straight up, from wherever the arm is."""
    zero = [0.0] * len(JOINTS)
    point = JointTrajectoryPoint_(zero, zero, zero, [], Duration_(2, 0))
    nothing = MultiDOFJointTrajectory_(header(), [], [])
    trajectory = JointTrajectory_(header(), JOINTS, [point])
    return SendGoal_Request_(
        UUID_(list(range(16))), FollowJointTrajectory_Goal_(trajectory, nothing, [], [], [], [], Duration_(0, 0))
    )


def state(k):
    """A robot that stands straight up, whose clock is another."""
    zero = [0.0] * len(JOINTS)
    stamp = 1_000_000_000 * 100 + k * 2_000_000
    return JointState_(Header_(Time_(stamp // 10**9, stamp % 10**9), ""), JOINTS, zero, zero, zero)


# Topic, type, message by its number, how many, and s between two.
ROWS = {
    "foreign-cancel": (f"{ACTION}/cancel_goalRequest", CancelGoal_Request_, lambda _: cancel(), 1, 0.0),
    "foreign-goal": (f"{ACTION}/send_goalRequest", SendGoal_Request_, lambda _: goal(), 1, 0.0),
    "foreign-state": ("rt/robot_state", String_, lambda _: String_("enabled homed follow"), 60, 0.05),
    "second-robot": ("rt/joint_states", JointState_, state, 1500, 0.002),
}


def main():
    row, number = sys.argv[1], int(sys.argv[2])
    topic, kind, message, count, every = ROWS[row]
    domain = Domain(number, LOOPBACK)
    participant = DomainParticipant(number)
    writer = DataWriter(participant, Topic(participant, topic, kind, qos=QOS), qos=QOS)
    deadline = time.monotonic() + 10
    while not writer.get_matched_subscriptions():
        if time.monotonic() > deadline:
            raise SystemExit(f"nothing subscribes to {topic}")
        time.sleep(0.005)
    print(row, flush=True)
    for k in range(count):
        writer.write(message(k))
        time.sleep(every)
    # What was written is on its way.
    time.sleep(1.0)
    del writer, participant, domain


if __name__ == "__main__":
    main()
