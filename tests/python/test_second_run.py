"""`armid run --arm ros2` again and again against one living controller that is not armid's (`action_server.py`)."""

import json
import os
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from action_server import ActionServer
from robot_peer import Peer

ARMID = Path(os.environ["ARMID"]).resolve()
# Joint, a and b in rad/s, q0 in rad, at the designed speed: the arm can do it.
JOINTS = [
    ("waist", [0.4, -0.2], [0.15, 0.25], 0.1),
    ("shoulder", [0.25, 0.15], [-0.15, 0.2], -0.2),
    ("elbow", [-0.3, 0.25], [0.25, -0.15], 0.3),
    ("wrist_roll", [0.5, 0.3], [-0.35, 0.25], -0.3),
    ("wrist_pitch", [-0.45, 0.4], [0.3, 0.35], 0.5),
    ("tool_roll", [0.4, -0.45], [0.45, -0.3], 0.2),
]
EXPERIMENT = """robot = "crs-a460"
trajectory = "T.toml"
rate_hz = 500
settle_s = 0.1
ramp_s = 0.3
discarded_periods = 0
periods = 1

# A machine that builds and tests at the same time stands still now and then.
[guard]
stale_ms = 1000

[ros2]
service_mapping = "cyclone"
robot_state = ""
robot_request = ""
patience_s = 20.0
lead_s = 0.3
"""
# A controller that stood still for longer than this may well be called silent (the guard's bound for an answer is 0.5 s).
STOOD_STILL_S = 0.2


class SecondRun(unittest.TestCase):
    tests = 0

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        # A process may open a domain once.
        self.domain = 100 + (4 * os.getpid() + SecondRun.tests) % 40
        SecondRun.tests += 1
        self.runs = 0

    def serve(self, **more):
        self.peer = Peer(self.domain, [0.0] * 6)
        self.addCleanup(self.peer.close)
        self.server = ActionServer(self.peer, **more)

    def experiment(self, period_s):
        joints = [f'[[joint]]\nname = "{n}"\na = {a}\nb = {b}\nq0 = {q}\n' for n, a, b, q in JOINTS]
        (self.folder / "T.toml").write_text(f"period_s = {period_s}\nharmonics = 2\n" + "".join(joints), encoding="utf-8")
        path = self.folder / "experiment.toml"
        path.write_text(EXPERIMENT.replace("[ros2]", f"[ros2]\ndomain = {self.domain}"), encoding="utf-8")
        return path

    def start(self, experiment, *speed):
        self.runs += 1
        recording = self.folder / f"R{self.runs}.mcap"
        command = [ARMID, "run", experiment, "--arm", "ros2", "--yes-the-estop-works", "--json", "-o", recording, *speed]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def end(self, process):
        """How a run ended: its exit status, and what it says."""
        out, errors = process.communicate(timeout=120)
        return process.returncode, json.loads(out) if out else {}, errors

    def judged(self, step):
        """Performs a step; once more, twice at most, where it fails while the controller itself stood still."""
        for _ in range(2):
            self.peer.late_s = 0.0
            try:
                return step()
            except AssertionError:
                if self.peer.late_s < STOOD_STILL_S:
                    raise
        return step()

    def completes(self, experiment, *speed):
        def step():
            status, done, errors = self.end(self.start(experiment, *speed))
            self.assertEqual((status, done.get("ending")), (0, "completed"), f"{done.get('detail')}{errors}")
            return done

        return self.judged(step)

    def moving(self, process):
        """Waits until the arm has moved for a while."""
        taken, began = self.server.taken, time.monotonic()
        while self.server.taken < taken + 12:
            self.assertIsNone(process.poll(), process.stderr.read() if process.poll() is not None else "")
            self.assertLess(time.monotonic() - began, 60)
            time.sleep(0.01)

    def stays(self):
        """Nothing moves the arm any more."""
        moved = self.peer.moved_at
        time.sleep(0.7)
        self.assertEqual(self.peer.moved_at, moved)

    def trips(self, run):
        process = self.start(*run)
        self.moving(process)
        self.server.abort = True
        status, done, errors = self.end(process)
        self.assertEqual((status, done["trip"]["name"], done["rest"]["outcome"]), (1, "robot-stopped", "confirmed"), errors)
        self.stays()

    def is_interrupted(self, run):
        process = self.start(*run)
        self.moving(process)
        process.send_signal(signal.SIGINT)
        status, done, errors = self.end(process)
        self.assertEqual((status, done["rest"]["outcome"]), (130, "confirmed"), errors)
        self.stays()

    def runs_after_each_ending(self, history):
        self.serve(history=history)
        # A tenth of the speed: 2 s a period.
        slow = (self.experiment(0.2), "--speed", "10%")
        self.completes(*slow)
        # After one that was completed: one that trips.
        self.judged(lambda: self.trips(slow))
        # After one that tripped: one that is interrupted.
        self.judged(lambda: self.is_interrupted(slow))
        # After one that was interrupted: one that is killed. Its last piece ends at rest within the horizon.
        process = self.start(*slow)
        self.moving(process)
        process.kill()
        process.communicate()
        time.sleep(1.0)
        self.stays()
        # After one that was killed.
        self.completes(*slow)

    def test_a_run_follows_any_other_where_the_newest_list_of_goals_is_kept(self):
        self.runs_after_each_ending(1)

    def test_a_run_follows_any_other_where_a_hundred_lists_of_goals_are_kept(self):
        self.runs_after_each_ending(100)

    def test_a_first_run_goes_through_its_three_speeds(self):
        self.serve()
        done = self.completes(self.experiment(1.0), "--first-run")
        self.assertEqual([step["speed"] for step in done["steps"]], [0.1, 0.5, 1.0])
        self.assertEqual([step["ending"] for step in done["steps"]], ["completed"] * 3)

    def test_a_refused_goal_is_a_trip_and_nothing_moves(self):
        self.serve()
        slow = (self.experiment(0.2), "--speed", "10%")

        def is_refused(refusals):
            self.server.refused, self.server.refusals = 0, refusals
            status, done, errors = self.end(self.start(*slow))
            self.assertEqual((status, done["trip"]["name"], done["rest"]["outcome"]), (1, "robot-stopped", "confirmed"), errors)
            self.assertIn("horizon_s = 0", done["trip"]["reason"])
            self.assertIsNone(self.peer.moved_at, f"{refusals} refusals")

        for refusals in (1, 2, 10):
            self.judged(lambda refusals=refusals: is_refused(refusals))


if __name__ == "__main__":
    unittest.main()
