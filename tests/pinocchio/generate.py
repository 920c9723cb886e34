"""Reference torques, accelerations, mass matrices and regressors by Pinocchio.

    python3 -m venv VENV && VENV/bin/pip install pin==4.1.0
    VENV/bin/python tests/pinocchio/generate.py            # rewrites the files beside this script

Robots come from models/*/ and, for random chains, from a generator of this script. States are drawn from a linear
congruential generator that tests/pinocchio.rs repeats, so that only answers are stored.
"""

import json
import tomllib
from pathlib import Path

import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
MODELS = HERE.parent.parent / "models"

# name, file of parameters, number of states whose torque is stored
BUNDLED = [("crs-a460", "nominal.toml", 1000), ("puma-560", "published.toml", 1000), ("staubli-tx40", "nominal.toml", 100)]
CHAINS, STATES_PER_CHAIN = 20, 50
# Of those states: how many have mass matrix and acceleration, how many the regressor.
DEEP, REGRESSORS, CHAINS_WITH_REGRESSOR = 10, 2, 4


class Generator:
    """x <- 6364136223846793005 x + 1442695040888963407 mod 2^64, the upper 53 bits as a fraction."""

    def __init__(self, seed):
        self.x = seed

    def uniform(self, low, high):
        self.x = (6364136223846793005 * self.x + 1442695040888963407) % 2**64
        return low + (high - low) * ((self.x >> 11) / 2**53)

    def state(self, dof):
        return [np.array([self.uniform(-b, b) for _ in range(dof)]) for b in (3.0, 2.0, 10.0)]


def transform(rotation=np.eye(3), translation=(0, 0, 0)):
    return pin.SE3(rotation, np.array(translation, dtype=float))


def turn(axis, degrees):
    angle = np.radians(degrees)
    return transform(pin.utils.rotate(axis, angle))


def placements(joint):
    """Before and after the joint, for a DH row with the coordinate at zero."""
    rz, rx = turn("z", joint["offset_deg"]), turn("x", joint["alpha_deg"])
    tz, tx = transform(translation=(0, 0, joint["d_m"])), transform(translation=(joint["a_m"], 0, 0))
    if joint["convention"] == "standard":
        return rz, tz * tx * rx
    return rx * tx * rz * tz, pin.SE3.Identity()


