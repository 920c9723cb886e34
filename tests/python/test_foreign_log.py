"""The log of a stranger's arm, from its URDF and a mapping alone: Pinocchio moves an arm with gears, rotors and friction that
its URDF does not have, a table is written as some controller would, and what armid makes of it is asked again in Pinocchio and
MuJoCo."""

import json
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin

from makers_arms import ROBOTS, armid

PERIOD, HARMONICS, RATE, TIME = 10.0, 5, 100, 40.0
# Standard deviation of the noise of a joint's torque, as a part of its RMS; time by which a stamp is off its even place, s.
NOISE, JITTER = 0.01, 0.003
# Speed about which Coulomb friction turns round, rad/s.
SMOOTH = 0.01


class Arm:
    """An arm that its URDF describes wrongly: other inertias, and drives that the file does not know."""

    def __init__(self, path, rng):
        self.path, self.model = path, pin.buildModelFromUrdf(str(path))
        self.n = n = self.model.nv
        for i in range(1, self.model.njoints):
            own = self.model.inertias[i]
            lever = own.lever + rng.uniform(-0.01, 0.01, 3)
            self.model.inertias[i] = pin.Inertia(own.mass * rng.uniform(0.8, 1.3), lever, own.inertia)
        self.viscous, self.coulomb = rng.uniform(0.1, 0.5, (2, n))
        self.gear = rng.choice([50.0, 100.0, 160.0], n)
        # One motor turns the other way.
        self.gear[1] *= -1
        self.constant = np.round(rng.uniform(0.03, 0.12, n), 4)
        self.model.armature = self.gear**2 * rng.uniform(0.5e-6, 2e-6, n)

    def torque(self, q, v, a):
        return torque(self.model, self.viscous, self.coulomb, q, v, a)


def torque(model, viscous, coulomb, q, v, a):
    """Torque by Pinocchio's recursion, rotors (`armature`) included, with friction."""
    data = model.createData()
    return np.array([pin.rnea(model, data, *state) for state in zip(q, v, a)]) + friction(viscous, coulomb, v)


def friction(viscous, coulomb, v):
    return viscous * v + coulomb * np.tanh(v / SMOOTH)


def motion(t, n, rng):
    """A periodic motion of all joints at some instants."""
    orders = np.arange(1, HARMONICS + 1)
    w = 2 * np.pi * orders[:, None] / PERIOD
    a, b = rng.uniform(-0.5, 0.5, (2, n, HARMONICS)) / np.sqrt(orders)
    sin, cos = np.sin(w * t), np.cos(w * t)
    return (a @ sin - b @ cos).T, (a @ (w * cos) + b @ (w * sin)).T, (-a @ (w**2 * sin) + b @ (w**2 * cos)).T


def log(arm, rng, file):
    """A table in milliseconds, degrees and milliamperes with uneven stamps, headings and columns of its own, separated by
    semicolons, with decimal commas. Gives states, measured torque and the noise in it."""
    t = np.arange(int(RATE * TIME)) / RATE
    t = t + rng.uniform(-JITTER, JITTER, t.size)
    states = motion(t, arm.n, rng)
    true = arm.torque(*states)
    noise = NOISE * np.sqrt(np.mean(true**2, axis=0)) * rng.standard_normal(true.shape)
    current = (true + noise) / (arm.gear * arm.constant)
    headings = ["stamp", "mode", *(f"axis{i + 1}_deg" for i in range(arm.n)), *(f"amps_{i + 1}" for i in range(arm.n)), "temp"]
    rows = ((f"{1.7e6 + 1e3 * t:.3f}", "3", *(f"{x:.4f}" for x in q), *(f"{1e3 * x:.2f}" for x in i), "42.5")
            for t, q, i in zip(t, np.degrees(states[0]), current))
    text = "\n".join([";".join(headings), *(";".join(row).replace(".", ",") for row in rows)])
    file.write_text(text + "\n", encoding="utf-8")
    return states, true + noise, noise


def rms(values):
    return np.sqrt(np.mean(values**2, axis=0))


def pseudo_inertia(mass, centre, inertia):
    """The 4 × 4 matrix that is positive definite for every body, from the inertia about its centre of mass."""
    sigma = 0.5 * np.trace(inertia) * np.eye(3) - inertia + mass * np.outer(centre, centre)
    return np.block([[sigma, mass * centre[:, None]], [mass * centre[None, :], np.array([[mass]])]])


