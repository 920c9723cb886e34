"""Logs as NumPy, pyarrow, gzip and LeRobot write them, and logs that lack the torque or the motion of joints, beside NumPy's least squares."""

import gzip
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pinocchio as pin
import pyarrow as pa
import pyarrow.parquet as pq

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benches/peers"))
from arm import BODY, build, columns_of

ARMID = Path(os.environ["ARMID"]).resolve()
PERIOD, RATE, PERIODS, HARMONICS = 10.0, 100, 3, 5
ROWS = int(RATE * PERIOD)
# Fitted torque of armid beside that of NumPy, over its RMS.
EQUAL = 1e-8


def motion(rng, moving=range(6)):
    """One period of a Fourier series of some joints with its derivatives, N × 6 each; the others rest."""
    t = np.arange(ROWS) / RATE
    w = 2 * np.pi * np.arange(1, HARMONICS + 1)[:, None] / PERIOD
    a, b = rng.uniform(-0.4, 0.4, (2, 6, HARMONICS)) * np.isin(np.arange(6), list(moving))[:, None]
    sin, cos = np.sin(w * t), np.cos(w * t)
    rest = np.array([0.3, -0.4, 0.5, 0.2, -0.6, 0.1])
    return (rest[:, None] + a @ sin + b @ cos).T, (a @ (w * cos) - b @ (w * sin)).T, (-a @ (w**2 * sin) - b @ (w**2 * cos)).T


