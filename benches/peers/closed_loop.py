"""Direct and inverse dynamic identification (DIDIM) of a six-axis arm as a Python program does it, on NumPy and Pinocchio.

A motor PID at 1 kHz, placed as armid places it, follows a motion of five harmonics from rest: 13 s to get there and 10 s that are compared,
23,000 steps, as many as armid simulates for a recording of one period. The plant is integrated by RK4 under held torque, a step divided
where Coulomb friction is stiff; friction and rotors are in it. Measured torque is such a simulation with other parameters, and the
program must find these: 36 rigid base parameters, 18 of friction, 4 rotors. Each Gauss-Newton step simulates once, stacks Pinocchio's regressor along the 10,000 samples, takes
means over 40 and solves by NumPy. Forward dynamics are Pinocchio's compiled articulated bodies, a call for each evaluation; or, for the
time of an evaluation alone, NumPy's: one Newton-Euler recursion for bias and the columns of the mass matrix together, and a linear solution.
"""

import time

import numpy as np
import pinocchio as pin
from arm import BODY, build, columns_of
from pipeline import ROTORS, drives

DT, RUN_IN, RECORDED, BLOCK = 1e-3, 13_000, 10_000, 40
BANDWIDTH, DAMPING, INTEGRAL = 2 * np.pi * 8.0, 0.8, 2 * np.pi * 0.5
# Nominal viscous and Coulomb friction and offset of each joint, and rotors of those that have a column.
DRIVES = np.repeat([2.0, 3.0, 0.1, 0.5], [6, 6, 6, 4])
SMOOTH = 0.01
# Largest λh of a part of a step.
STIFFNESS = 1.2
AT_REST = 1e-9


def reference(rng):
    """The command at every step, from rest: a finite Fourier series that grows in over three seconds."""
    t = DT * np.arange(RUN_IN + RECORDED)
    w = 2 * np.pi * np.arange(1, 6)[:, None] / (DT * RECORDED)
    a, b = rng.uniform(-0.15, 0.15, (2, 6, 5))
    grown = np.clip(t / 3.0, 0.0, 1.0)
    return ((a @ np.sin(w * t) + b @ np.cos(w * t)) * grown**3 * (10 - 15 * grown + 6 * grown**2)).T


class Arm:
    """The arm with parameters that differ from the nominal ones by `change` (58)."""

    def __init__(self, base, change):
        self.model, _, frames = build()
        self.columns = columns_of(frames, base)
        ten = np.tile(BODY, 6) + self.columns @ change[:36]
        for joint in range(6):
            self.model.inertias[joint + 1] = pin.Inertia.FromDynamicParameters(ten[10 * joint : 10 * joint + 10])
        own = DRIVES + change[36:]
        self.viscous, self.coulomb, self.offset = own[:6], own[6:12], own[12:18]
        armature = np.zeros(6)
        armature[ROTORS] = own[18:]
        self.model.armature = armature
        self.data = self.model.createData()
        self.ten, self.armature = ten.reshape(6, 10), armature
        self.inertia = pin.crba(self.model, self.data, np.zeros(6)).diagonal().copy()
        self.evaluations = 0

    def friction(self, v):
        return self.viscous * v + self.coulomb * np.tanh(v / SMOOTH) + self.offset

    def accelerate(self, q, v, tau):
        self.evaluations += 1
        return pin.aba(self.model, self.data, q, v, tau - self.friction(v))

    def parts(self, v, a):
        """Into how many parts a step is divided: one but near standstill."""
        slow = np.maximum(np.abs(v) - 1.5 * DT * np.abs(a), 0.0)
        rate = np.sum(self.coulomb / SMOOTH / np.cosh(np.minimum(slow / SMOOTH, 20.0)) ** 2 / self.inertia)
        return int(np.clip(np.ceil(rate * DT / STIFFNESS), 1, 64))

    def step(self, q, v, tau):
        a = self.accelerate(q, v, tau)
        parts = self.parts(v, a)
        h = DT / parts
        for part in range(parts):
            if part:
                a = self.accelerate(q, v, tau)
            v2 = v + 0.5 * h * a
            a2 = self.accelerate(q + 0.5 * h * v, v2, tau)
            v3 = v + 0.5 * h * a2
            a3 = self.accelerate(q + 0.5 * h * v2, v3, tau)
            v4 = v + h * a3
            a4 = self.accelerate(q + h * v3, v4, tau)
            q = q + h / 6 * (v + 2 * (v2 + v3) + v4)
            v = v + h / 6 * (a + 2 * (a2 + a3) + a4)
        return q, v


def cross(x, y):
    return x[:, [1, 2, 0]] * y[:, [2, 0, 1]] - x[:, [2, 0, 1]] * y[:, [1, 2, 0]]


