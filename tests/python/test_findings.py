"""Findings on logs that Pinocchio makes: motions of makers' arms that begin and end in mid-motion, and the mistakes that logs are made with."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pinocchio as pin

from makers_arms import ROBOTS, armid

RATE, SECONDS = 250.0, 16.0
ARMS = [
    "ur_description/urdf/ur5_robot.urdf",
    "ur_description/urdf/ur10_robot.urdf",
    "xarm_description/urdf/xarm7.urdf",
    "ur_description/urdf/ur3_robot.urdf",
    "talos_data/robots/talos_left_arm.urdf",
]


class Log:
    """A motion of an arm, each joint of so many tones of its own, with friction that sets in softly, rotors and 2 % of noise."""

    def __init__(self, path, tones, seed):
        model = pin.buildModelFromUrdf(str(path))
        self.path, self.n = path, model.nv
        rng, data = np.random.default_rng(seed), model.createData()
        low, high = np.maximum(model.lowerPositionLimit, -2.5), np.minimum(model.upperPositionLimit, 2.5)
        self.t = np.arange(int(RATE * SECONDS)) / RATE
        q, v, a = np.zeros((3, len(self.t), self.n))
        for i in range(self.n):
            q[:, i] = 0.5 * (low[i] + high[i])
            for k in range(tones):
                w = 2 * np.pi * (0.11 * (k + 1) + 0.03 * i + 0.02 * rng.random())
                size = min(0.2 * (high[i] - low[i]), 0.4 * model.velocityLimit[i] / w) / tones
                phase = w * self.t + rng.uniform(0, 2 * np.pi)
                q[:, i] += size * np.sin(phase)
                v[:, i] += size * w * np.cos(phase)
                a[:, i] -= size * w * w * np.sin(phase)
        torque = np.array([pin.rnea(model, data, *state) for state in zip(q, v, a)])
        size = np.maximum(np.sqrt(np.mean(torque**2, axis=0)), 0.5)
        torque += 0.02 * a + 0.1 * size * (np.tanh(v / 0.02) + v / np.abs(v).max(axis=0))
        count = 2 * np.pi / 65536
        self.q, self.torque = np.round(q / count) * count, torque + 0.02 * size * rng.standard_normal(torque.shape)

    def identify(self, folder, torque, *more):
        log, n = Path(folder) / "log.csv", range(1, self.n + 1)
        header = ",".join(["t", *(f"q{i}" for i in n), *(f"tau{i}" for i in n)])
        rows = np.column_stack([self.t, self.q, torque])
        np.savetxt(log, rows, delimiter=",", header=header, comments="", fmt="%.10g")
        out = Path(folder) / "E.json"
        done = armid("identify", log, "--robot", self.path, "-o", out, "--json", *more)
        return done, json.loads(out.read_text(encoding="utf-8")) if out.is_file() else None


class Findings(unittest.TestCase):
    def test_no_spring_is_named_where_there_is_none(self):
        for file in ARMS:
            for tones in (1, 4):
                with self.subTest(file, tones=tones), tempfile.TemporaryDirectory() as folder:
                    log = Log(ROBOTS / file, tones, 3)
                    done, _ = log.identify(folder, log.torque)
                    self.assertIn(done.returncode, (0, 1), done.stderr[:800])
                    made = armid("report", Path(folder) / "E.json", "-o", Path(folder) / "report")
                    self.assertEqual(made.returncode, 0, made.stderr[:800])
                    page = (Path(folder) / "report/report.html").read_text(encoding="utf-8")
                    self.assertNotIn("as a spring", page)

    def test_sign_and_unit_of_all_torques_are_named_and_a_sound_log_is_left_alone(self):
        for file in ARMS:
            log = Log(ROBOTS / file, 4, 5)
            gears = np.random.default_rng(7).uniform(8, 80, log.n)
            for torque, mistakes in [
                (log.torque, []),
                (-log.torque, ["efforts-reversed"]),
                (log.torque / gears, ["efforts-small"]),
            ]:
                with self.subTest(file, mistakes=mistakes), tempfile.TemporaryDirectory() as folder:
                    done, estimate = log.identify(folder, torque)
                    self.assertEqual([found["mistake"] for found in estimate["suspicions"]], mistakes)
                    self.assertEqual(done.returncode, 1 if mistakes else 0, done.stderr[:800])


if __name__ == "__main__":
    unittest.main()
