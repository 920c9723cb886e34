"""The action `follow_joint_trajectory` as `ros2_controllers` serve it, by Cyclone DDS, on the arm of `robot_peer.py`.

Quality of service is rcl's: services keep 10 and forget, the list of goals is transient local; `history` says how many lists
one who joins later receives (rcl: 1). A goal is taken at once and takes the place of the one before, which is cancelled then.
A cancel holds the arm where it is. No line of armid is in it.
"""

import time

from cyclonedds.core import Policy, Qos
from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import array, int8, int32, sequence, uint8
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from foreign import FollowJointTrajectory_Goal_, GoalInfo_, UUID_
from robot_peer import Motion
from ros2_types import Duration_, Header_, JointTrajectory_, JointTrajectoryPoint_, Time_

NAME = "joint_trajectory_controller/follow_joint_trajectory/_action"
EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = 2, 3, 4, 5, 6
NONE, REJECTED, UNKNOWN, TERMINATED = 0, 1, 2, 3
INVALID_GOAL, PATH_TOLERANCE_VIOLATED = -1, -4


def message(name, **fields):
    """A type of messages by its full name, `package/msg/Name`."""
    package, kind, name = name.split("/")
    return final(make_idl_struct(f"{name}_", f"{package}.{kind}.dds_.{name}_", fields))


# What `rmw_cyclonedds` puts in front of a request and of its answer: who asked, and the number of the question.
ASKED = {"asked": array[uint8, 16]}
ACTION = "control_msgs/action/FollowJointTrajectory"
GoalStatus_ = message("action_msgs/msg/GoalStatus", goal_info=GoalInfo_, status=int8)
GoalStatusArray_ = message("action_msgs/msg/GoalStatusArray", status_list=sequence[GoalStatus_])
Result_ = message(f"{ACTION}_Result", error_code=int32, error_string=str)
SERVICES = {
    "send_goal": (
        message(f"{ACTION}_SendGoal_Request", **ASKED, goal_id=UUID_, goal=FollowJointTrajectory_Goal_),
        message(f"{ACTION}_SendGoal_Response", **ASKED, accepted=bool, stamp=Time_),
    ),
    "cancel_goal": (
        message("action_msgs/srv/CancelGoal_Request", **ASKED, goal_info=GoalInfo_),
        message("action_msgs/srv/CancelGoal_Response", **ASKED, return_code=int8, goals_canceling=sequence[GoalInfo_]),
    ),
    "get_result": (
        message(f"{ACTION}_GetResult_Request", **ASKED, goal_id=UUID_),
        message(f"{ACTION}_GetResult_Response", **ASKED, status=int8, result=Result_),
    ),
}


def quality(durability, depth):
    """rcl's: reliable, so many samples, here in the plain encoding that ROS 2 uses."""
    several = {}
    if durability == Policy.Durability.TransientLocal:
        unlimited = -1
        several = [Policy.DurabilityService(0, Policy.History.KeepLast(depth), unlimited, unlimited, unlimited)]
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        durability,
        Policy.History.KeepLast(depth),
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
        *several,
    )


