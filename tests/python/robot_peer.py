"""A robot controller written by others: Cyclone DDS for the wire, Pinocchio for the torques.

It takes trajectories on the topic `joint_trajectory`, each in place of the one before, as current `ros2_controllers` do: one
that is past or has no points is refused, one whose first points are past is joined in its midst, and where its first point
is still to come it is gone to from where the arm is. It follows them exactly and reports joint states at 500 Hz, positions
in whole encoder counts and motor currents with the noise of the robot file. Its joints are reported in another order than
the robot file has them. No line of armid is in it.
"""

import math
import sys
import threading
import time
import tomllib
from pathlib import Path

import numpy as np
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from ros2_types import LOOPBACK, QOS, Header_, JointState_, JointTrajectory_, Time_

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests" / "pinocchio"))
import generate  # noqa: E402  the arms in Pinocchio, as the stored references were made

RATE_HZ = 500
# A controller that is later than this skips the cycles that it has missed, s.
SKIPPED_S = 0.02


class Motion:
    """Polynomials of degree five through the points of a trajectory, on a grid of its own."""

    def __init__(self, message, names):
        order = [message.joint_names.index(name) for name in names]
        take = lambda field: np.array([getattr(point, field) for point in message.points])[:, order]  # noqa: E731
        self.start_ns = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        self.t = np.array([p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in message.points])
        self.q, self.v, self.a = take("positions"), take("velocities"), take("accelerations")

    def entered(self, t, state):
        """The same with a way to its first point, where that is still to come."""
        if t < self.t[0]:
            put = lambda first, rest: np.vstack([first, rest])  # noqa: E731
            self.t = np.concatenate([[t], self.t])
            self.q, self.v, self.a = put(state[0], self.q), put(state[1], self.v), put(state[2], self.a)
        return self

    def at(self, t):
        """Position, velocity and acceleration: the polynomial that meets all three at both ends, by its equations."""
        if t <= self.t[0] or t >= self.t[-1]:
            end = 0 if t <= self.t[0] else -1
            zero = np.zeros(self.q.shape[1])
            return self.q[end], zero, zero
        k = int(np.searchsorted(self.t, t, side="right")) - 1
        h = self.t[k + 1] - self.t[k]
        ends = np.vstack([self.q[k], self.v[k], self.a[k], self.q[k + 1], self.v[k + 1], self.a[k + 1]])
        c = np.linalg.solve(equations(h), ends)
        s = t - self.t[k]
        return tuple(row @ c for row in (powers(s, 0), powers(s, 1), powers(s, 2)))


def powers(s, derivative):
    """The derivatives of 1, s, …, s⁵."""
    row = np.zeros(6)
    for n in range(derivative, 6):
        row[n] = math.perm(n, derivative) * s ** (n - derivative)
    return row


def equations(h):
    return np.vstack([powers(s, d) for s in (0.0, h) for d in (0, 1, 2)])


class Peer:
    """The robot controller, until it is asked to stop."""

    def __init__(self, domain, pose, seed=1):
        robot = tomllib.loads((ROOT / "models/crs-a460/robot.toml").read_text(encoding="utf-8"))
        truth = tomllib.loads((ROOT / "models/crs-a460/truth.toml").read_text(encoding="utf-8"))
        self.arm = generate.Arm(generate.bundled("crs-a460", "truth.toml"))
        self.names = [joint["name"] for joint in robot["joint"]]
        drives = [joint["drive"] for joint in robot["joint"]]
        column = lambda rows, key: np.array([row[key] for row in rows], dtype=float)  # noqa: E731
        self.per_ampere = column(drives, "gear") * column(drives, "torque_constant_nm_a")
        self.step = 2 * np.pi / column(drives, "counts_per_revolution")
        self.noise = column(drives, "current_noise_a")
        self.scale = column(drives, "coulomb_velocity_rad_s")
        friction = [column(truth["drive"], key) for key in ("viscous_nm_s_rad", "coulomb_nm", "offset_nm")]
        self.viscous, self.coulomb, self.offset = friction
        self.random = np.random.default_rng(seed)
        self.pose = np.array(pose, dtype=float)
        self.motion = None
        self.received = []
        self.sent = 0
        # The numbers of the cycles that were left out.
        self.skipped = []
        # Others that act in every cycle of the controller; when the arm was last seen to move; the latest cycle.
        self.servers, self.moved_at, self.late_s = [], None, 0.0
        self.open = True
        self.domain = Domain(domain, LOOPBACK)
        self.participant = DomainParticipant(domain)
        topic = lambda name, kind: Topic(self.participant, name, kind, qos=QOS)  # noqa: E731
        self.states = DataWriter(self.participant, topic("rt/joint_states", JointState_), qos=QOS)
        name = "rt/joint_trajectory_controller/joint_trajectory"
        self.trajectories = DataReader(self.participant, topic(name, JointTrajectory_), qos=QOS)
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def close(self):
        self.open = False
        self.thread.join()

    def now(self, stamp_ns):
        if self.motion is None:
            zero = np.zeros(6)
            return self.pose, zero, zero
        return self.motion.at(1e-9 * (stamp_ns - self.motion.start_ns))

    def run(self):
        # A clock of its own, far from that of this machine.
        epoch_ns, began, k = 200_000_000 * 10**9, time.monotonic(), 0
        mirror = slice(None, None, -1)
        while self.open:
            stamp_ns = epoch_ns + k * (10**9 // RATE_HZ)
            if k % 5 == 0:
                self.listen(stamp_ns)
            q, v, a = self.now(stamp_ns)
            if np.abs(q - self.pose).max() > 1e-12:
                self.pose, self.moved_at = q, time.monotonic()
            tau = self.arm.torque(q, v, a) + self.viscous * v + self.coulomb * np.tanh(v / self.scale) + self.offset
            current = tau / self.per_ampere + self.noise * self.random.standard_normal(6)
            seen = np.round(q / self.step) * self.step
            state = JointState_(
                Header_(Time_(stamp_ns // 10**9, stamp_ns % 10**9), "base"),
                self.names[mirror],
                seen[mirror].tolist(),
                v[mirror].tolist(),
                current[mirror].tolist(),
            )
            self.states.write(state)
            self.sent += 1
            k += 1
            ahead = began + k / RATE_HZ - time.monotonic()
            self.late_s = max(self.late_s, -ahead)
            if ahead > 0:
                time.sleep(ahead)
            elif -ahead > SKIPPED_S:
                # Its clock goes on: a controller that runs after its cycles would have a fast one.
                next_k = k + int(-ahead * RATE_HZ)
                self.skipped += range(k, next_k)
                k = next_k

    def listen(self, stamp_ns):
        for serve in self.servers:
            serve(stamp_ns)
        for message in self.trajectories.take(4):
            if not isinstance(message, JointTrajectory_):
                continue
            if not message.points:
                continue
            motion = Motion(message, self.names)
            now = 1e-9 * (stamp_ns - motion.start_ns)
            if now > motion.t[-1]:
                continue
            self.received.append(len(message.points))
            self.motion = motion.entered(now, self.now(stamp_ns)) if self.motion else motion.entered(max(now, 0.0), self.now(stamp_ns))
