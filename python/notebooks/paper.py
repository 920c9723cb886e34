# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
# ---

# %% [markdown]
# # Condition number or D-optimality? The paper in ten cells
#
# Radkhah, Kulić and Croft (IROS 2007) identified a CRS A460 from optimised motions. They found that a small condition number gives better
# parameters than a large determinant of the information. This notebook repeats their steps on the simulated arm.

# %%
import tempfile

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import armid

Floats = NDArray[np.float64]

robot = armid.Robot.load("crs-a460")
robot

# %% [markdown]
# ## 1. Which parameters does torque reveal?
# Sixty parameters of the links become 36 combinations; rotors and friction add their own.

# %%
ranks = {columns: robot.reduce(columns).rank for columns in ("rigid", "rigid+rotor", "rigid+rotor+friction")}
ranks

# %% [markdown]
# ## 2. The motion of the paper's Table I

# %%
t, q, qd, qdd = robot.sample("table-one", 100)
figure, axes = plt.subplots()
axes.plot(t, np.degrees(q), label=robot.joints)
axes.set(xlabel="time (s)", ylabel="position (deg)")
axes.legend()

# %% [markdown]
# ## 3. What the motion shows: the condition number of its equations

# %%
base = robot.reduce("rigid")
kept = [base.parameters.index(name) for name in base.names]


def condition(q: Floats, qd: Floats, qdd: Floats) -> float:
    """Condition number of the stacked base regressor."""
    return float(np.linalg.cond(robot.regressor(q, qd, qdd, "rigid")[:, :, kept].reshape(-1, base.rank)))


condition(q, qd, qdd)

# %% [markdown]
# ## 4. Two designs inside the limits of the arm
# More starts and evaluations give better designs. Both get the same few here.

# %%
designs = {
    criterion: robot.design(criterion, columns="rigid", starts=1, evaluations=15, clearance=None, baseline=False)
    for criterion in ("condition", "d-optimal")
}
{name: condition(*design.sample(100)[1:]) for name, design in designs.items()}

# %% [markdown]
# ## 5. An experiment with each

# %%
logs = {name: robot.simulate(design, periods=2, seed=7) for name, design in designs.items()}
logs

# %% [markdown]
# ## 6. An estimate from each

# %%
estimates = {name: robot.identify(log) for name, log in logs.items()}
estimates["d-optimal"]

# %% [markdown]
# ## 7. Which predicts the torque of the other's motion better?

# %%
errors = {
    name: estimates[name].validate(logs[other]).shares
    for name, other in (("condition", "d-optimal"), ("d-optimal", "condition"))
}
errors

# %% [markdown]
# ## 8. Measured and predicted torque

# %%
estimates["d-optimal"].plot()

# %% [markdown]
# ## 9. The answer
# One pair of designs decides nothing. `armid.study("01-criteria", "out")` makes 33 designs, performs 1,000 experiments and scores each
# estimate against the truth. Its page says how sure the answer is.

# %%
with tempfile.TemporaryDirectory() as folder:
    page = estimates["condition"].report(folder)
assert all((shares < 0.2).all() for shares in errors.values())
