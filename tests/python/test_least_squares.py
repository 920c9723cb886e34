"""Ordinary and weighted least squares of armid beside NumPy's, on a recording that Pinocchio's regressor made."""

import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pinocchio as pin

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benches/peers"))
from arm import BODY, build, columns_of

ARMID = Path(os.environ["ARMID"]).resolve()
PERIOD, PERIODS, RATE, HARMONICS, BLOCK = 10.0, 3, 100, 5, 2
# Standard deviations of the noise of each joint's torque, N·m, and the correlation of joints beside each other.
NOISE, CORRELATION = np.array([1.0, 2.0, 1.0, 0.3, 0.2, 0.1]), 0.5
# Largest difference of a parameter, as torque on the recorded motion over the RMS of all torque.
EQUAL = 1e-10


def motion(rng):
    """A finite Fourier series of one period, with its exact derivatives: N × 6 each."""
    t = np.arange(int(RATE * PERIOD)) / RATE
    w = 2 * np.pi * np.arange(1, HARMONICS + 1)[:, None] / PERIOD
    a, b = rng.uniform(-0.4, 0.4, (2, 6, HARMONICS))
    sin, cos = np.sin(w * t), np.cos(w * t)
    return (a @ sin + b @ cos).T, (a @ (w * cos) - b @ (w * sin)).T, (-a @ (w**2 * sin) - b @ (w**2 * cos)).T


def block_means(x):
    return x.reshape(-1, BLOCK, *x.shape[1:]).mean(axis=1)


class LeastSquares(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rng = np.random.default_rng(7)
        model, data, cls.change = build()
        states = motion(rng)
        cls.regressor = np.array([pin.computeJointTorqueRegressor(model, data, *state) for state in zip(*states)])
        between = CORRELATION ** np.abs(np.subtract.outer(np.arange(6), np.arange(6)))
        root = np.linalg.cholesky(between) * NOISE[:, None]
        exact = cls.regressor @ np.tile(BODY, 6)
        cls.torque = exact + rng.standard_normal((PERIODS, *exact.shape)) @ root.T
        cls.scratch = tempfile.TemporaryDirectory()
        cls.log = Path(cls.scratch.name) / "log.csv"
        with cls.log.open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file)
            table.writerow(["t", *(f"q{i + 1}" for i in range(6)), *(f"tau{i + 1}" for i in range(6))])
            rows = zip(np.tile(states[0], (PERIODS, 1)), cls.torque.reshape(-1, 6))
            table.writerows([k / RATE, *map(float, q), *map(float, tau)] for k, (q, tau) in enumerate(rows))

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def identified(self, estimator):
        """Base parameters of armid by name: every equation kept, each the mean of two samples."""
        settings = ["--robot", "crs-a460", "--period", PERIOD, "--columns", "rigid", "--held-out", "none", "--reversal-fraction", 0,
                    "--samples", int(RATE * PERIOD) // BLOCK]
        command = [ARMID, "identify", self.log, *settings, "--estimator", estimator, "--json"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return {parameter["name"]: parameter["value"] for parameter in json.loads(done.stdout)["base"]}

    def close(self, found, whitened):
        """The solution with each sample's rows and torque multiplied by `whitened` is the one found."""
        w = block_means(self.regressor) @ columns_of(self.change, list(found))
        y = block_means(self.torque.mean(axis=0))
        b = w.shape[2]
        expected, _, rank, _ = np.linalg.lstsq((whitened @ w).reshape(-1, b), (y @ whitened.T).reshape(-1), rcond=None)
        self.assertEqual(rank, b)
        off = np.abs(np.array(list(found.values())) - expected) * np.sqrt(np.mean(w**2, axis=(0, 1))) / np.sqrt(np.mean(y**2))
        self.assertLess(off.max(), EQUAL)

    def test_ordinary_least_squares_is_that_of_numpy(self):
        self.close(self.identified("ols"), np.eye(6))

    def test_weighted_least_squares_is_that_of_numpy(self):
        scatter = self.torque - self.torque.mean(axis=0)
        # The covariance of a block's mean, from blocks that begin at every sample of a period, whose last is followed by its first.
        means = np.mean([np.roll(scatter, -k, axis=1) for k in range(BLOCK)], axis=0).reshape(-1, 6)
        root = np.linalg.inv(np.linalg.cholesky(means.T @ means / len(means)))
        found = self.identified("wls")
        self.close(found, root)
        # The weights count: without them the answer is another one.
        with self.assertRaises(AssertionError):
            self.close(found, np.eye(6))


if __name__ == "__main__":
    unittest.main()