class ActionServer:
    """Serves goals for `peer`, in its thread; refuses the first `refusals`."""

    def __init__(self, peer, history=1, refusals=0):
        self.peer, self.refusals = peer, refusals
        # Goals by their number: status, and code and words of the result once it is there.
        self.goals, self.active, self.wanted = {}, None, []
        # What has happened, for a test to look at.
        self.refused, self.taken, self.abort = 0, 0, False
        services = quality(Policy.Durability.Volatile, 10)
        topic = lambda name, kind, qos: Topic(peer.participant, name, kind, qos=qos)  # noqa: E731
        self.asked, self.answers = {}, {}
        for name, (request, answer) in SERVICES.items():
            self.asked[name] = DataReader(peer.participant, topic(f"rq/{NAME}/{name}Request", request, services), qos=services)
            self.answers[name] = DataWriter(peer.participant, topic(f"rr/{NAME}/{name}Reply", answer, services), qos=services)
        lists = quality(Policy.Durability.TransientLocal, history)
        self.lists = DataWriter(peer.participant, topic(f"rt/{NAME}/status", GoalStatusArray_, lists), qos=lists)
        peer.servers.append(self.serve)

    def requests(self, name):
        return [sample for sample in self.asked[name].take(50) if isinstance(sample, SERVICES[name][0])]

    def answer(self, name, request, *fields):
        self.answers[name].write(SERVICES[name][1](request.asked, *fields))

    def serve(self, stamp_ns):
        """One cycle of the controller."""
        for request in self.requests("send_goal"):
            self.consider(request, stamp_ns)
        for request in self.requests("cancel_goal"):
            self.cancel(request, stamp_ns)
        self.wanted += self.requests("get_result")
        motion = self.peer.motion
        if self.active and self.abort:
            self.abort = False
            self.hold(stamp_ns)
            self.end(ABORTED, PATH_TOLERANCE_VIOLATED, "a test aborts it")
        elif self.active and 1e-9 * (stamp_ns - motion.start_ns) > motion.t[-1]:
            self.end(SUCCEEDED, 0, "")
        for request in list(self.wanted):
            status, result = self.goals.get(bytes(request.goal_id.uuid), (0, Result_(0, "")))
            if result:
                self.wanted.remove(request)
                self.answer("get_result", request, status, result)

    def consider(self, request, stamp_ns):
        """Takes a goal, or refuses it: one of those to refuse, or one that is past."""
        trajectory = request.goal.trajectory
        motion = Motion(trajectory, self.peer.names) if trajectory.points else None
        now = 1e-9 * (stamp_ns - motion.start_ns) if motion else 0.0
        taken = self.refused >= self.refusals and motion is not None and now <= motion.t[-1]
        self.answer("send_goal", request, taken, self.stamp())
        if not taken:
            self.refused += 1
            return
        self.taken += 1
        if self.active:
            self.end(CANCELED, INVALID_GOAL, "Current goal cancelled due to new incoming action.")
        self.active = bytes(request.goal_id.uuid)
        self.peer.motion = motion.entered(now, self.peer.now(stamp_ns))
        self.publish(self.active, EXECUTING)

    def cancel(self, request, stamp_ns):
        """Cancels one goal, or all of them where no number is given."""
        number = bytes(request.goal_info.goal_id.uuid)
        every = number == bytes(16)
        if not self.active or not (every or number == self.active):
            code = NONE if every else TERMINATED if number in self.goals else UNKNOWN
            self.answer("cancel_goal", request, code, [])
            return
        self.publish(self.active, CANCELING)
        self.answer("cancel_goal", request, NONE, [self.info(self.active)])
        self.hold(stamp_ns)
        self.end(CANCELED, 0, "")

    def hold(self, stamp_ns):
        """The arm stays where it is."""
        q, zero = self.peer.now(stamp_ns)[0].tolist(), [0.0] * len(self.peer.names)
        point = JointTrajectoryPoint_(q, zero, zero, [], Duration_(0, 0))
        self.peer.motion = Motion(JointTrajectory_(Header_(Time_(0, 0), ""), self.peer.names, [point]), self.peer.names)

    def end(self, status, code, words):
        ended, self.active = self.active, None
        self.publish(ended, status, Result_(code, words))

    def publish(self, number, status, result=None):
        """The list of goals, with a new status of one; those that have ended stay in it, as rcl keeps them for a while."""
        self.goals[number] = (status, result)
        self.lists.write(GoalStatusArray_([GoalStatus_(self.info(n), s) for n, (s, _) in self.goals.items()]))

    def info(self, number):
        return GoalInfo_(UUID_(list(number)), self.stamp())

    @staticmethod
    def stamp():
        now = time.time_ns()
        return Time_(now // 10**9, now % 10**9)
