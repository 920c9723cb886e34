"""Arms as their makers describe them: every serial arm of example-robot-data, read by armid and by Pinocchio; three of them
moved by Pinocchio, identified, and exported into their own URDF."""

import json
import re
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pinocchio as pin

from makers_arms import ROBOTS, armid

METHODS = ["structural", "qr", "paper"]

# Relative singular value that counts. Right angles that the files round to 5e-5 rad, which armid mends and Pinocchio does not,
# give values up to some 1e-5; what these arms' true geometry gives is above 1e-3.
TOLERANCE = 1e-4

# File; base and tip link, where armid is to be told; joints.
ARMS = [
    ("asr_twodof_description/urdf/TwoDofs.urdf", None, None, 2),
    ("borinot_description/urdf/borinot_flying_arm_2.urdf", None, None, 2),
    ("double_pendulum_description/urdf/double_pendulum.urdf", None, None, 2),
    ("double_pendulum_description/urdf/double_pendulum_continuous.urdf", None, None, 2),
    ("hextilt_description/urdf/hextilt_flying_arm_5.urdf", None, None, 5),
    ("finger_edu_description/robots/finger_edu.urdf", None, None, 3),
    ("kinova_description/robots/kinova.urdf", None, None, 6),
    ("panda_description/urdf/panda.urdf", None, None, 7),
    ("panda_description/urdf/panda_collision.urdf", None, None, 7),
    ("so_arm_description/urdf/so100.urdf", None, None, 6),
    ("so_arm_description/urdf/so101.urdf", None, None, 6),
    ("talos_data/robots/talos_left_arm.urdf", None, None, 7),
    ("ur_description/urdf/ur3_robot.urdf", None, None, 6),
    ("ur_description/urdf/ur3_gripper.urdf", None, None, 6),
    ("ur_description/urdf/ur3_joint_limited_robot.urdf", None, None, 6),
    ("ur_description/urdf/ur5_robot.urdf", None, None, 6),
    ("ur_description/urdf/ur5_gripper.urdf", None, None, 6),
    ("ur_description/urdf/ur5_joint_limited_robot.urdf", None, None, 6),
    ("ur_description/urdf/ur10_robot.urdf", None, None, 6),
    ("ur_description/urdf/ur10_joint_limited_robot.urdf", None, None, 6),
    ("xarm_description/urdf/xarm7.urdf", None, None, 7),
    ("z1_description/urdf/z1.urdf", None, None, 7),
    # Arms of larger robots.
    ("alex_description/urdf/alex_nub_hands.urdf", None, "leftNub", 10),
    ("anymal_b_simple_description/robots/anymal-kinova.urdf", None, "j2s6s200_end_effector", 6),
    ("b1_description/urdf/b1-z1.urdf", None, "gripperMover", 7),
    ("baxter_description/urdf/baxter.urdf", None, "left_hand_camera_link", 7),
    ("baxter_description/urdf/baxter.urdf", None, "right_hand_camera_link", 7),
    ("centauro_description/urdf/centauro.urdf", "torso_2", "ball1_tip", 6),
    ("icub_description/robots/icub.urdf", "chest", "l_gripper", 7),
    ("talos_data/robots/talos_reduced.urdf", "torso_2_link", "arm_left_7_link", 7),
    ("talos_data/robots/talos_reduced.urdf", "torso_2_link", "arm_right_7_link", 7),
    ("talos_data/robots/talos_full_v2.urdf", "torso_2_link", "arm_right_7_link", 7),
    ("tiago_description/robots/tiago_no_hand.urdf", None, "wrist_ft_tool_link", 8),
    ("tiago_description/robots/tiago_no_hand.urdf", "torso_lift_link", "wrist_ft_tool_link", 7),
    ("tiago_description/robots/tiago_dual.urdf", "torso_lift_link", "wrist_left_ft_tool_link", 7),
    ("tiago_pro_description/robots/tiago_pro.urdf", "torso_lift_link", "arm_left_7_link", 7),
    ("pr2_description/urdf/pr2.urdf", "torso_lift_link", "r_wrist_roll_link", 7),
]

# What is no single arm: the reason that armid gives.
REFUSED = [
    ("a1_description/urdf/a1.urdf", "expected a tip link to choose the chain"),
    ("allegro_hand_description/urdf/allegro_left_hand.urdf", "expected a tip link to choose the chain"),
    ("tiago_description/robots/tiago.urdf", "expected a tip link to choose the chain"),
    ("ur_description/urdf/ur3.urdf", "xacro"),
    ("iris_description/robots/iris_simple.urdf", "no joint moves"),
]


def chain(base, tip):
    ends = [("--base-link", base), ("--tip-link", tip)]
    return [word for key, link in ends if link for word in (key, link)]