class NumpyArm(Arm):
    """The same with forward dynamics in NumPy."""

    def __init__(self, base, change):
        super().__init__(base, change)
        self.placed = [(m.rotation, m.translation[None, :]) for m in list(self.model.jointPlacements)[1:]]
        self.mass, self.moment = self.ten[:, 0], self.ten[:, None, 1:4]
        xx, xy, yy, xz, yz, zz = self.ten[:, 4:].T
        self.about = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(6, 3, 3)

    def accelerate(self, q, v, tau):
        w, dw, a = np.zeros((3, 7, 3))
        # Row 0 is the bias with gravity, row j + 1 a unit of acceleration of joint j.
        a[0, 2] = 9.81
        speed, turned, kept = np.zeros((7, 3)), np.zeros((7, 3)), []
        for i, (rotation, p) in enumerate(self.placed):
            c, s = np.cos(q[i]), np.sin(q[i])
            r = rotation @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            a = (a + cross(dw, p) + cross(w, cross(w, p))) @ r
            w, dw = w @ r, dw @ r
            speed[0, 2] = v[i]
            turned[:] = 0.0
            turned[i + 1, 2] = 1.0
            dw = dw + cross(w, speed) + turned
            w = w + speed
            moment, inertia = self.moment[i], self.about[i]
            force = self.mass[i] * a + cross(dw, moment) + cross(w, cross(w, moment))
            kept.append((r, force, dw @ inertia + cross(w, w @ inertia) + cross(moment, a)))
        torque, force, couple = np.zeros((7, 6)), 0.0, 0.0
        for i in reversed(range(6)):
            r, own_force, own_couple = kept[i]
            force, couple = own_force + force, own_couple + couple
            torque[:, i] = couple[:, 2]
            force, couple = force @ r.T, couple @ r.T
            couple = couple + cross(self.placed[i][1], force)
        mass = torque[1:] + np.diag(self.armature)
        return np.linalg.solve(mass, tau - self.friction(v) - torque[0])


def simulate(arm, command, load, steps):
    """Positions, speeds, accelerations and torque at the last samples of `steps` steps from rest, as armid's closed loop gives them."""
    kp, kd = load * BANDWIDTH**2, 2 * DAMPING * BANDWIDTH * load
    ki, smoothing = kp * INTEGRAL, 1 - np.exp(-10 * BANDWIDTH * DT)
    q, v, integral, rate, last, before = command[0].copy(), np.zeros(6), np.zeros(6), np.zeros(6), None, None
    kept = []
    for k in range(steps):
        error = command[k] - q
        rate = rate + smoothing * ((0.0 if last is None else (error - last) / DT) - rate)
        last = error
        tau = kp * error + kd * rate + integral
        integral = integral + ki * error * DT
        if k >= RUN_IN:
            between = 0.5 * (before + tau)
            kept.append((q, v, arm.accelerate(q, v, between), between))
        before = tau
        q, v = arm.step(q, v, tau)
    return [np.array(table) for table in zip(*kept)]


def means(x):
    return x.reshape(-1, BLOCK, *x.shape[1:]).mean(axis=1)


def regressor(arm, q, v, a):
    """Along a motion, means over blocks: rows × 58."""
    stack = np.empty((len(q), 6, 60))
    for k in range(len(q)):
        stack[k] = pin.computeJointTorqueRegressor(arm.model, arm.data, q[k], v[k], a[k])
    return np.concatenate([means(stack) @ arm.columns, means(drives(v, a))], axis=2).reshape(-1, 58)


class Didim:
    """What is measured and known before the clock runs."""

    def __init__(self, base):
        rng = np.random.default_rng(5)
        self.base, self.command = base, reference(rng)
        nominal = Arm(base, np.zeros(58))
        self.load = pin.crba(nominal.model, nominal.data, np.full(6, 0.5)).diagonal().copy()
        self.truth = np.concatenate([rng.uniform(-0.02, 0.02, 36), 0.1 * DRIVES * rng.uniform(-1, 1, 22)])
        *_, torque = simulate(Arm(base, self.truth), self.command, self.load, len(self.command))
        self.measured = means(torque).reshape(-1)

    def run(self):
        """Simulations until the search rests, evaluations of forward dynamics in them, and processor time."""
        began, change, evaluations = time.process_time(), np.zeros(58), 0
        for simulations in range(1, 41):
            arm = Arm(self.base, change)
            q, v, a, torque = simulate(arm, self.command, self.load, len(self.command))
            evaluations += arm.evaluations
            w = regressor(arm, q, v, a)
            move = np.linalg.lstsq(w, self.measured - means(torque).reshape(-1), rcond=None)[0]
            if np.linalg.norm(w @ move) <= AT_REST * np.linalg.norm(self.measured):
                break
            change = change + move
        seconds = time.process_time() - began
        # Found: torque of the difference, over that which was measured.
        off = np.linalg.norm(w @ (change - self.truth)) / np.linalg.norm(self.measured)
        assert off < 1e-6, f"torque of the parameters off by {off:.1e}"
        return simulations, evaluations, seconds

    def numpy_evaluation(self, evaluations=500):
        """Processor time of forward dynamics in NumPy, s; they must be Pinocchio's."""
        arm, other = NumpyArm(self.base, self.truth), Arm(self.base, self.truth)
        states = np.random.default_rng(6).uniform(-1, 1, (evaluations, 3, 6)) * [[1.0], [2.0], [20.0]]
        for state in states[:5]:
            a, b = arm.accelerate(*state), other.accelerate(*state)
            assert np.allclose(a, b, rtol=1e-9, atol=1e-9 * np.abs(b).max()), (a, b)
        began = time.process_time()
        for state in states:
            arm.accelerate(*state)
        return (time.process_time() - began) / evaluations
