"""A MuJoCo arm that position actuators drive, identified from commands and positions, without torque."""

import json
import tempfile
import unittest
from pathlib import Path

import mujoco
import numpy as np
from mujoco import rollout

from makers_arms import armid

STEP, SECONDS, DELAY, COUNT = 1e-3, 20.0, 6, 2 * np.pi / 2**16
KP, KD = [300.0, 250.0, 120.0], [12.0, 9.0, 3.0]
DAMPING, FRICTION = [1.2, 0.8, 0.4], [0.9, 0.7, 0.3]
# Mass of each body: what armid reads, and what moves.
GUESSED, TRUE = [4.0, 3.0, 1.5], [4.0, 3.6, 1.9]


# What the encoders lack, rad, an arm without the friction that jumps, which is not simulated, and the logs of the test of coverage.
ZERO, SMOOTH, SEEDS = (0.0, 0.04, 0.0), [0.0, 0.0, 0.0], 4


# A ball on the last body: mass, kg, and place, m.
LOAD, PLACE, INERTIA = 1.5, 0.3, 5e-4


def arm(masses, load="", friction=FRICTION):
    """Three joints with position actuators."""
    def body(name, place, axis, length, mass, k, inner=""):
        return f'''<body name="{name}" pos="{place}"><joint name="j{k + 1}" axis="{axis}" range="-2.6 2.6" armature="0.05"
damping="{DAMPING[k]}" frictionloss="{friction[k]}"/><inertial pos="{length / 2} 0.01 0.02" mass="{mass}"
diaginertia="{0.002 * mass} {0.02 * mass} {0.02 * mass}"/>{inner}</body>'''

    third = body("fore", "0.4 0 0", "0 1 0", 0.3, masses[2], 2, load)
    second = body("upper", "0 0 0.2", "0 1 0", 0.4, masses[1], 1, third)
    first = body("column", "0 0 0.3", "0 0 1", 0.1, masses[0], 0, second)
    motors = "".join(f'<position name="m{k + 1}" joint="j{k + 1}" kp="{KP[k]}" kv="{KD[k]}"/>' for k in range(3))
    sensors = "".join(f'<actuatorfrc actuator="m{k + 1}"/>' for k in range(3))
    return f'''<mujoco model="arm"><compiler angle="radian"/><option timestep="{STEP}" integrator="RK4"><flag contact="disable"/></option>
<worldbody>{first}</worldbody><actuator>{motors}</actuator><sensor>{sensors}</sensor></mujoco>'''