def pinocchio_rank(path, joints):
    """Rank of the stacked torque regressor of these joints, all others at their zero.

    Bodies that other joints carry are columns of their own; held still, they add nothing to the rank.
    """
    model = pin.buildModelFromUrdf(str(path))
    data, rng = model.createData(), np.random.default_rng(1)
    chosen = [model.joints[model.getJointId(name)].idx_v for name in joints]

    def of_chosen(bound):
        values = np.zeros(model.nv)
        values[chosen] = rng.uniform(-bound, bound, len(chosen))
        return values

    rows = []
    for _ in range(30 * len(joints)):
        q = pin.integrate(model, pin.neutral(model), of_chosen(3))
        rows.append(pin.computeJointTorqueRegressor(model, data, q, of_chosen(4), of_chosen(16))[chosen])
    stack = np.vstack(rows)
    lengths = np.linalg.norm(stack, axis=0)
    stack = stack[:, lengths > TOLERANCE * lengths.max()]
    values = np.linalg.svd(stack / np.linalg.norm(stack, axis=0), compute_uv=False)
    return int((values > TOLERANCE * values[0]).sum())


class Urdfs(unittest.TestCase):
    def test_three_methods_and_pinocchio_agree_on_every_arm(self):
        for file, base, tip, dof in ARMS:
            with self.subTest(f"{file} {base or ''} {tip or ''}"):
                path = ROBOTS / file
                robot = armid("robot", path, *chain(base, tip), "--json")
                self.assertEqual(robot.returncode, 0, robot.stderr[:600])
                joints = [joint["name"] for joint in json.loads(robot.stdout)["joints"]]
                self.assertEqual(len(joints), dof, joints)
                for columns in ["rigid", "rigid+rotor+friction"]:
                    found = []
                    for method in METHODS:
                        done = armid("reduce", path, *chain(base, tip), "--method", method, "--columns", columns, "--json")
                        self.assertEqual(done.returncode, 0, done.stderr[:600])
                        found.append(json.loads(done.stdout))
                    # What stands in the base, and how many there are by structure alone.
                    for other in found[1:]:
                        self.assertEqual([p["name"] for p in other["base"]], [p["name"] for p in found[0]["base"]])
                        self.assertEqual(other["structural_rank"], found[0]["structural_rank"])
                    if columns == "rigid":
                        self.assertEqual(found[0]["rank"], pinocchio_rank(path, joints))

    def test_what_is_no_arm_says_why(self):
        for file, reason in REFUSED:
            with self.subTest(file):
                done = armid("robot", ROBOTS / file)
                self.assertEqual(done.returncode, 2)
                words = " ".join(done.stderr.replace("│", " ").split())
                self.assertIn(reason, words)
                self.assertLess(len(done.stderr), 1500)


def numbers_apart(text):
    """A URDF without the numbers that an export may change, and without what it may add."""
    text = re.sub(r"<!-- armid:.*?-->\s*", "", text)
    text = re.sub(r"\s*<dynamics[^>]*/>", "", text)
    return re.sub(r"<inertial>.*?</inertial>", "", text, flags=re.DOTALL)


