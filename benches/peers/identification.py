#!/usr/bin/env python3
"""armid's identification against NumPy with Pinocchio's regressor, on the same samples.

CRS A460, 10,000 random samples, torque with noise of a different size on each joint, the 36 rigid base parameters: from states
to ordinary and weighted least squares with standard deviations. The weights are the covariance of the ordinary residual.

The peer: one call of Pinocchio's compiled regressor per sample, one matrix product onto the base columns, NumPy's QR and
matrix products, one BLAS thread; and the same with normal equations, by Cholesky, in place of the QR. The noise is taken for white, which asks less than armid does: it measures the lags as well.
Sides take turns; the fastest of each counts. Both must find the same parameters.
"""

import argparse
import json
import os
import subprocess
import tempfile
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
import pinocchio as pin
from arm import build, columns_of

SAMPLES = 10_000


def draw(model, data, change):
    rng = np.random.default_rng(1)
    q, v, a = (rng.uniform(-s, s, (SAMPLES, 6)) for s in (3.0, 2.0, 5.0))
    phi = np.tile([5.0, 0.1, -0.2, 0.3, 0.4, 0.01, -0.02, 0.5, 0.03, 0.3], 6)
    noise = rng.normal(size=(SAMPLES, 6)) * [2.0, 1.5, 1.0, 0.3, 0.2, 0.1]
    tau = np.array([pin.computeJointTorqueRegressor(model, data, *s) @ (change @ phi) for s in zip(q, v, a)])
    return q, v, a, tau + noise


def by_qr(w, y):
    ortho, r = np.linalg.qr(w)
    inverse = np.linalg.inv(r)
    return inverse @ (ortho.T @ y), inverse @ inverse.T


def by_normal_equations(w, y):
    root = np.linalg.inv(np.linalg.cholesky(w.T @ w))
    inverse = root.T @ root
    return inverse @ (w.T @ y), inverse


def identify(model, data, columns, q, v, a, tau, fit=by_qr):
    began = time.perf_counter()
    stack = np.empty((6 * SAMPLES, 60))
    for k in range(SAMPLES):
        stack[6 * k : 6 * k + 6] = pin.computeJointTorqueRegressor(model, data, q[k], v[k], a[k])
    w = stack @ columns
    stacked = time.perf_counter() - began
    y = tau.reshape(-1)
    b, left = w.shape[1], 1 - w.shape[1] / w.shape[0]

    def spread(beta):
        r = (y - w @ beta).reshape(-1, 6)
        return r.T @ r / SAMPLES / left

    ols, inverse = fit(w, y)
    sigma = spread(ols)
    mixed = (sigma @ w.reshape(-1, 6, b)).reshape(-1, b)
    ols_std = np.sqrt(np.diag(inverse @ (w.T @ mixed) @ inverse))
    root = np.linalg.inv(np.linalg.cholesky(sigma))
    white_w, white_y = (root @ w.reshape(-1, 6, b)).reshape(-1, b), (root @ tau.T).T.reshape(-1)
    wls, inverse = fit(white_w, white_y)
    sigma = root @ spread(wls) @ root.T
    mixed = (sigma @ white_w.reshape(-1, 6, b)).reshape(-1, b)
    wls_std = np.sqrt(np.diag(inverse @ (white_w.T @ mixed) @ inverse))
    return time.perf_counter() - began, stacked, {"ols": (ols, ols_std), "wls": (wls, wls_std)}


def agree(found, expected):
    """Both sides must have found the same."""
    for name, (beta, std) in expected.items():
        size = np.abs(std)
        assert np.all(np.abs(np.array(found[name]["beta"]) - beta) < 1e-6 * size), f"{name}: other parameters"
        # armid measures lags too: a few per cent where chance makes one seem to count.
        worst = np.max(np.abs(np.array(found[name]["std"]) / std - 1))
        print(f"{name}: standard deviations within {worst:.1e} of the peer's")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bench", help="the binary that `cargo bench --bench identification --no-run` names")
    parser.add_argument("--turns", type=int, default=5)
    arguments = parser.parse_args()
    model, data, change = build()
    states = draw(model, data, change)
    with tempfile.NamedTemporaryFile(suffix=".f64") as file:
        np.hstack(states).astype("<f8").tofile(file.name)
        own, own_stack, peer, peer_stack, normal = [], [], [], [], []
        for _ in range(arguments.turns):
            run = subprocess.run([arguments.bench, "--states", file.name], capture_output=True, text=True, check=True)
            found = json.loads(run.stdout)
            columns = columns_of(change, found["names"])
            seconds, stacked, expected = identify(model, data, columns, *states)
            own.append(found["seconds"])
            own_stack.append(found["stack_seconds"])
            peer.append(seconds)
            normal.append(identify(model, data, columns, *states, fit=by_normal_equations)[0])
            peer_stack.append(stacked)
    agree(found, expected)
    print(f"states to OLS and WLS with intervals: armid {1e3 * min(own):.1f} ms, NumPy + Pinocchio {1e3 * min(peer):.1f} ms, "
          f"ratio {min(own) / min(peer):.3f}; with normal equations {1e3 * min(normal):.1f} ms, ratio {min(own) / min(normal):.3f}")
    print(f"stacked base columns: armid {1e9 * min(own_stack) / SAMPLES:.0f} ns a sample, "
          f"Pinocchio from Python {1e9 * min(peer_stack) / SAMPLES:.0f} ns")


if __name__ == "__main__":
    main()
