"""One Monte Carlo run of experiments/01-criteria as a Python program would do it, on NumPy and Pinocchio.

It simulates nothing: the torque of one period is inverse dynamics of the trajectory itself, with friction and rotors, repeated for
five periods with noise and the resolution of encoders and converters. Processing, regressor, ordinary and weighted least
squares of 58 base parameters with standard deviations, and the prediction of 20 fresh motions are those of the study; what the runs
of one design share (motions, their Fourier matrices, the regressor of the fresh motions) is made once and not timed.
"""

import numpy as np
import pinocchio as pin
from arm import BODY, build, columns_of

PERIOD, RATE, PERIODS, HARMONICS, KEPT = 10.0, 1000, 5, 5, 500
SAMPLES = int(PERIOD * RATE)
# The rotors that the links do not hide.
ROTORS = [2, 3, 4, 5]


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


class Pipeline:
    def __init__(self, base):
        self.model, self.data, change = build()
        for joint in range(1, 7):
            self.model.inertias[joint] = pin.Inertia.FromDynamicParameters(np.array(BODY))
        self.data = self.model.createData()
        self.columns = columns_of(change, base)
        draw = np.random.default_rng(1)
        self.motion = motion(draw, SAMPLES)
        self.friction = drives(*self.motion[1:]) @ np.tile([2.0, 3.0, 0.1, 0.5], 6)[:22]
        fresh = [np.vstack(part) for part in zip(*(motion(draw, 100) for _ in range(20)))]
        self.fresh = self.regressor(*fresh)
        self.exact = np.array([pin.rnea(self.model, self.data, *state) for state in zip(*fresh)]) + (
            drives(*fresh[1:]) @ np.tile([2.0, 3.0, 0.1, 0.5], 6)[:22])

    def regressor(self, q, v, a):
        stack = np.empty((6 * len(q), 60))
        for k in range(len(q)):
            stack[6 * k : 6 * k + 6] = pin.computeJointTorqueRegressor(self.model, self.data, q[k], v[k], a[k])
        return np.hstack([stack @ self.columns, drives(v, a).reshape(6 * len(q), -1)])

    def recording(self, draw):
        q, v, a = self.motion
        torque = np.array([pin.rnea(self.model, self.data, *state) for state in zip(q, v, a)]) + self.friction
        position = np.round(np.tile(q, (PERIODS, 1)) / 1.6e-5) * 1.6e-5
        effort = np.tile(torque, (PERIODS, 1)) + draw.normal(size=(PERIODS * SAMPLES, 6)) * 0.3
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