def bodies_of_urdf(file):
    """Mass, centre and inertia of each link that is a body, as the file says them: frames have a mass of zero."""
    for inertial in ElementTree.parse(file).getroot().iterfind("link/inertial"):
        mass = float(inertial.find("mass").get("value"))
        if mass == 0:
            continue
        origin = inertial.find("origin")
        places = {} if origin is None else origin.attrib
        centre, angles = (np.array(places.get(key, "0 0 0").split(), float) for key in ("xyz", "rpy"))
        xx, xy, xz, yy, yz, zz = (float(inertial.find("inertia").get(key)) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
        turn = pin.rpy.rpyToMatrix(*angles)
        yield mass, centre, turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T


class ForeignLog(unittest.TestCase):
    def test_an_arm_like_a_ur(self):
        self.close("ur_description/urdf/ur5_robot.urdf")

    def test_an_arm_of_seven_axes(self):
        self.close("xarm_description/urdf/xarm7.urdf")

    def test_an_arm_whose_right_angles_are_rounded(self):
        path = "so_arm_description/urdf/so100.urdf"
        self.assertGreater((ROBOTS / path).read_text(encoding="utf-8").count("1.57079 "), 2)
        self.close(path)

    def close(self, file):
        rng = np.random.default_rng(3)
        arm = Arm(ROBOTS / file, rng)
        with tempfile.TemporaryDirectory() as scratch:
            self.identify(arm, rng, Path(scratch))

    def identify(self, arm, rng, folder):
        n, estimate = arm.n, folder / "E.json"
        log(arm, rng, folder / "log.csv")
        states, measured, noise = log(arm, rng, folder / "other.csv")
        of_each = {key: "/".join(f"{x:g}" for x in getattr(arm, key)) for key in ("gear", "constant")}
        mapping = (f"t=stamp ms, q=axis[1-{n}]_deg deg, "
                   f"current=amps_[1-{n}] mA gear={of_each['gear']} constant={of_each['constant']}")
        done = armid("identify", folder / "log.csv", "--robot", arm.path, "--map", mapping, "-o", estimate, "--json")
        self.assertEqual(done.returncode, 0, done.stdout[:2000] + done.stderr[:2000])
        answer = json.loads(done.stdout)
        self.assertEqual(answer["suspicions"], [])
        self.assertEqual(answer["logs"][0]["skipped_columns"], ["mode", "temp"])
        self.assertFalse(answer["logs"][0]["timing"]["even"])

        # The other log, which is read as the first was.
        done = armid("validate", estimate, folder / "other.csv", "--json")
        self.assertEqual(done.returncode, 0, done.stdout[:2000] + done.stderr[:2000])

        urdf, mjcf = folder / "arm.urdf", folder / "arm.xml"
        # The rotors carry torque that URDF has no place for: the answer says how much.
        done = armid("export", estimate, "--to", "urdf", "-o", urdf, "--json")
        self.assertIn(done.returncode, (0, 1), done.stdout[:2000] + done.stderr[:2000])
        exported = json.loads(done.stdout)
        self.assertIn("rotor inertia", exported["left_out"])
        self.assertEqual(done.returncode == 0, exported["prediction"]["good"])
        if done.returncode == 1:
            self.assertIn("rotor inertia", [lacking["term"] for lacking in exported["lacking"]])
        # Pinocchio predicts the log as the answer says, with friction that turns at once as the file's does.
        read = pin.buildModelFromUrdf(str(urdf))
        predicted = torque(read, read.damping, 0.0, *states) + read.friction * np.sign(states[1])
        error = np.linalg.norm(measured - predicted) / np.linalg.norm(measured)
        self.assertAlmostEqual(error, exported["prediction"]["file"]["fit"], delta=0.02)
        done = armid("export", estimate, "--to", "mjcf", "-o", mjcf)
        self.assertEqual(done.returncode, 0, done.stdout[:2000] + done.stderr[:2000])
        for body in bodies_of_urdf(urdf):
            self.assertGreater(np.linalg.eigvalsh(pseudo_inertia(*body))[0], 0, body)

        # MuJoCo: friction that acts at rest as well is a constraint there, and is added as the arm has it.
        model = mujoco.MjModel.from_xml_path(str(mjcf))
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        coulomb, data, found = model.dof_frictionloss.copy(), mujoco.MjData(model), []
        for data.qpos[:], data.qvel[:], data.qacc[:] in zip(*states):
            mujoco.mj_inverse(model, data)
            found.append(data.qfrc_inverse.copy())
        found = np.array(found) + friction(0.0, coulomb, states[1])
        self.within_noise(found, measured, noise)
        self.assertTrue((model.dof_armature >= 0).all() and (model.dof_damping >= 0).all() and (coulomb >= 0).all())
        for mass, inertia in zip(model.body_mass[1:], model.body_inertia[1:]):
            if mass > 0:
                self.assertGreater(np.linalg.eigvalsh(pseudo_inertia(mass, np.zeros(3), np.diag(inertia)))[0], 0)

    def within_noise(self, predicted, measured, noise):
        """What is measured differs from the prediction by little more than its noise: the guess of the bodies may cost a standard error."""
        ratio = rms(measured - predicted) / rms(noise)
        self.assertLess(ratio.max(), 1.2, ratio)


if __name__ == "__main__":
    unittest.main()
