# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
# ---

# %% [markdown]
# # Compare estimators, and add your own
#
# Which estimator withstands a log with wild values of torque? The log here is made from known parameters, so that errors are known too.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import ArrayLike, NDArray

import armid

Floats = NDArray[np.float64]

robot = armid.Robot.load("planar-2r")
truth = robot.nominal()

# %% [markdown]
# ## 1. A log with noise, and with wild values in one row of fifty

# %%
RATE = 200.0
design = robot.design("d-optimal", starts=1, evaluations=30, baseline=False)
t, q, qd, qdd = design.sample(RATE)
random = np.random.default_rng(1)
periods = 3
q, qd, qdd = (np.tile(values, (periods, 1)) for values in (q, qd, qdd))
t = np.arange(len(q)) / RATE
tau = robot.inverse_dynamics(q, qd, qdd, truth)
tau += random.normal(0.0, 0.05, tau.shape)
wild = random.random(tau.shape) < 0.02
tau[wild] += random.normal(0.0, 10.0, wild.sum())
folder = Path(tempfile.mkdtemp())
np.savetxt(folder / "log.csv", np.column_stack([t, q, tau]), delimiter=",", header="t,q1,q2,tau1,tau2", comments="", fmt="%.17g")

# %% [markdown]
# ## 2. An estimator of your own
# It gets the equations W β = y of all joints and returns β. This one gives less weight to large residuals, until the weights settle.


# %%
def least_absolute(W: Floats, y: Floats) -> ArrayLike:
    """The smallest sum of absolute residuals, by reweighted least squares."""
    beta = np.linalg.lstsq(W, y, rcond=None)[0]
    for _ in range(50):
        weight = 1.0 / np.sqrt(np.maximum(np.abs(y - W @ beta), 1e-4))
        beta = np.linalg.lstsq(weight[:, np.newaxis] * W, weight * y, rcond=None)[0]
    return beta


# %% [markdown]
# ## 3. All of them on one log
# `armid identify --list` says what each name is.

# %%
NAMES = ["ols", "wls", "irls-huber", "irls-tukey", "mm"]
estimates = robot.identify(folder / "log.csv", [*NAMES, least_absolute], period=None, onset_speed="stated")
estimates["irls-tukey"]

# %% [markdown]
# ## 4. Errors against what is known
# As torque: the error that the parameters cause on the same motion, RMS over joints.

# %%
exact = robot.inverse_dynamics(q, qd, qdd, truth)
errors = {name: float(np.sqrt(np.mean((one.predict(q, qd, qdd) - exact) ** 2))) for name, one in estimates.items()}
figure, ax = plt.subplots()
ax.barh(list(errors), list(errors.values()))
ax.set_xlabel("torque error (N·m)")
errors

# %% [markdown]
# ## 5. Estimates and intervals side by side

# %%
rows = {name: [f"{value:.4g} ± {std:.2g}" for value, std in zip(one.values, one.std)] for name, one in estimates.items()}
for k, parameter in enumerate(estimates["ols"].names):
    print(f"{parameter:6}", *(f"{name}: {row[k]:20}" for name, row in rows.items()))

# %% [markdown]
# Estimators that give large residuals less weight are better here by a factor. Yours is one of them.

# %%
assert max(errors[name] for name in ("irls-huber", "irls-tukey", "least_absolute")) < errors["ols"]
