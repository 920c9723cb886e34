"""`armid controller` under the eyes and the hands of a DDS that shares no code with it."""

import csv
import json
import os
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from robot_peer import RATE_HZ
from ros2_types import (
    LOOPBACK,
    QOS,
    Duration_,
    Header_,
    JointState_,
    JointTrajectory_,
    JointTrajectoryPoint_,
    Time_,
)

ARMID = Path(os.environ["ARMID"]).resolve()
NAMES = ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch", "tool_roll"]
# There and back; joints are named in another order than the robot file has them.
TARGET = np.array([0.3, -0.2, 0.4, -0.5, 0.2, 0.6])
LEG_S = 1.0


class Controller(unittest.TestCase):
    tests = 0

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.log = Path(scratch.name) / "log.csv"
        # A process may open a domain once.
        self.number = 20 + (2 * os.getpid() + Controller.tests) % 40
        Controller.tests += 1
        self.domain = Domain(self.number, LOOPBACK)
        self.participant = DomainParticipant(self.number)
        self.states = DataReader(self.participant, self.topic("rt/joint_states", JointState_), qos=QOS)
        name = "rt/joint_trajectory_controller/joint_trajectory"
        self.trajectories = DataWriter(self.participant, self.topic(name, JointTrajectory_), qos=QOS)
        self.received = []

    def topic(self, name, kind):
        return Topic(self.participant, name, kind, qos=QOS)

    def start(self, *arguments):
        command = [ARMID, "controller", "crs-a460", "--domain", str(self.number), "--rate", str(RATE_HZ)]
        command += ["--log", self.log, "--json", *arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.addCleanup(self.process.kill)
        self.until(lambda: len(self.received) > 50, 30, "joint states")

    def until(self, there, patience_s, what):
        began = time.monotonic()
        while not there():
            self.received += [s for s in self.states.take(1000) if isinstance(s, JointState_)]
            self.assertLess(time.monotonic() - began, patience_s, what)
            time.sleep(0.01)

    def positions(self):
        order = [self.received[-1].name.index(name) for name in NAMES]
        return np.array(self.received[-1].position)[order]

    def move(self):
        """Sends the motion, to begin at once."""
        rest = [0.0] * 6
        points = [
            JointTrajectoryPoint_((q[::-1]).tolist(), rest, rest, [], Duration_(int(k * LEG_S), 0))
            for k, q in enumerate([0 * TARGET, TARGET, 0 * TARGET])
        ]
        self.trajectories.write(JointTrajectory_(Header_(Time_(0, 0), ""), NAMES[::-1], points))

    def rows(self):
        with self.log.open(encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_a_motion_is_followed_and_every_state_arrives(self):
        self.start()
        self.move()
        self.until(lambda: np.abs(self.positions() - TARGET).max() < 0.02, 20, "the far end")
        self.until(lambda: np.abs(self.positions()).max() < 0.02, 20, "the way back")
        self.process.send_signal(signal.SIGINT)
        out, _ = self.process.communicate(timeout=20)
        done = json.loads(out)
        self.assertEqual((self.process.returncode, done["robot"]), (0, "crs-a460"))
        self.assertTrue(done["state"].startswith("enabled"), done)
        stamps = [s.header.stamp.sec * 10**9 + s.header.stamp.nanosec for s in self.received]
        self.assertEqual(set(np.diff(stamps)), {10**9 // RATE_HZ})
        # The log has every servo step; what was commanded is the motion, within the limits of speed.
        rows = self.rows()
        self.assertEqual(len(rows), done["steps"])
        command = np.array([[float(row[f"command{j}"]) for j in range(1, 7)] for row in rows])
        self.assertLess(np.abs(command.max(axis=0) - np.maximum(TARGET, 0)).max(), 1e-5)
        speed = np.abs(np.diff(command, axis=0)).max(axis=0) / 1e-3
        # Rest to rest in 1 s by a polynomial of degree five: 15/8 of the mean speed; the log has six decimals.
        self.assertLess(np.abs(speed - 15 / 8 * np.abs(TARGET) / LEG_S).max(), 2e-3)

    def test_after_an_emergency_stop_nothing_is_commanded_and_a_kill_leaves_the_log(self):
        self.start("--fault", "estop@motion+0.3")
        self.move()
        stopped = lambda: len(self.received) > 900 and np.ptp([s.position[0] for s in self.received[-100:]]) < 1e-4  # noqa: E731
        self.until(stopped, 30, "a standstill")
        self.process.kill()
        self.process.wait()
        rows = self.rows()
        events = [k for k, row in enumerate(rows) if "estop" in (row["event"] or "")]
        self.assertEqual(len(events), 1)
        began = next(k for k, row in enumerate(rows) if row["doing"] == "follow")
        self.assertAlmostEqual((events[0] - began) * 1e-3, 0.3, delta=0.003)
        # The last line may be cut; the ones before it are whole.
        for row in rows[events[0] : -1]:
            self.assertEqual({row[f"command{j}"] for j in range(1, 7)}, {""})
            self.assertEqual({float(row[f"current{j}"]) for j in range(1, 7)}, {0.0})


if __name__ == "__main__":
    unittest.main()