def log(seed, file, load="", seconds=SECONDS, zero=(0.0, 0.0, 0.0), friction=FRICTION):
    """A table of commands, positions as encoders count them, and the forces of MuJoCo's actuators; a command acts `DELAY` steps later.

    Encoders, and with them commands, lack `zero`, rad.
    """
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(arm(TRUE, load, friction))
    t = np.arange(round(seconds / STEP)) * STEP
    w, phase = 2 * np.pi * rng.uniform(0.1, 1.0, (3, 5, 1)), rng.uniform(0, 2 * np.pi, (3, 5, 1))
    command = (0.25 * np.sin(w * t + phase)).sum(1).T + [0.0, 0.3, 0.5]
    start = np.concatenate([[0.0], command[0], np.zeros(3)])
    control = np.vstack([np.repeat(command[:1], DELAY, axis=0), command[:-DELAY]])
    states, force = (found[0] for found in rollout.rollout(model, mujoco.MjData(model), start, control))
    q = np.vstack([start, states[:-1]])[:, 1:4]
    rows = np.column_stack([t, np.round((q - zero) / COUNT) * COUNT, np.degrees(command - zero), force])
    names = [f"{name}{k + 1}" for name in ["q", "goal", "tau"] for k in range(3)]
    np.savetxt(file, rows, delimiter=",", header=",".join(["t", *names]), comments="", fmt="%.10g")


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        (cls.folder / "arm.xml").write_text(arm(GUESSED), encoding="utf-8")
        log(1, cls.folder / "log.csv")
        log(2, cls.folder / "other.csv")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def identified(self, mapping, name):
        words = ["--robot", self.folder / "arm.xml", "--columns", "rigid+rotor+viscous+coulomb", "-o", self.folder / name, "--json"]
        done = armid("identify", self.folder / "log.csv", "--map", mapping, *words)
        self.assertEqual(done.returncode, 0, done.stderr[:800] + done.stdout[:800])
        return json.loads(done.stdout)

    def test_commands_reveal_what_measured_torque_does(self):
        gains = "/".join(map(str, KP)), "/".join(map(str, KD))
        of_commands = f"t=t, q=q[1-3], q_cmd=goal[1-3] deg kp={gains[0]} kd={gains[1]} delay_ms="
        measured = self.identified("t=t, q=q[1-3], tau=tau[1-3]", "M.json")
        found = self.identified(f"{of_commands}{1e3 * DELAY * STEP:g}", "C.json")
        for one, other in zip(found["base"], measured["base"]):
            self.assertEqual(one["name"], other["name"])
            self.assertLess(abs(one["value"] - other["value"]), 3 * max(one["std"], other["std"]), one["name"])
        # Forces that MuJoCo's actuators had on a motion that the fit has not seen.
        done = armid("validate", self.folder / "C.json", self.folder / "other.csv", "--map", "t=t, q=q[1-3], tau=tau[1-3]", "--json")
        self.assertEqual(done.returncode, 0, done.stderr[:800] + done.stdout[:800])

        # Each command is held for a step, so that the forces at its beginning are not their means: half a step more is the delay.
        found = self.identified(f"{of_commands}{1e3 * (DELAY + 0.5) * STEP:g}", "H.json")
        known = {f"Fv{k + 1}": value for k, value in enumerate(DAMPING)} | {f"Fc{k + 1}": value for k, value in enumerate(FRICTION)}
        # First moments in closed form: the third link, and the second with the third at its end.
        known |= {"mcx3": 0.15 * TRUE[2], "mcz3": 0.02 * TRUE[2], "mcx2": 0.2 * TRUE[1] + 0.4 * TRUE[2]}
        for one in found["base"]:
            self.assertLess(abs(one["value"] - known.pop(one["name"], one["value"])), 4 * one["std"], one)
        self.assertEqual(known, {})

    def test_a_delay_that_is_not_stated_is_the_lag_that_is_found(self):
        gains = f"kp={'/'.join(map(str, KP))} kd={'/'.join(map(str, KD))}"
        mapping = f"t=t, q=q[1-3], q_cmd=goal[1-3] deg {gains}"
        done = armid("identify", self.folder / "log.csv", "--robot", self.folder / "arm.xml", "--map", mapping, "--select", "--json")
        found = json.loads(done.stdout)["selection"]["beyond_motion"]
        self.assertEqual([(lag["parameter"], lag["term"]) for lag in found], [(f"Tl{k}", "current-lag") for k in (1, 2, 3)])
        # The law is of first order in the lag, so that a twentieth of it is left..
        lag_ms = 1e3 * np.mean([lag["value"] for lag in found])
        self.assertLess(abs(lag_ms / (1e3 * (DELAY + 0.5) * STEP) - 1), 0.06)

    def test_a_known_load_shows_the_gains_of_the_servos(self):
        ball = f'<body pos="{PLACE} 0 0"><inertial pos="0 0 0" mass="{LOAD}" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/></body>'
        log(3, self.folder / "loaded.csv", ball)
        stated = [0.8 * KP[0], 1.25 * KP[1], KP[2]]
        mapping = f"t=t, q=q[1-3], q_cmd=goal[1-3] deg kp={'/'.join(map(str, stated))} kd=0 delay_ms={1e3 * (DELAY + 0.5) * STEP}"
        load = ["--payload-mass", LOAD, "--payload-centre", f"{PLACE},0,0", "--payload-inertia", ",".join([str(INERTIA)] * 3)]
        sides = ["--without", self.folder / "log.csv", "--with", self.folder / "loaded.csv", "--robot", self.folder / "arm.xml"]
        done = armid("identify", "--drive-gains", *sides, *load, "--map", mapping, "--columns", "rigid+rotor+viscous+coulomb", "--json")
        self.assertEqual(done.returncode, 0, done.stderr[:800])
        answer = json.loads(done.stdout)
        for joint, kp, known in zip(answer["joints"], stated, KP):
            found = joint["by"]["tls"]["kp_nm_rad"]
            self.assertEqual(joint["stated_nm_rad"], kp)
            self.assertLess(abs(found["value"] - known), 4 * found["std"], joint)
            self.assertLess(found["std"], 0.05 * known)
        self.assertEqual(answer["wrong"], ["j1", "j2"])
        self.assertTrue(answer["corrected"].startswith("kp="))
        # Damping is part of viscous friction then: it would be scaled as the stiffness is.
        done = armid("identify", "--drive-gains", *sides, *load, "--map", mapping.replace("kd=0", "kd=1"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("states kd, expected kd=0", done.stderr)

    def by_cloe(self, file, servo, *words):
        known = ["--robot", self.folder / "arm.xml", "--columns", "rigid+rotor+viscous"]
        return armid("identify", self.folder / file, "--map", f"t=t, q=q[1-3], q_cmd=goal[1-3] deg {servo}", *known, *words)

    def test_what_is_unknown_of_the_servos_is_estimated_with_the_arm(self):
        unknown = {"kp2": KP[1], "delay": (DELAY + 0.5) * STEP, "zero2": ZERO[1]}
        servo = f"kp={KP[0]}/{0.8 * KP[1]}/{KP[2]} kd={'/'.join(map(str, KD))} unknown={'/'.join(unknown)}"
        held, count = 0, 0
        for seed in range(SEEDS):
            log(10 + seed, self.folder / "unknown.csv", seconds=10.0, zero=ZERO, friction=SMOOTH)
            done = self.by_cloe("unknown.csv", servo, "--estimator", "cloe", "--json", "-o", self.folder / "U.json")
            self.assertEqual(done.returncode, 0, done.stderr[:800] + done.stdout[:800])
            answer = json.loads(done.stdout)
            self.assertEqual([one["name"] for one in answer["servo"]], list(unknown))
            for one in answer["servo"]:
                known = unknown[one["name"]]
                self.assertLess(abs(one["value"] - known), 5 * one["std"], one)
                self.assertLess(one["std"], 0.2 * known, one)
                held += one["ci95"][0] <= known <= one["ci95"][1]
                count += 1
        # By a binomial distribution, fewer have a chance below one in a thousand.
        self.assertGreaterEqual(held, count - 4, f"{held} of {count} intervals hold what MuJoCo has")
        # Another log, whose torque is that of the servos that were found.
        log(30, self.folder / "fresh.csv", seconds=10.0, zero=ZERO, friction=SMOOTH)
        done = armid("validate", self.folder / "U.json", self.folder / "fresh.csv", "--json")
        self.assertEqual(done.returncode, 0, done.stderr[:800] + done.stdout[:800])
        self.assertEqual(json.loads(done.stdout)["verdict"], "passed")

    def test_what_the_motion_does_not_show_of_the_servos_is_refused_with_the_reason(self):
        gains = f"kp={'/'.join(map(str, KP))} kd={'/'.join(map(str, KD))}"
        for unknown, reason in [
            ("kp1/kp2/kp3", "expected a stated kp of one joint, or a known payload"),
            ("kd2", "does not show kd2 of the servo: it moves the arm as Fv2 can"),
            ("zero3", "does not show zero3 of the servo"),
            ("zero1", "does not show zero1 of the servo"),
        ]:
            done = self.by_cloe("log.csv", f"{gains} unknown={unknown}", "--estimator", "cloe")
            self.assertEqual(done.returncode, 2, done.stderr[:400])
            self.assertIn(reason, done.stderr)
        done = self.by_cloe("log.csv", f"{gains} unknown=delay")
        self.assertEqual(done.returncode, 2)
        self.assertIn("delay of the servo is unknown, expected it to be known for the estimator wls", done.stderr)

    def test_a_mapping_of_commands_needs_the_gains(self):
        done = armid("identify", self.folder / "log.csv", "--robot", self.folder / "arm.xml", "--map", "t=t, q=q[1-3], q_cmd=goal[1-3] deg")
        self.assertEqual(done.returncode, 2)
        self.assertIn("expected the gains of the servo", done.stderr)


if __name__ == "__main__":
    unittest.main()