def frame_change(placement):
    """10 x 10: the parameters about the joint's frame, in Pinocchio's order, from those about the link's, in ours."""
    t = placement.homogeneous
    a = np.zeros((10, 10))
    for column in range(10):
        m, x, y, z, xx, xy, xz, yy, yz, zz = np.eye(10)[column]
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        pseudo = np.zeros((4, 4))
        pseudo[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
        pseudo[:3, 3] = pseudo[3, :3] = [x, y, z]
        pseudo[3, 3] = m
        p = t @ pseudo @ t.T
        i = np.trace(p[:3, :3]) * np.eye(3) - p[:3, :3]
        a[:, column] = [p[3, 3], *p[:3, 3], i[0, 0], i[0, 1], i[1, 1], i[0, 2], i[1, 2], i[2, 2]]
    return a


def body(ten):
    """The inertia with our ten parameters; Pinocchio keeps it about the centre of mass."""
    m, x, y, z, xx, xy, xz, yy, yz, zz = ten
    c = np.array([x, y, z]) / m if m else np.zeros(3)
    about_origin = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return pin.Inertia(m, c, about_origin - m * (c @ c * np.eye(3) - np.outer(c, c)))


class Arm:
    def __init__(self, robot):
        self.robot = robot
        self.dof = len(robot["joints"])
        self.model = pin.Model()
        self.model.gravity.linear = np.array(robot["gravity_m_s2"], dtype=float)
        # Rotors of coupled motors are added by hand: an armature is diagonal.
        self.coupling = np.array(robot.get("coupling", np.eye(self.dof)))
        self.rotors = self.coupling.T @ np.diag(robot["rotors_kg_m2"]) @ self.coupling
        self.changes = []
        parent, end = 0, pin.SE3.Identity()
        for joint, ten in zip(robot["joints"], robot["links"]):
            before, after = placements(joint)
            kind = pin.JointModelRZ() if joint["kind"] == "revolute" else pin.JointModelPZ()
            parent = self.model.addJoint(parent, kind, end * before, f"joint{parent + 1}")
            self.changes.append(frame_change(after))
            self.model.appendBodyToJoint(parent, body(ten), after)
            end = after
        self.data = self.model.createData()

    def torque(self, q, v, a):
        return pin.rnea(self.model, self.data, q, v, a) + self.rotors @ a

    def mass_matrix(self, q):
        upper = np.triu(pin.crba(self.model, self.data, q))
        return upper + np.triu(upper, 1).T + self.rotors

    def acceleration(self, q, v, tau):
        diagonal = np.diag(self.rotors).copy()
        if np.array_equal(np.diag(diagonal), self.rotors):
            self.model.armature = diagonal
            a = pin.aba(self.model, self.data, q, v, tau).copy()
            self.model.armature = np.zeros(self.dof)
            return a
        return np.linalg.solve(self.mass_matrix(q), tau - pin.nonLinearEffects(self.model, self.data, q, v))

    def regressor(self, q, v, a):
        y = pin.computeJointTorqueRegressor(self.model, self.data, q, v, a).copy()
        return np.hstack([y[:, 10 * k : 10 * k + 10] @ change for k, change in enumerate(self.changes)])


def bundled(name, parameters):
    robot = tomllib.loads((MODELS / name / "robot.toml").read_text())
    values = tomllib.loads((MODELS / name / parameters).read_text())
    assert robot.get("base", {}).get("roll_pitch_yaw_deg", [0, 0, 0]) == [0, 0, 0], "gravity is given in the base frame"
    joints = [{"kind": j["kind"], "convention": robot["convention"], **j["dh"]} for j in robot["joint"]]
    links = []
    for link in values["link"]:
        if "com_m" in link:
            m, c, i = link["mass_kg"], np.array(link["com_m"]), link["inertia_about_com_kg_m2"]
            steiner = m * (c @ c * np.eye(3) - np.outer(c, c))
            about = {k: i[k] + steiner["xyz".index(k[0]), "xyz".index(k[1])] for k in i}
            moment = m * c
        else:
            m, moment, about = link["mass_kg"], link["first_moment_kg_m"], link["inertia_kg_m2"]
        links.append([m, *moment, *(about[k] for k in ("xx", "xy", "xz", "yy", "yz", "zz"))])
    answer = {
        "name": name,
        "gravity_m_s2": robot["gravity_m_s2"],
        "joints": joints,
        "links": links,
        "rotors_kg_m2": [drive["rotor_kg_m2"] for drive in values["drive"]],
    }
    if "coupling" in robot:
        answer["coupling"] = robot["coupling"]["motor_from_joint"]
    return answer


def random_chain(index):
    """Mixed conventions and joints, right angles and vanishing lengths often, links of random boxes off centre."""
    rng = np.random.default_rng(1000 + index)
    dof = 2 + index % 7

    def short(x):
        return round(float(x), 5)

    joints, links = [], []
    for _ in range(dof):
        angle = lambda: float(rng.choice([0, 90, -90, 180, round(rng.uniform(-180, 180), 3)]))
        length = lambda: short(rng.uniform(-0.5, 0.5) * (rng.uniform() < 0.6))
        joints.append(
            {
                "kind": "prismatic" if rng.uniform() < 0.25 else "revolute",
                "convention": str(rng.choice(["standard", "modified"])),
                "offset_deg": angle(),
                "d_m": length(),
                "a_m": length(),
                "alpha_deg": angle(),
            }
        )
        m, c, half = rng.uniform(0.5, 8), rng.uniform(-0.2, 0.2, 3), rng.uniform(0.02, 0.3, 3)
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        i = m / 3 * axes @ np.diag(half @ half - half**2) @ axes.T + m * (c @ c * np.eye(3) - np.outer(c, c))
        links.append([short(x) for x in (m, *(m * c), i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2])])
    return {
        "name": f"chain-{index + 1}",
        "gravity_m_s2": [short(x) for x in rng.uniform(-10, 10, 3)],
        "joints": joints,
        "links": links,
        "rotors_kg_m2": [short(rng.uniform(0.01, 0.5)) for _ in range(dof)],
    }


def row(numbers):
    """Rounded to 1e-11 of the largest, a tenth of the tolerance of the comparison."""
    numbers = np.asarray(numbers).ravel()
    decimals = max(0, 11 - int(np.floor(np.log10(abs(numbers).max()))))
    return ",".join(f"{x:.{decimals}f}".rstrip("0").rstrip(".") for x in numbers)


def write(name, robots):
    """A line that names the robot, then one per state and quantity: what, state, numbers."""
    lines = []
    for index, (robot, states, deep, regressors) in enumerate(robots):
        arm, generator = Arm(robot), Generator(index + 1)
        lines.append(f"robot,{robot['name']}")
        for k in range(states):
            q, v, a = generator.state(arm.dof)
            tau = arm.torque(q, v, a)
            lines.append(f"torque,{k},{row(tau)}")
            if k < deep:
                # The acceleration that a random effort produces, not the one that was put in.
                effort = 5 * v
                lines.append(f"acceleration,{k},{row(arm.acceleration(q, v, effort))}")
                lines.append(f"mass-matrix,{k},{row(arm.mass_matrix(q)[np.tril_indices(arm.dof)])}")
            if k < regressors:
                y = arm.regressor(q, v, a)
                phi = np.concatenate(robot["links"])
                assert np.allclose(y @ phi + arm.rotors @ a, tau, rtol=0, atol=1e-11 * max(1, abs(tau).max()))
                lines.append(f"regressor,{k},{row(y)}")
    (HERE / name).write_text("\n".join(lines) + "\n")


def main():
    chains = [random_chain(index) for index in range(CHAINS)]
    (HERE / "chains.json").write_text("[\n" + ",\n".join(json.dumps(chain) for chain in chains) + "\n]\n")
    for name, parameters, states in BUNDLED:
        write(f"{name}.csv", [(bundled(name, parameters), states, DEEP, REGRESSORS)])
    write("chains.csv", [(c, STATES_PER_CHAIN, 1, int(i < CHAINS_WITH_REGRESSOR)) for i, c in enumerate(chains)])


if __name__ == "__main__":
    main()
