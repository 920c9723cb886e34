"""One Monte Carlo run of experiments/01-criteria as a Python program would do it, on MuJoCo, NumPy and Pinocchio.

MuJoCo's `rollout` simulates six periods at 1 kHz by its Euler step: the arm with rotors, viscous friction and friction loss under
position and velocity feedback with the torque of inverse dynamics fed forward. The last five periods get noise and the resolution of
encoders and converters. Processing, regressor, ordinary and weighted least squares of 58 base parameters with standard deviations,
and the prediction of 20 fresh motions are those of the study. What the runs of one design share (motions, commands, the regressor of
the fresh motions) is made once and not timed.
"""

import mujoco
import mujoco.rollout
import numpy as np
import pinocchio as pin
from arm import BODY, build, columns_of, placements

PERIOD, RATE, PERIODS, HARMONICS, KEPT = 10.0, 1000, 5, 5, 500
SAMPLES = int(PERIOD * RATE)
# The rotors that the links do not hide.
ROTORS = [2, 3, 4, 5]
# Viscous friction, Coulomb friction and bias of six joints, and the rotors.
DRIVES = np.tile([2.0, 3.0, 0.1, 0.5], 6)[:22]
# Feedback, N·m/rad and N·m·s/rad.
GAINS = np.array([[3000.0], [300.0]])


def motion(draw, samples):
    """q, q̇, q̈ of a Fourier series over one period, samples × 6 each."""
    omega = 2 * np.pi / PERIOD
    angle = 2 * np.pi * np.arange(samples) / samples
    q, v, a = (np.zeros((samples, 6)) for _ in range(3))
    for l in range(1, HARMONICS + 1):
        s, c, w = np.sin(l * angle)[:, None], np.cos(l * angle)[:, None], omega * l
        x, y = draw.uniform(-0.5, 0.5, (2, 6))
        q += s * x / w - c * y / w
        v += c * x + s * y
        a += w * (c * y - s * x)
    return q, v, a


def drives(v, a):
    """Columns of rotors and friction, samples × 6 × 22."""
    out = np.zeros((len(v), 6, 22))
    for i in range(6):
        out[:, i, i], out[:, i, 6 + i], out[:, i, 12 + i] = v[:, i], np.tanh(v[:, i] / 0.01), 1.0
    for column, i in enumerate(ROTORS):
        out[:, i, 18 + column] = a[:, i]
    return out


def simulator():
    """The same arm in MuJoCo; torque is its control."""
    spec, inertia = mujoco.MjSpec(), pin.Inertia.FromDynamicParameters(np.array(BODY))
    spec.option.timestep, body = 1 / RATE, spec.worldbody
    about = inertia.inertia
    for i, step in enumerate(placements()[:-1]):
        quaternion = pin.Quaternion(step.rotation)
        body = body.add_body(pos=step.translation, quat=[quaternion.w, quaternion.x, quaternion.y, quaternion.z])
        body.mass, body.ipos, body.explicitinertial = inertia.mass, inertia.lever, True
        body.fullinertia = [about[0, 0], about[1, 1], about[2, 2], about[0, 1], about[0, 2], about[1, 2]]
        rotor = DRIVES[18 + ROTORS.index(i)] if i in ROTORS else 0.0
        joint = body.add_joint(name=f"joint{i + 1}", armature=rotor, damping=DRIVES[i], frictionloss=DRIVES[6 + i])
        position, velocity, torque = (spec.add_actuator(target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT) for _ in range(3))
        position.set_to_position(kp=GAINS[0, 0])
        velocity.set_to_velocity(kv=GAINS[1, 0])
        torque.set_to_motor()
    return spec.compile()


