"""Logs of makers' arms that move little, by Pinocchio: other bodies than the URDF says, a tool, rotors, offsets, Coulomb friction that sets
in softly, friction of the load, coarse encoders and noise. And what a file or an estimate predicts of them, by Pinocchio and MuJoCo."""

import json
import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np
import pinocchio as pin
from scipy.signal import butter, filtfilt

from semidefinite import Program, TEN, guess_of, regressor

# Robots of `example-robot-data`; fingers are held.
ARMS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", 6),
    "panda": ("panda_description/urdf/panda.urdf", 7),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", 7),
}
RATE, TIME, CUTOFF = 100, 30.0, 10.0
# Rotation that an encoder counts, rad; noise of a torque as a part of its RMS.
COUNT, NOISE = 2 * np.pi / 2**16, 0.02
# Part of a log that a fit may see; seconds at either end that the filter spoils.
SEEN, EDGE = 0.8, 0.5
# Weight of the guess in the semidefinite program.
WEIGHT = 1.0


def held(model, n):
    """A model with its first n joints alone."""
    return model if model.nv == n else pin.buildReducedModel(model, list(range(n + 1, model.njoints)), pin.neutral(model))


def along(model, q, v, a):
    data = model.createData()
    return np.array([pin.rnea(model, data, *state) for state in zip(q, v, a)])


def motion(model, rng):
    """Sums of four tones of each joint about a random pose, within a tenth of what its limits allow."""
    n, t = model.nv, np.arange(int(RATE * TIME)) / RATE
    low, high = (np.clip(limit, -2, 2) for limit in (model.lowerPositionLimit, model.upperPositionLimit))
    middle, half = (low + high) / 2 + 0.2 * rng.uniform(-1, 1, n) * (high - low) / 2, (high - low) / 2
    w, phase = 2 * np.pi * rng.uniform(0.05, 0.6, (4, n)), rng.uniform(0, 2 * np.pi, (4, n))
    a = np.minimum(0.05 * half, 0.2 * model.velocityLimit / w)
    wave = w[:, None] * t[None, :, None] + phase[:, None]
    q = middle + np.sum(a[:, None] * np.sin(wave), 0)
    return t, q, np.sum((a * w)[:, None] * np.cos(wave), 0), np.sum(-(a * w**2)[:, None] * np.sin(wave), 0)


def simulate(urdf, n, seed):
    """Times, positions as an encoder counts them and torques of an arm like that of a URDF."""
    rng = np.random.default_rng(seed)
    model = held(pin.buildModelFromUrdf(str(urdf)), n)
    for i in range(1, model.njoints):
        own, k = model.inertias[i], rng.uniform(0.7, 1.4)
        model.inertias[i] = pin.Inertia(k * own.mass, own.lever + rng.uniform(-0.015, 0.015, 3), k * own.inertia)
    # A tool that the URDF does not know.
    tool = pin.Inertia(0.1 * sum(i.mass for i in model.inertias) / n, np.array([0.02, 0.0, 0.05]), 1e-3 * np.eye(3))
    model.inertias[n] += tool
    t, q, v, a = motion(model, rng)
    of_links = along(model, q, v, a)
    size = np.sqrt(np.mean(of_links**2, axis=0)).clip(0.05 * np.abs(of_links).max())
    data = model.createData()
    mass = np.diag(pin.crba(model, data, q[0]))
    onset, rotor = rng.uniform(0.02, 0.08, n), mass * rng.uniform(0.3, 1.0, n)
    viscous, coulomb = size * rng.uniform(0.02, 0.15, n) / np.abs(v).max(0), size * rng.uniform(0.05, 0.25, n)
    offset, of_load = size * rng.uniform(-0.05, 0.05, n), rng.uniform(0.02, 0.08, n)
    sign = np.tanh(v / onset)
    tau = of_links + rotor * a + viscous * v + (coulomb + of_load * np.abs(of_links)) * sign + offset
    tau += NOISE * np.sqrt(np.mean(tau**2, axis=0)) * rng.standard_normal(tau.shape)
    return t, np.round(q / COUNT) * COUNT, tau


def write(path, t, q, tau):
    names = ["t", *(f"q{j + 1}" for j in range(q.shape[1])), *(f"tau{j + 1}" for j in range(q.shape[1]))]
    np.savetxt(path, np.column_stack([t, q, tau]), delimiter=",", header=",".join(names), comments="", fmt="%.9g")


