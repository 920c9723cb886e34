"""The model that `armid export` fits, against a semidefinite program: CVXPY and Clarabel on Pinocchio's regressor, 20 random arms for
each of URDF and MJCF. Then the error of both files on narrow motions of makers' arms, by Pinocchio and MuJoCo."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy import signal

from makers_arms import ROBOTS, armid
from narrow_motions import ARMS, Scored, simulate, write
from semidefinite import TEN, Program, guess_of, regressor

RUNS, JOINTS, RATE, TIME, CUTOFF = 20, 3, 100, 25.0, 10.0
# Draw of the narrow motions, and how near to the program's the error of a file is, as a factor.
SEED, NEAR = 1, 1.1
# Edges of the filter, in periods of the cut-off; part of its top speed below which a joint hardly moves.
EDGE, SLOW = 2.0, 0.02


def link(name, mass, com, moments):
    x, y, z = com
    return (f'<link name="{name}"><inertial><origin xyz="{x} {y} {z}"/><mass value="{mass}"/><inertia ixx="{moments[0]}" ixy="0" '
            f'ixz="0" iyy="{moments[1]}" iyz="0" izz="{moments[2]}"/></inertial></link>')


def urdf(rng):
    """A chain of revolute joints with random places and bodies."""
    parts = ['<robot name="random"><link name="base"/>']
    for i in range(JOINTS):
        mass, size = rng.uniform(1, 8), rng.uniform(0.05, 0.2, 3)
        moments = mass * np.array([size[1]**2 + size[2]**2, size[0]**2 + size[2]**2, size[0]**2 + size[1]**2])
        parts.append(link(f"l{i}", mass, rng.uniform(-0.1, 0.1, 3), moments))
        axis, roll = ["0 0 1", "0 1 0", "0 1 0"][i], rng.uniform(-1, 1, 3)
        parent, place = "base" if i == 0 else f"l{i - 1}", rng.uniform(-0.3, 0.3, 3)
        parts.append(f'<joint name="j{i}" type="revolute"><origin xyz="{" ".join(map(str, place))}" '
                     f'rpy="{" ".join(map(str, roll))}"/><parent link="{parent}"/><child link="l{i}"/><axis xyz="{axis}"/>'
                     '<limit lower="-3" upper="3" effort="500" velocity="9"/></joint>')
    return "".join(parts) + "</robot>"


def motion(rng, size):
    t = np.arange(int(RATE * TIME)) / RATE
    w = rng.uniform(0.5, 5, (JOINTS, 4))[:, :, None]
    phase, a = rng.uniform(0, 6, (2, JOINTS, 4, 1))
    a = size * a / 6
    return (t, *(x.sum(axis=1).T for x in (a * np.sin(w * t + phase), a * w * np.cos(w * t + phase), -a * w**2 * np.sin(w * t + phase))))


class NarrowMotions(unittest.TestCase):
    def test_files_predict_as_well_as_the_semidefinite_program(self):
        for name in ARMS:
            with self.subTest(arm=name), tempfile.TemporaryDirectory() as scratch:
                self.compare(*ARMS[name], Path(scratch))

    def compare(self, path, n, folder):
        robot, log, estimate = ROBOTS / path, folder / "log.csv", folder / "E.json"
        record = simulate(robot, n, SEED)
        write(log, *record)
        scored = Scored(robot, n, *record)
        done = armid("identify", log, "--robot", robot, "-o", estimate)
        self.assertIn(done.returncode, (0, 1), done.stderr[:800])
        self.assertLess(scored.error(scored.estimate(estimate)), scored.error(scored.least_squares()))
        for to, columns, predict in (("urdf", 12, scored.urdf), ("mjcf", 13, scored.mjcf)):
            file = folder / f"arm.{to}"
            done = armid("export", estimate, "--to", to, "-o", file)
            self.assertIn(done.returncode, (0, 1), done.stderr[:800])
            predicted, masses = predict(file)
            error, least = scored.error(predicted), scored.error(scored.program(columns))
            self.assertLess(error, NEAR * least, (to, error, least))
            # The last link carries a tool.
            self.assertTrue((masses[:-1] > 0.1).all() and (masses[:-1] < 10).all(), (to, masses))


class ModelFit(unittest.TestCase):
    def test_the_objective_is_that_of_the_semidefinite_program(self):
        for run in range(RUNS):
            with self.subTest(run=run), tempfile.TemporaryDirectory() as scratch:
                self.compare(np.random.default_rng(run), Path(scratch))

    def compare(self, rng, folder):
        robot, log, estimate = folder / "arm.urdf", folder / "log.csv", folder / "E.json"
        robot.write_text(urdf(rng), encoding="utf-8")
        model = pin.buildModelFromUrdf(str(robot))
        guess = guess_of(model)
        t, q, v, a = motion(rng, rng.choice([0.15, 0.5]))
        w = regressor(model, q, v, a)
        # The arm: other bodies, friction, rotors and an offset, of which no format has the last.
        drives = np.concatenate([rng.uniform(0.5, 3, 2 * JOINTS), rng.uniform(0.05, 0.3, JOINTS)])
        phi = np.concatenate([*[rng.uniform(0.6, 1.5) * ten for ten in guess], drives])
        true = w @ phi + rng.uniform(-1, 1, JOINTS)
        tau = true + 0.03 * np.sqrt(np.mean(true**2, axis=0)) * rng.standard_normal(true.shape)
        write(log, t, q, tau)
        done = armid("identify", log, "--robot", robot, "--held-out", "none", "--cutoff-hz", CUTOFF, "-o", estimate)
        self.assertIn(done.returncode, (0, 1), done.stderr[:800])
        # Filtered, differentiated and averaged as armid does it: pairs of samples for a cut-off of 10 Hz. Friction turns at once, so that its
        # column passes the filter as the torque does.
        b, c = signal.butter(4, CUTOFF / (RATE / 2))
        q, y = signal.filtfilt(b, c, q, axis=0), signal.filtfilt(b, c, tau, axis=0)
        v, a = np.gradient(q, 1 / RATE, axis=0), np.zeros_like(q)
        a[1:-1] = (q[2:] - 2 * q[1:-1] + q[:-2]) * RATE**2
        w, block = regressor(model, q, v, a), round(RATE / (4 * CUTOFF))
        coulomb = slice(11 * JOINTS, 12 * JOINTS)
        w[:, :, coulomb] = signal.filtfilt(b, c, w[:, :, coulomb], axis=0)
        # A joint that hardly moves shows nothing.
        slow = np.abs(v) < SLOW * np.abs(v).max(axis=0)
        blocks, edge = len(t) // block, round(EDGE / CUTOFF * RATE / block)
        mean = lambda x: x[:blocks * block].reshape(blocks, block, *x.shape[1:]).mean(axis=1)[edge:-edge]
        rests = mean(slow.astype(float)) > 0
        w, y = mean(w), mean(y)
        w[rests], y[rests] = 0.0, 0.0
        count = len(y)
        y = y.ravel()
        for to, columns in (("urdf", 12), ("mjcf", 13)):
            done = armid("export", estimate, "--to", to, "-o", folder / f"out.{to}", "--json")
            self.assertIn(done.returncode, (0, 1), done.stderr[:800])
            answer = json.loads(done.stdout)
            self.assertEqual(answer["termination"]["kind"], "optimal")
            values = {parameter["name"]: parameter["value"] for parameter in answer["parameters"]}
            order = [f"{name}{i + 1}" for i in range(JOINTS) for name in TEN]
            order += [f"{name}{j + 1}" for name in ("Fv", "Fc", "Ia") for j in range(JOINTS)]
            found = np.array([values[name] for name in order[:columns * JOINTS]])
            own = w.reshape(count * JOINTS, -1)[:, :columns * JOINTS]
            program = Program(own, y, guess, answer["prior"]["taken"], np.array(answer["joint_weights"])**-0.5)
            least, reached = program.value(program.solve()), program.value(found)
            self.assertLessEqual(reached, 1.01 * least, (to, answer["prior"], reached, least))


if __name__ == "__main__":
    unittest.main()