class Pipeline:
    def __init__(self, base):
        self.model, self.data, change = build()
        for joint in range(1, 7):
            self.model.inertias[joint] = pin.Inertia.FromDynamicParameters(np.array(BODY))
        self.data = self.model.createData()
        self.columns = columns_of(change, base)
        draw = np.random.default_rng(1)
        self.motion = motion(draw, SAMPLES)
        self.arm = simulator()
        self.arm_data = mujoco.MjData(self.arm)
        # Position, velocity and torque of each joint, for all periods; the friction loss of MuJoCo has no bias.
        forward = self.torque(*self.motion)
        command = np.stack([*self.motion[:2], forward - DRIVES[12:18]], axis=2).reshape(SAMPLES, 18)
        self.command = np.tile(command, (1 + PERIODS, 1))
        fresh = [np.vstack(part) for part in zip(*(motion(draw, 100) for _ in range(20)))]
        self.fresh, self.exact = self.regressor(*fresh), self.torque(*fresh)

    def torque(self, q, v, a):
        return np.array([pin.rnea(self.model, self.data, *state) for state in zip(q, v, a)]) + drives(v, a) @ DRIVES

    def regressor(self, q, v, a):
        stack = np.empty((6 * len(q), 60))
        for k in range(len(q)):
            stack[6 * k : 6 * k + 6] = pin.computeJointTorqueRegressor(self.model, self.data, q[k], v[k], a[k])
        return np.hstack([stack @ self.columns, drives(v, a).reshape(6 * len(q), -1)])

    def recording(self, draw):
        q, v, _ = self.motion
        start = np.concatenate([[0.0], q[0], v[0]])
        states, _ = mujoco.rollout.rollout(self.arm, self.arm_data, start, self.command)
        # The state at each command, from the one before on; what feedback and feed-forward gave then.
        states = np.vstack([start, states[0, :-1]])
        command = self.command.reshape(-1, 6, 3)
        off = [command[:, :, order] - states[:, 1 + 6 * order : 7 + 6 * order] for order in (0, 1)]
        torque = GAINS[0] * off[0] + GAINS[1] * off[1] + command[:, :, 2] + DRIVES[12:18]
        position = np.round(states[SAMPLES:, 1:7] / 1.6e-5) * 1.6e-5
        effort = torque[SAMPLES:] + draw.normal(size=(PERIODS * SAMPLES, 6)) * 0.3
        return position, np.round(effort / 0.07) * 0.07

    def processed(self, position, effort):
        """Means over periods, the scatter of one sample of torque, and states by Fourier derivatives at 500 instants."""
        position, effort = position.reshape(PERIODS, SAMPLES, 6), effort.reshape(PERIODS, SAMPLES, 6)
        mean = effort.mean(axis=0)
        off = (effort - mean).reshape(-1, 6)
        covariance = off.T @ off / ((PERIODS - 1) * SAMPLES * PERIODS)
        lines = np.fft.rfft(position.mean(axis=0), axis=0) / SAMPLES
        lines[101:] = 0
        omega = 2j * np.pi / PERIOD * np.arange(len(lines))[:, None]
        state = [np.fft.irfft((omega**order * lines)[: KEPT // 2 + 1], n=KEPT, axis=0) * KEPT for order in range(3)]
        spectrum = np.fft.rfft(mean, axis=0)[: KEPT // 2 + 1] / SAMPLES
        spectrum[101:] = 0
        return state, np.fft.irfft(spectrum, n=KEPT, axis=0) * KEPT, covariance

    def run(self, seed):
        (q, v, a), torque, covariance = self.processed(*self.recording(np.random.default_rng(seed)))
        w, y = self.regressor(q, v, a), torque.reshape(-1)
        b = w.shape[1]
        root = np.linalg.inv(np.linalg.cholesky(covariance))
        white_w, white_y = (root @ w.reshape(-1, 6, b)).reshape(-1, b), (root @ torque.T).T.reshape(-1)
        estimates = []
        for w, y in [(w, y), (white_w, white_y)]:
            ortho, r = np.linalg.qr(w)
            inverse = np.linalg.inv(r)
            beta = inverse @ (ortho.T @ y)
            residual = (y - w @ beta).reshape(-1, 6)
            spread = residual.T @ residual / len(residual)
            mixed = (spread @ w.reshape(-1, 6, b)).reshape(-1, b)
            std = np.sqrt(np.diag(inverse @ inverse.T @ (w.T @ mixed) @ (inverse @ inverse.T)))
            error = (self.fresh @ beta).reshape(-1, 6) - self.exact
            estimates.append((beta, std, np.sqrt((error**2).mean(axis=0))))
        return estimates