class Scored:
    """A log below a low pass of fourth order, of which the first part may be fitted and the last is only predicted."""

    def __init__(self, urdf, n, t, q, tau, cutoff=CUTOFF):
        self.n, self.rate = n, 1 / np.median(np.diff(t))
        self.model = held(pin.buildModelFromUrdf(str(urdf)), n)
        even = np.arange(t[0], t[-1], 1 / self.rate)
        b, a = butter(4, cutoff / (self.rate / 2))
        q, tau = (filtfilt(b, a, np.column_stack([np.interp(even, t, one) for one in of.T]), axis=0) for of in (q, tau))
        v = np.gradient(q, 1 / self.rate, axis=0)
        inside = slice(round(EDGE * self.rate), -round(EDGE * self.rate))
        self.q, self.v, self.a, self.tau = (x[inside] for x in (q, v, np.gradient(v, 1 / self.rate, axis=0), tau))
        self.seen = round(SEEN * len(self.q))
        self.columns = regressor(self.model, self.q, self.v, self.a)

    def error(self, predicted):
        """|measured − predicted|/|measured| of what is only predicted."""
        measured = self.tau[self.seen:]
        return np.linalg.norm(measured - predicted[self.seen:]) / np.linalg.norm(measured)

    def least_squares(self):
        """Prediction by rotors, viscous and Coulomb friction and offsets, without regard to bodies."""
        offsets = np.broadcast_to(np.eye(self.n), (len(self.q), self.n, self.n))
        w = np.concatenate([self.columns, offsets], axis=2)
        a = w[:self.seen].reshape(-1, w.shape[2])
        scale = np.linalg.norm(a, axis=0) + 1e-12
        phi = np.linalg.lstsq(a / scale, self.tau[:self.seen].ravel(), rcond=1e-7)[0] / scale
        return w @ phi

    def program(self, columns):
        """Prediction by the semidefinite program with so many columns of each joint: 12 of a URDF, 13 of an MJCF."""
        w = self.columns[:, :, :columns * self.n]
        a, y = w[:self.seen].reshape(-1, w.shape[2]), self.tau[:self.seen].ravel()
        sigma = np.sqrt(np.mean((self.least_squares() - self.tau)[:self.seen]**2, axis=0))
        return w @ Program(a, y, guess_of(self.model), WEIGHT, sigma).solve()

    def masses(self, of_file):
        """Masses of links over those of the robot file."""
        return np.array(of_file) / [own.mass for own in self.model.inertias[1:]]

    def urdf(self, path):
        """Prediction by a URDF in Pinocchio, and the masses of its links over those of the robot file."""
        model = held(pin.buildModelFromUrdf(str(path)), self.n)
        model.gravity = self.model.gravity
        joints = {joint.get("name"): joint.find("dynamics") for joint in ElementTree.parse(path).getroot().findall("joint")}
        friction = lambda key: np.array([float(joints[name].get(key, 0)) for name in model.names[1:]])
        predicted = along(model, self.q, self.v, self.a) + friction("damping") * self.v + friction("friction") * np.sign(self.v)
        return predicted, self.masses([own.mass for own in model.inertias[1:]])

    def mjcf(self, path):
        """Prediction by an MJCF in MuJoCo, and the masses of its links over those of the robot file."""
        model = mujoco.MjModel.from_xml_path(str(path))
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        data, predicted = mujoco.MjData(model), []
        for state in zip(self.q, self.v, self.a):
            data.qpos[:self.n], data.qvel[:self.n], data.qacc[:self.n] = state
            mujoco.mj_inverse(model, data)
            predicted.append(data.qfrc_inverse[:self.n].copy())
        predicted = np.array(predicted) + model.dof_frictionloss[:self.n] * np.sign(self.v)
        return predicted, self.masses(model.body_mass[-self.n:])

    def estimate(self, path):
        """Prediction by the base parameters of an estimate of links, rotors, viscous and Coulomb friction, offsets and friction of the load."""
        answer = json.loads(path.read_text(encoding="utf-8"))
        beta = {parameter["name"]: parameter["value"] for parameter in answer["base"]}
        get = lambda name: np.array([beta.get(f"{name}{j + 1}", 0.0) for j in range(self.n)])
        onset = [speeds.get("coulomb_velocity_rad_s", 0.0) for speeds in answer.get("shape") or [{}] * self.n]
        links = self.columns[:, :, :10 * self.n] @ np.array([get(name) for name in TEN]).T.ravel()
        sign = np.where(np.array(onset) > 0, np.tanh(self.v / np.maximum(onset, 1e-9)), np.sign(self.v))
        rest = get("Ia") * self.a + get("Fv") * self.v + (get("Fc") + get("Fl") * np.abs(links)) * sign + get("Fo")
        known = {f"{name}{j + 1}" for name in [*TEN, "Ia", "Fv", "Fc", "Fl", "Fo"] for j in range(self.n)}
        assert set(beta) <= known, set(beta) - known
        return links + rest
