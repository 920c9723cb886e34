"""Models that armid exports, in the libraries they are exported for: Pinocchio reads the URDF, MuJoCo the MJCF."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin

ARMID = Path(os.environ["ARMID"]).resolve()
EXPERIMENT = 'robot = "crs-a460"\ntrajectory = "table-one"\nperiods = 2\nseed = 4\n'
STATES = 50


def armid(*arguments):
    return subprocess.run([ARMID, *arguments], check=True, capture_output=True, text=True).stdout


class Exchange(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        (cls.folder / "experiment.toml").write_text(EXPERIMENT, encoding="utf-8")
        recording, estimate = str(cls.folder / "R.mcap"), str(cls.folder / "E.json")
        armid("run", str(cls.folder / "experiment.toml"), "-o", recording)
        armid("identify", recording, "-o", estimate)
        for to, name in [("urdf", "arm.urdf"), ("mjcf", "arm.xml"), ("json", "phi.json")]:
            armid("export", estimate, "--to", to, "-o", str(cls.folder / name))
        # Rigid links alone: each library has friction and rotors in a form of its own.
        phi = json.loads((cls.folder / "phi.json").read_text(encoding="utf-8"))
        rigid = {name: value for name, value in phi.items() if not name.startswith(("Ia", "F"))}
        (cls.folder / "rigid.json").write_text(json.dumps(rigid), encoding="utf-8")
        rng = np.random.default_rng(7)
        cls.q, cls.v, cls.a = (rng.uniform(-x, x, (STATES, 6)) for x in (2.0, 2.0, 5.0))
        header = ",".join(f"{kind}{j + 1}" for kind in ("q", "qd", "qdd") for j in range(6))
        states = cls.folder / "S.csv"
        np.savetxt(states, np.hstack([cls.q, cls.v, cls.a]), delimiter=",", header=header, comments="", fmt="%.17g")
        text = armid("dynamics", "crs-a460", "--states", str(states), "--quantity", "torque",
                     "--parameters", str(cls.folder / "rigid.json"))
        cls.torque = np.array([[float(x) for x in line.split(",")] for line in text.splitlines()[1:]])
        cls.phi = phi

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def agree(self, torque):
        # Rounding: angles and numbers through text, sums in another order.
        np.testing.assert_allclose(torque, self.torque, rtol=0, atol=1e-9 * np.abs(self.torque).max())

    def test_pinocchio_has_the_torque_of_the_urdf(self):
        model = pin.buildModelFromUrdf(str(self.folder / "arm.urdf"))
        data = model.createData()
        self.assertEqual(model.nq, 6)
        self.agree(np.array([pin.rnea(model, data, q, v, a) for q, v, a in zip(self.q, self.v, self.a)]))
        for inertia in model.inertias[1:]:
            moments = np.linalg.eigvalsh(inertia.inertia)
            self.assertGreater(inertia.mass, 0)
            self.assertGreater(moments[0], 0)
            self.assertGreater(moments[0] + moments[1], moments[2])

    def test_mujoco_has_the_torque_of_the_mjcf(self):
        model = mujoco.MjModel.from_xml_path(str(self.folder / "arm.xml"))
        data = mujoco.MjData(model)
        for j in range(6):
            self.assertAlmostEqual(model.dof_damping[j], self.phi[f"Fv{j + 1}"], places=12)
            self.assertAlmostEqual(model.dof_frictionloss[j], self.phi[f"Fc{j + 1}"], places=12)
            self.assertAlmostEqual(model.dof_armature[j], self.phi[f"Ia{j + 1}"], places=12)
        model.dof_damping[:], model.dof_frictionloss[:], model.dof_armature[:] = 0.0, 0.0, 0.0
        # Joint limits would push back outside their range.
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        torque = []
        for q, v, a in zip(self.q, self.v, self.a):
            data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
            mujoco.mj_inverse(model, data)
            torque.append(data.qfrc_inverse.copy())
        self.agree(np.array(torque))


if __name__ == "__main__":
    unittest.main()
