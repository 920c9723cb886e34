"""Models that armid exports, in the libraries they are exported for: Pinocchio reads the URDF, MuJoCo the MJCF. Source code
that it exports, compiled, against Pinocchio."""

import ctypes
import json
import os
import re
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
SOURCE_FUNCTIONS = ("inverse_dynamics", "gravity", "mass_matrix", "forward_dynamics", "regressor")


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
        # Each format has a set of its own, that of its terms. Exit status 1 says that it lacks terms of the estimate.
        cls.phi = {}
        for to, name in [("urdf", "arm.urdf"), ("mjcf", "arm.xml"), ("json", "phi.json")]:
            command = [ARMID, "export", estimate, "--to", to, "-o", str(cls.folder / name), "--json"]
            done = subprocess.run(command, capture_output=True, text=True)
            assert done.returncode in (0, 1), done.stderr
            cls.phi[to] = {parameter["name"]: parameter["value"] for parameter in json.loads(done.stdout)["parameters"]}
        rng = np.random.default_rng(7)
        cls.q, cls.v, cls.a = (rng.uniform(-x, x, (STATES, 6)) for x in (2.0, 2.0, 5.0))
        header = ",".join(f"{kind}{j + 1}" for kind in ("q", "qd", "qdd") for j in range(6))
        np.savetxt(cls.folder / "S.csv", np.hstack([cls.q, cls.v, cls.a]), delimiter=",", header=header, comments="", fmt="%.17g")
        cls.estimate = estimate
        cls.torque = {to: cls.torque_of_links(phi) for to, phi in cls.phi.items()}

    @classmethod
    def torque_of_links(cls, phi):
        """Rigid links alone: each library has friction and rotors in a form of its own."""
        rigid = cls.folder / "rigid.json"
        rigid.write_text(json.dumps({name: value for name, value in phi.items() if not name.startswith(("Ia", "F"))}), encoding="utf-8")
        text = armid("dynamics", "crs-a460", "--states", str(cls.folder / "S.csv"), "--quantity", "torque", "--parameters", str(rigid))
        return np.array([[float(x) for x in line.split(",")] for line in text.splitlines()[1:]])

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def agree(self, torque, to):
        # Rounding: angles and numbers through text, sums in another order.
        np.testing.assert_allclose(torque, self.torque[to], rtol=0, atol=1e-9 * np.abs(self.torque[to]).max())

    def test_pinocchio_has_the_torque_of_the_urdf(self):
        model = pin.buildModelFromUrdf(str(self.folder / "arm.urdf"))
        data = model.createData()
        self.assertEqual(model.nq, 6)
        self.agree(np.array([pin.rnea(model, data, q, v, a) for q, v, a in zip(self.q, self.v, self.a)]), "urdf")
        for inertia in model.inertias[1:]:
            moments = np.linalg.eigvalsh(inertia.inertia)
            self.assertGreater(inertia.mass, 0)
            self.assertGreater(moments[0], 0)
            self.assertGreater(moments[0] + moments[1], moments[2])

    def test_mujoco_has_the_torque_of_the_mjcf(self):
        model = mujoco.MjModel.from_xml_path(str(self.folder / "arm.xml"))
        data = mujoco.MjData(model)
        for j in range(6):
            self.assertAlmostEqual(model.dof_damping[j], self.phi["mjcf"][f"Fv{j + 1}"], places=12)
            self.assertAlmostEqual(model.dof_frictionloss[j], self.phi["mjcf"][f"Fc{j + 1}"], places=12)
            self.assertAlmostEqual(model.dof_armature[j], self.phi["mjcf"][f"Ia{j + 1}"], places=12)
        model.dof_damping[:], model.dof_frictionloss[:], model.dof_armature[:] = 0.0, 0.0, 0.0
        # Joint limits would push back outside their range.
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        torque = []
        for q, v, a in zip(self.q, self.v, self.a):
            data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
            mujoco.mj_inverse(model, data)
            torque.append(data.qfrc_inverse.copy())
        self.agree(np.array(torque), "mjcf")

    def drives(self):
        return {name: value for name, value in self.phi["json"].items() if name.startswith(("Ia", "F"))}

    def base_parameters_of_the_export(self):
        """The estimate again, with the base parameters of links that Pinocchio has, and the drives of the set with all terms."""
        reduced = json.loads(armid("reduce", "crs-a460", "--columns", "rigid+rotor+friction", "--json"))
        phi = {**self.phi["urdf"], **self.drives()}
        expected = {
            base["name"]: sum(term["coefficient"] * phi[term["parameter"]] for term in base["terms"])
            for base in reduced["base"]
        }
        estimate = json.loads(Path(self.estimate).read_text(encoding="utf-8"))
        for parameter in estimate["base"]:
            value = expected[parameter["name"]]
            parameter["value"], parameter["ci95"] = value, [value, value]
        path = self.folder / "exported.json"
        path.write_text(json.dumps(estimate), encoding="utf-8")
        return str(path)

    def source_agrees(self, library, names):
        def call(name, size, *inputs):
            function, out = getattr(library, name), (ctypes.c_double * size)()
            function.restype = None
            function(*[(ctypes.c_double * 6)(*x) for x in inputs], out)
            return np.array(out)

        inverse_dynamics, gravity, mass_matrix, forward_dynamics, regressor = names
        beta = np.array([parameter["value"] for parameter in json.loads((self.folder / "exported.json").read_text())["base"]])
        model = pin.buildModelFromUrdf(str(self.folder / "arm.urdf"))
        data = model.createData()
        rotor, viscous, coulomb, offset = (
            np.array([self.drives()[f"{symbol}{j + 1}"] for j in range(6)]) for symbol in ("Ia", "Fv", "Fc", "Fo"))
        robot = json.loads(armid("robot", "crs-a460", "--json"))
        scale = np.array([joint["drive"]["coulomb_velocity_rad_s"] for joint in robot["joints"]])
        size = np.abs(self.torque["urdf"]).max()
        for q, v, a in zip(self.q, self.v, self.a):
            friction = viscous * v + coulomb * np.tanh(v / scale) + offset
            torque = pin.rnea(model, data, q, v, a) + rotor * a + friction
            weight = pin.computeGeneralizedGravity(model, data, q)
            mass = pin.crba(model, data, q)
            mass = np.triu(mass) + np.triu(mass, 1).T + np.diag(rotor)
            for found, expected in [
                (call(inverse_dynamics, 6, q, v, a), torque),
                (call(gravity, 6, q), weight),
                (call(mass_matrix, 36, q).reshape(6, 6), mass),
                (call(regressor, 6 * len(beta), q, v, a).reshape(6, -1) @ beta, torque),
            ]:
                np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * size)
            np.testing.assert_allclose(call(forward_dynamics, 6, q, v, torque), a, rtol=0, atol=1e-8 * np.abs(self.a).max())

    def test_pinocchio_has_the_dynamics_of_the_c_source(self):
        source, library = self.folder / "arm.c", self.folder / "arm_c.so"
        armid("export", self.base_parameters_of_the_export(), "--to", "c", "-o", str(source))
        subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-fPIC", source, "-o", library,
                        "-lm"], check=True)
        self.source_agrees(ctypes.CDLL(str(library)), [f"armid_{name}" for name in SOURCE_FUNCTIONS])

    def test_pinocchio_has_the_dynamics_of_the_rust_source(self):
        source, library = self.folder / "arm.rs", self.folder / "arm_rust.so"
        armid("export", self.base_parameters_of_the_export(), "--to", "rust", "-o", str(source))
        text = source.read_text(encoding="utf-8")
        base = re.search(r"BASE_PARAMETERS: \[f64; (\d+)\]", text)[1]
        for name, inputs, size in zip(SOURCE_FUNCTIONS, (3, 1, 1, 3, 3), (6, 6, 36, 6, f"6 * {base}")):
            arguments = ", ".join(f"x{k}: &[f64; 6]" for k in range(inputs))
            passed = ", ".join(f"x{k}" for k in range(inputs))
            text += (f"#[no_mangle]\npub extern \"C\" fn c_{name}({arguments}, out: &mut [f64; {size}]) "
                     f"{{ *out = {name}({passed}); }}\n")
        source.write_text(text, encoding="utf-8")
        subprocess.run(["rustc", "--edition", "2021", "-D", "warnings", "-O", "--crate-type", "cdylib", source, "-o", library],
                       check=True)
        self.source_agrees(ctypes.CDLL(str(library)), [f"c_{name}" for name in SOURCE_FUNCTIONS])


if __name__ == "__main__":
    unittest.main()