class ClosedLoop(unittest.TestCase):
    """Pinocchio moves an arm that its URDF describes wrongly; armid identifies it and puts it into the URDF."""

    FILES = ["ur_description/urdf/ur5_robot.urdf", "xarm_description/urdf/xarm7.urdf", "so_arm_description/urdf/so100.urdf"]
    PERIOD, RATE, PERIODS, HARMONICS, NOISE = 10.0, 100, 4, 5, 0.01

    def test_an_identified_arm_is_that_arm_in_its_own_urdf(self):
        for file in self.FILES:
            with self.subTest(file), tempfile.TemporaryDirectory() as scratch:
                self.close(ROBOTS / file, Path(scratch))

    def record(self, model, viscous, coulomb, rng, log):
        """A table of what Pinocchio says of some motion of a model with friction, and noise."""
        n, data = model.nv, model.createData()
        t = np.arange(int(self.PERIOD * self.RATE * self.PERIODS)) / self.RATE
        orders = np.arange(1, self.HARMONICS + 1)
        phase = 2 * np.pi * orders[:, None] * t / self.PERIOD
        speed = (2 * np.pi * orders / self.PERIOD)[:, None]
        a, b = rng.uniform(-0.5, 0.5, (2, n, self.HARMONICS)) / np.sqrt(orders)
        q = a @ np.sin(phase) - b @ np.cos(phase)
        v = a @ (speed * np.cos(phase)) + b @ (speed * np.sin(phase))
        acceleration = -a @ (speed**2 * np.sin(phase)) + b @ (speed**2 * np.cos(phase))
        torque = np.array([pin.rnea(model, data, *state) for state in zip(q.T, v.T, acceleration.T)])
        torque += viscous * v.T + coulomb * np.sign(v.T)
        noise = self.NOISE * np.sqrt(np.mean(torque**2, axis=0))
        torque += noise * rng.standard_normal(torque.shape)
        header = ",".join(["t", *(f"q{i + 1}" for i in range(n)), *(f"tau{i + 1}" for i in range(n))])
        np.savetxt(log, np.column_stack([t, q.T, torque]), delimiter=",", header=header, comments="", fmt="%.12g")

    def test_a_load_that_pinocchio_puts_on_a_seven_axis_arm_is_found(self):
        path = ROBOTS / "xarm_description/urdf/xarm7.urdf"
        rng = np.random.default_rng(12)
        model = pin.buildModelFromUrdf(str(path))
        friction = rng.uniform(0.1, 0.5, (2, model.nv))
        load = pin.Inertia(1.2, np.array([0.05, -0.02, 0.08]), np.diag([0.004, 0.005, 0.003]))
        with tempfile.TemporaryDirectory() as scratch:
            logs = [Path(scratch) / name for name in ("without.csv", "with.csv")]
            self.record(model, *friction, rng, logs[0])
            model.inertias[model.njoints - 1] += load
            # Friction has changed in the meantime.
            self.record(model, *(1.2 * friction), rng, logs[1])
            done = armid("identify", "--payload", "--without", logs[0], "--with", logs[1], "--robot", path, "--period",
                         self.PERIOD, "--columns", "rigid+viscous+coulomb", "--json")
        self.assertIn(done.returncode, (0, 1), done.stderr[:800])
        answer = json.loads(done.stdout)
        self.assertTrue(answer["consistent"])
        m, cx, cy, cz, xx, xy, yy, xz, yz, zz = load.toDynamicParameters()
        expected = dict(m=m, mcx=cx, mcy=cy, mcz=cz, Ixx=xx, Ixy=xy, Ixz=xz, Iyy=yy, Iyz=yz, Izz=zz)
        for parameter in answer["parameters"]:
            shown = parameter["shown"]
            self.assertLess(abs(shown["value"] - expected[parameter["name"]]), 5 * shown["std"], parameter)
        self.assertAlmostEqual(answer["body"]["mass_kg"], m, delta=0.05)

    def close(self, path, folder):
        rng = np.random.default_rng(11)
        true = pin.buildModelFromUrdf(str(path))
        n = true.nv
        for i in range(1, true.njoints):
            own = true.inertias[i]
            lever = own.lever + rng.uniform(-0.01, 0.01, 3)
            true.inertias[i] = pin.Inertia(own.mass * rng.uniform(0.8, 1.3), lever, own.inertia)
        viscous, coulomb = rng.uniform(0.1, 0.5, n), rng.uniform(0.1, 0.5, n)
        log, estimate, out = folder / "log.csv", folder / "E.json", folder / "out.urdf"
        self.record(true, viscous, coulomb, rng, log)
        done = armid("identify", log, "--robot", path, "--period", self.PERIOD, "--columns", "rigid+viscous+coulomb",
                     "-o", estimate)
        self.assertEqual(done.returncode, 0, done.stderr[:800])
        done = armid("export", estimate, "--robot", path, "--to", "urdf", "-o", out, "--json")
        self.assertEqual(done.returncode, 0, done.stderr[:800])
        answer = json.loads(done.stdout)
        self.assertTrue(answer["prediction"]["good"], answer["prediction"])
        self.assertLess(answer["reload"]["largest_relative_difference"], 1e-9)
        original, written = path.read_text(encoding="utf-8"), out.read_text(encoding="utf-8")
        self.assertEqual(numbers_apart(written).split(), numbers_apart(original).split())
        self.assertNotEqual(written, original)
        # Pinocchio on other states: the exported arm against the true one, beside the arm as its maker describes it.
        def torques(model):
            states = np.random.default_rng(5)
            data = model.createData()
            return np.array([pin.rnea(model, data, *(states.uniform(-x, x, n) for x in (1.5, 1.0, 2.0))) for _ in range(200)])

        exported, maker = pin.buildModelFromUrdf(str(out)), pin.buildModelFromUrdf(str(path))
        truth = torques(true)
        off = [np.linalg.norm(torques(model) - truth) / np.linalg.norm(truth) for model in (exported, maker)]
        self.assertLess(off[0], 2 * self.NOISE)
        self.assertGreater(off[1], 5 * off[0])
        np.testing.assert_allclose(exported.damping, viscous, atol=0.1)
        np.testing.assert_allclose(exported.friction, coulomb, atol=0.1)


if __name__ == "__main__":
    unittest.main()
