# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
# ---

# %% [markdown]
# # A study of your own, with a plot of your own
#
# Is an optimised motion better than a random one, and for which estimator? One experiment decides nothing. A study makes several designs,
# performs several experiments with each on simulated arms, and scores each estimate against the truth.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import armid

# %% [markdown]
# ## 1. The plan

# %%
PLAN = """
name = "small"
question = "Is an optimised motion better than a random one?"
robot = "planar-2r"
seed = 3
runs = 4

[experiment]
period_s = 4.0
harmonics = 4
rate_hz = 500.0
periods = 3
discarded_periods = 1

[identification]
columns = "rigid+rotor+friction"
derivatives = "fourier"
samples_per_period = 200
estimators = ["ols", "wls"]

[validation]
trajectories = 4
samples = 50

[reference]
mass_kg = 0.1
first_moment_kg_m = 0.02
inertia_kg_m2 = 0.01
viscous_nm_s_rad = 0.1
torque_nm = 0.1

[[design]]
name = "optimised"
making = "optimised"
criterion = "d-optimal"
starts = 3
evaluations = 40

[[design]]
name = "random"
making = "random"
criterion = "d-optimal"
starts = 3
evaluations = 1
"""
folder = Path(tempfile.mkdtemp())
(folder / "study.toml").write_text(PLAN)

# %% [markdown]
# ## 2. The study
# Ctrl-C keeps what is finished, and `resume=True` continues it. The folder holds a page with tables and figures.

# %%
study = armid.study(folder / "study.toml", folder / "results")
study.report().is_file()

# %% [markdown]
# ## 3. Its rows
# One for each run and estimator, as a table of Arrow, for pandas and polars too.

# %%
runs = study.rows()
runs.column_names

# %% [markdown]
# ## 4. A plot of your own
# Each dot is the torque error of one estimate on motions that the fit has not seen. Left is better.

# %%
family, estimator, error = (np.array(runs[name].to_pylist()) for name in ("family", "estimator", "prediction_rmse_nm"))
groups = {f"{a}, {b}": 1e3 * error[(family == a) & (estimator == b)] for a in ("random", "optimised") for b in ("ols", "wls")}
figure, ax = plt.subplots()
for height, (name, values) in enumerate(groups.items()):
    ax.plot(values, np.full(len(values), height), "o", alpha=0.5)
    ax.plot(np.exp(np.mean(np.log(values))), height, "k|", markersize=20)
ax.set_yticks(range(len(groups)), list(groups))
ax.set(xlabel="torque error (mN·m)", xscale="log")

# %% [markdown]
# ## 5. How sure is that?
# Runs of one design share its motion, so designs are what counts. The study's own comparison has an interval and a p-value. With three
# designs of each kind it is wide.

# %%
means = {name: float(np.exp(np.mean(np.log(values)))) for name, values in groups.items()}
assert all(len(values) == 12 for values in groups.values())
means
