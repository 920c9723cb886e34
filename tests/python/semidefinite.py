"""The model that a URDF or an MJCF can hold, by a semidefinite program: CVXPY and Clarabel on Pinocchio's regressor. The objective is written
here once more, from docs/export.md and the module `model_fit`."""

import cvxpy
import numpy as np
import pinocchio as pin

# Order of the ten in Pinocchio.
TEN = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"]
# Least eigenvalue of a body relative to its guess, and how little a coefficient is held that the robot file does not state.
FLOOR, WIDE = 1e-3, 1e-2


def regressor(model, q, v, a, onset=None):
    """Columns of the links, of viscous and Coulomb friction and of the rotors: samples × joints × parameters. `onset` is the speed in which
    Coulomb friction of each joint sets in; without it friction has a plain sign."""
    n, data = model.nv, model.createData()
    w = np.zeros((len(q), n, 13 * n))
    sign = np.sign(v) if onset is None else np.tanh(v / onset)
    for k in range(len(q)):
        w[k, :, :10 * n] = pin.computeJointTorqueRegressor(model, data, q[k], v[k], a[k])
    for j in range(n):
        w[:, j, 10 * n + j], w[:, j, 11 * n + j], w[:, j, 12 * n + j] = v[:, j], sign[:, j], a[:, j]
    return w


def guess_of(model):
    """The tens of a model's links."""
    return [model.inertias[i + 1].toDynamicParameters() for i in range(model.nv)]


def pseudo_basis():
    basis = []
    for x in np.eye(10):
        inertia = np.array([[x[4], x[5], x[7]], [x[5], x[6], x[8]], [x[7], x[8], x[9]]])
        p = np.zeros((4, 4))
        p[:3, :3], p[:3, 3], p[3, :3], p[3, 3] = np.trace(inertia) / 2 * np.eye(3) - inertia, x[1:4], x[1:4], x[0]
        basis.append(p)
    return np.array(basis)


BASIS = pseudo_basis()


class Program:
    """min ½ Σ residual²/σ² + w D(φ), in units in which each guess is the unit matrix. `w` is rows × parameters, the rows in the order of the
    joints at each sample; σ (joints) weighs them."""

    def __init__(self, w, y, guess, weight, sigma):
        n = self.joints = len(guess)
        scale = np.tile(1 / sigma, w.shape[0] // n)
        self.units = [np.sqrt(np.sum(y[w[:, c] != 0]**2)) / np.linalg.norm(w[:, c]) for c in range(10 * n, w.shape[1])]
        self.q, self.r = np.linalg.qr(w * scale[:, None])
        self.z = self.q.T @ (y * scale)
        self.rest = np.sum((y * scale)**2) - np.sum(self.z**2)
        self.weight = weight
        self.roots = [np.linalg.cholesky(np.tensordot(ten, BASIS, 1)) for ten in guess]
        self.masses = [ten[0] for ten in guess]
        # The last link may carry a tool.
        self.bounds = [(0.1, 10.0)] * (n - 1) + [(0.01, 100.0)]

    def value(self, phi):
        """At parameters, zero distance at the guess."""
        total = 0.5 * (np.sum((self.r @ phi - self.z)**2) + self.rest)
        for i, (root, mass, (low, high)) in enumerate(zip(self.roots, self.masses, self.bounds)):
            p = np.tensordot(phi[10 * i:10 * i + 10], BASIS, 1)
            inverse = np.linalg.inv(root)
            s, ratio = inverse @ p @ inverse.T - FLOOR * np.eye(4), phi[10 * i] / mass
            self.assert_inside(s, ratio, low, high)
            c = 1 / (1 - low) - 1 / (high - 1)
            own = np.trace(s) / (1 - FLOOR) - np.linalg.slogdet(s)[1] - np.log(ratio - low) - np.log(high - ratio) + c * ratio
            at_guess = 4 - 4 * np.log(1 - FLOOR) - np.log(1 - low) - np.log(high - 1) + c
            total += self.weight * (own - at_guess)
        z = phi[10 * self.joints:] / self.units
        return total + self.weight * WIDE * np.sum(z - np.log(z) - 1)

    @staticmethod
    def assert_inside(s, ratio, low, high):
        assert np.linalg.eigvalsh(s)[0] > 0 and low < ratio < high, (np.linalg.eigvalsh(s), ratio)

    def solve(self):
        """The optimum by Clarabel."""
        pieces, cost = [], 0
        for root, mass, (low, high) in zip(self.roots, self.masses, self.bounds):
            x = cvxpy.Variable((4, 4), symmetric=True)
            p = root @ x @ root.T
            i = cvxpy.trace(p[:3, :3]) * np.eye(3) - p[:3, :3]
            pieces += [p[3, 3], p[0, 3], p[1, 3], p[2, 3], i[0, 0], i[0, 1], i[1, 1], i[0, 2], i[1, 2], i[2, 2]]
            s, ratio = x - FLOOR * np.eye(4), p[3, 3] / mass
            c = 1 / (1 - low) - 1 / (high - 1)
            cost += cvxpy.trace(s) / (1 - FLOOR) - cvxpy.log_det(s) - cvxpy.log(ratio - low) - cvxpy.log(high - ratio) + c * ratio
        z = cvxpy.Variable(len(self.units), pos=True)
        cost += WIDE * cvxpy.sum(z - cvxpy.log(z))
        phi = cvxpy.hstack([*pieces, *[z[k] * unit for k, unit in enumerate(self.units)]])
        data = 0.5 * cvxpy.sum_squares(self.r @ phi - self.z)
        cvxpy.Problem(cvxpy.Minimize(data + self.weight * cost)).solve(solver=cvxpy.CLARABEL)
        return phi.value