class LogFormats(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rng = np.random.default_rng(11)
        cls.model, cls.data, cls.change = build()
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        states = motion(cls.rng)
        cls.w = cls.rows(states)
        noise = cls.rng.standard_normal((PERIODS, ROWS, 6))
        cls.t = np.arange(PERIODS * ROWS) / RATE
        cls.q = np.tile(states[0], (PERIODS, 1))
        cls.tau = (cls.w @ np.tile(BODY, 6) + noise).reshape(-1, 6)
        cls.csv = cls.table("log.csv", cls.q, cls.tau)
        cls.plain = cls.identified(cls.csv)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def rows(cls, states):
        return np.array([pin.computeJointTorqueRegressor(cls.model, cls.data, *state) for state in zip(*states)])

    @classmethod
    def table(cls, name, q, tau):
        path = cls.folder / name
        headings = ["t", *(f"q{i + 1}" for i in range(6)), *(f"tau{i + 1}" for i in range(6))]
        lines = [",".join(map(repr, map(float, (k / RATE, *q[k], *tau[k])))) for k in range(len(q))]
        path.write_text("\n".join([",".join(headings), *lines]) + "\n", encoding="utf-8")
        return path

    @classmethod
    def run_armid(cls, *words, estimator="ols"):
        settings = ["--robot", "crs-a460", "--period", PERIOD, "--columns", "rigid", "--held-out", "none", "--reversal-fraction", 0,
                    "--samples", ROWS, "--estimator", estimator, "--json"]
        command = [ARMID, "identify", *words, *settings]
        return subprocess.run([str(word) for word in command], capture_output=True, text=True)

    @classmethod
    def answer(cls, *words, estimator="ols"):
        done = cls.run_armid(*words, estimator=estimator)
        if done.returncode not in (0, 1):
            raise AssertionError(done.stderr)
        return json.loads(done.stdout)

    @classmethod
    def identified(cls, *words):
        return {parameter["name"]: parameter["value"] for parameter in cls.answer(*words)["base"]}

    @classmethod
    def said(cls, *words):
        done = cls.run_armid(*words)
        if done.returncode != 2:
            raise AssertionError(done.stdout)
        return " ".join(done.stderr.split())

    def fits(self, found, w, y):
        """The torque of these parameters on some equations is that of NumPy's least squares, and there are as many as their rank."""
        names = list(found)
        own = (w @ columns_of(self.change, names)) @ np.array(list(found.values()))
        expected, _, rank, _ = np.linalg.lstsq(w / np.linalg.norm(w, axis=0).clip(1e-12), y, rcond=1e-9)
        self.assertEqual(rank, len(names))
        off = own - w / np.linalg.norm(w, axis=0).clip(1e-12) @ expected
        self.assertLess(np.sqrt(np.mean(off**2) / np.mean(y**2)), EQUAL)

    def test_arrays_of_numpy_are_the_table_of_the_same_numbers(self):
        for name, save in ("stored.npz", np.savez), ("deflated.npz", np.savez_compressed):
            save(self.folder / name, t=self.t, q=self.q, tau=np.asfortranarray(self.tau), gear=np.ones(3), note=np.array("x"))
            self.assertEqual(self.identified(self.folder / name), self.plain)
        other = self.folder / "other.npz"
        np.savez(other, stamp_ms=np.arange(len(self.t), dtype=np.int64) * 10, pos=np.degrees(self.q), force=self.tau[:, ::-1])
        found = self.identified(other, "--map", "t=stamp_ms, q=pos deg, tau=force_[5-0]")
        for name, value in self.plain.items():
            self.assertAlmostEqual(found[name], value, delta=1e-9 * max(1, abs(value)))
        array = self.folder / "array.npy"
        np.save(array, np.hstack([self.q, self.tau]))
        self.assertEqual(self.identified(array, "--rate", RATE, "--map", "q=array_[0-5], tau=#[7-12]"), self.plain)
        # Single precision is that of the array.
        single = self.folder / "single.npz"
        np.savez(single, t=self.t, q=self.q.astype(np.float32), tau=self.tau.astype(">f4"))
        rounded = self.table("rounded.csv", self.q.astype(np.float32), self.tau.astype(np.float32))
        self.assertEqual(self.identified(single), self.identified(rounded))

    def test_what_arrays_lack_is_said(self):
        np.savez(self.folder / "short.npz", t=self.t, q=self.q, tau=self.tau[:-1])
        self.assertIn("tau has 2999 rows and q has 3000", self.said(self.folder / "short.npz"))
        np.savez(self.folder / "turned.npz", t=self.t, q=self.q.T, tau=self.tau.T)
        self.assertIn("q holds an array of 6 × 3000", self.said(self.folder / "turned.npz", "--map", "t=t, q=q, tau=tau"))
        np.savez(self.folder / "objects.npz", t=self.t, q=self.q.astype(object), tau=self.tau)
        self.assertIn("values of the type |O", self.said(self.folder / "objects.npz", "--map", "t=t, q=q, tau=tau"))

    def test_a_table_in_gzip_is_the_table(self):
        packed = self.folder / "log.csv.gz"
        packed.write_bytes(gzip.compress(self.csv.read_bytes()))
        self.assertEqual(self.identified(packed), self.plain)

    def test_parquet_of_any_compression_is_the_table_of_the_same_numbers(self):
        stamps = pa.array(1_700_000_000_000_000_000 + np.arange(len(self.t)) * 10_000_000, pa.timestamp("ns"))
        lists = {"pos": pa.array(list(self.q)), "torque": pa.FixedSizeListArray.from_arrays(self.tau.reshape(-1), 6)}
        columns = {"stamp": stamps, "mode": pa.array(["run"] * len(self.t)), **lists}
        for compression in "none", "snappy", "gzip", "zstd":
            path = self.folder / f"{compression}.parquet"
            pq.write_table(pa.table(columns), path, compression=compression, row_group_size=700)
            self.assertEqual(self.identified(path, "--map", "t=stamp, q=pos, tau=torque"), self.plain)
        plain = {"t": self.t, **{f"q{i + 1}": self.q[:, i] for i in range(6)}, **{f"tau{i + 1}": self.tau[:, i] for i in range(6)}}
        path = self.folder / "plain.parquet"
        pq.write_table(pa.table(plain), path)
        self.assertEqual(self.identified(path), self.plain)
        pq.write_table(pa.table(plain), path, compression="brotli")
        self.assertIn("plain, snappy, gzip and zstd", self.said(path))
        # A value that is missing is a row that is left out.
        holes = {name: pa.array(values, mask=np.arange(len(values)) == 1234) for name, values in plain.items()}
        pq.write_table(pa.table(holes), path)
        self.assertEqual(self.answer(path)["logs"][0]["timing"]["incomplete_rows"], 1)

    def test_a_data_set_of_lerobot_is_read_by_episodes_and_says_what_it_lacks(self):
        folder = self.folder / "data_set"
        (folder / "meta").mkdir(parents=True)
        names = {name: {"dtype": "float32", "shape": [6], "names": [f"joint{i}.pos" for i in range(6)]}
                 for name in ("observation.state", "action")}
        info = {"codebase_version": "v3.0", "fps": RATE, "features": {**names, "frame_index": {"dtype": "int64", "shape": [1], "names": None}}}
        (folder / "meta/info.json").write_text(json.dumps(info))

        def frames(tau):
            for file, episodes in enumerate(([0, 1], [2])):
                chunk = folder / "data/chunk-000"
                chunk.mkdir(parents=True, exist_ok=True)
                part = slice(min(episodes) * ROWS, (max(episodes) + 1) * ROWS)
                index = np.tile(np.arange(ROWS), len(episodes))
                columns = {"observation.state": pa.array(list(self.q[part].astype(np.float32))), "action": pa.array(list(self.q[part])),
                           "timestamp": (index / RATE).astype(np.float32), "frame_index": index, "episode_index": np.repeat(episodes, ROWS)}
                if tau:
                    columns["observation.effort"] = pa.array(list(self.tau[part]))
                pq.write_table(pa.table(columns), chunk / f"file-{file:03}.parquet")

        frames(tau=False)
        for map in [], ["--map", "q=observation.state, tau=observation.effort"]:
            said = self.said(folder, *map)
            self.assertIn("observation.state (6 columns)", said)
            self.assertIn("without torque and units", said)
        frames(tau=True)
        answer = self.answer(folder, "--map", "q=observation.state, tau=observation.effort")
        log = answer["logs"][0]
        self.assertEqual((log["rate_hz"], log["timing"]["resets"], log["periods"]), (RATE, 2, 3))
        self.assertIn("observation.state_0 to observation.state_5 are joint0.pos, joint1.pos", " ".join(log["remarks"]))
        rounded = self.identified(self.table("state.csv", self.q.astype(np.float32), self.tau))
        found = {parameter["name"]: parameter["value"] for parameter in answer["base"]}
        for name, value in rounded.items():
            self.assertAlmostEqual(found[name], value, delta=1e-6 * max(1, abs(value)))

    def test_torque_that_is_left_out_gives_no_equations(self):
        mean = self.tau.reshape(PERIODS, ROWS, 6).mean(axis=0)
        for left_out in [2], [1, 4], [0, 1, 2, 3]:
            columns = "/".join("-" if i in left_out else f"tau{i + 1}" for i in range(6))
            answer = self.answer(self.csv, "--map", f"t=t, q=q[1-6], tau={columns}")
            found = {parameter["name"]: parameter["value"] for parameter in answer["base"]}
            rest = [i for i in range(6) if i not in left_out]
            self.fits(found, self.w[:, rest].reshape(-1, 60), mean[:, rest].reshape(-1))
            self.assertEqual([answer["logs"][0]["equations"][i] for i in left_out], [0] * len(left_out))
            # Weights are the scatter of what was measured.
            scatter = (self.tau.reshape(PERIODS, ROWS, 6) - mean)[..., rest].reshape(-1, len(rest))
            root = np.linalg.inv(np.linalg.cholesky(scatter.T @ scatter))
            weighted = self.answer(self.csv, "--map", f"t=t, q=q[1-6], tau={columns}", estimator="wls")
            self.assertNotEqual(weighted["interval_basis"], "residual")
            weighted = {parameter["name"]: parameter["value"] for parameter in weighted["base"]}
            self.fits(weighted, (root @ self.w[:, rest]).reshape(-1, 60), (mean[:, rest] @ root.T).reshape(-1))
            self.assertIn(f"joint {left_out[0] + 1}: its effort is left out", " ".join(answer["logs"][0]["remarks"]))
        self.assertLess(len(found), len(self.plain))

    def test_logs_of_one_joint_each_are_one_fit(self):
        logs, w, y = [], [], []
        for i in range(6):
            states = motion(self.rng, [i])
            rows = self.rows(states)
            tau = rows @ np.tile(BODY, 6)
            # Encoders of joints that rest have noise; friction holds them, so that their torque is anything.
            q = states[0] + 1e-9 * self.rng.standard_normal(states[0].shape)
            q[:, i] = states[0][:, i]
            measured = np.where(np.arange(6) == i, tau, tau + self.rng.standard_normal(6))
            logs.append(self.table(f"joint{i}.csv", np.tile(q, (PERIODS, 1)), np.tile(measured, (PERIODS, 1))))
            w.append(rows[:, i])
            y.append(tau[:, i])
        found = self.identified(*logs)
        names = list(found)
        w, y = np.vstack(w), np.hstack(y)
        own = (w @ columns_of(self.change, names)) @ np.array(list(found.values()))
        self.assertLess(np.sqrt(np.mean((own - y) ** 2) / np.mean(y**2)), 1e-6)
        scaled = w / np.linalg.norm(w, axis=0).clip(1e-12)
        self.assertEqual(np.linalg.matrix_rank(scaled, tol=1e-7 * np.linalg.norm(scaled, 2)), len(names))


if __name__ == "__main__":
    unittest.main()
