# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
# ---

# %% [markdown]
# # From a URDF and a log to a validated model
#
# You need the URDF of your arm, and a log of joint positions and torques. The arm here is made up, and its log is simulated. It has what
# logs have: uneven times, a gap, rows without values, and friction that the URDF does not state.

# %%
import tempfile
from pathlib import Path

import numpy as np

import armid

URDF = """<robot name="arm">
  <link name="table"/>
  <joint name="pan" type="revolute">
    <parent link="table"/><child link="column"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>
    <limit lower="-2.5" upper="2.5" effort="60" velocity="2.5"/><dynamics damping="1.5" friction="1.0"/>
  </joint>
  <link name="column"><inertial><origin xyz="0 0 0.1"/><mass value="4"/>
    <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.02"/></inertial></link>
  <joint name="lift" type="revolute">
    <parent link="column"/><child link="upper"/><origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="80" velocity="2"/><dynamics damping="2.0" friction="1.5"/>
  </joint>
  <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="3"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.06"/></inertial></link>
  <joint name="bend" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="40" velocity="3"/><dynamics damping="0.8" friction="0.6"/>
  </joint>
  <link name="fore"><inertial><origin xyz="0.15 0 0.02"/><mass value="1.5"/>
    <inertia ixx="0.004" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
</robot>"""

folder = Path(tempfile.mkdtemp())
(folder / "arm.urdf").write_text(URDF)
robot = armid.Robot.load(folder / "arm.urdf")
robot.joints

# %% [markdown]
# ## 1. A motion that shows the parameters
# The design stays inside the limits of the URDF, between samples too. `design.to_csv` writes it for your controller.

# %%
design = robot.design("d-optimal", starts=1, evaluations=30, confidence=None, baseline=False)
design

# %% [markdown]
# ## 2. Two logs
# The true arm is heavier than its URDF says and has more friction.

# %%
truth = dict(zip(robot.parameters(), robot.nominal()))
for name in ("m3", "mcx3", "Fv1", "Fc2"):
    truth[name] *= 1.4


def recorded(seed: int, motion: armid.Design) -> armid.Log:
    """A log of four periods at about 200 Hz."""
    random = np.random.default_rng(seed)
    t, q, qd, qdd = motion.sample(200)
    t = np.concatenate([t + period * motion.period for period in range(4)])
    q, qd, qdd = (np.tile(one, (4, 1)) for one in (q, qd, qdd))
    tau = robot.inverse_dynamics(q, qd, qdd, truth)
    tau += random.normal(0.0, 0.3, tau.shape)
    q = q + random.normal(0.0, 1e-5, q.shape)
    tau[1000:1003] = np.nan
    there = np.ones(len(t), dtype=bool)
    there[5000:5040] = False
    return armid.Log.from_arrays(q[there], tau[there], t=(t + random.uniform(0.0, 2e-4, t.shape))[there], name=f"log {seed}")


log, other = recorded(1, design), recorded(2, robot.design("condition", starts=1, evaluations=10, confidence=None, baseline=False))
log.remarks

# %% [markdown]
# ## 3. The estimate
# A fifth of the log is held out and only predicted. What you should know of the result comes as warnings.

# %%
estimate = robot.identify(log, period=None)
estimate

# %% [markdown]
# ## 4. Measured and predicted torque

# %%
estimate.plot()

# %% [markdown]
# ## 5. Validation on a motion that the fit has not seen

# %%
validation = estimate.validate(other)
validation

# %% [markdown]
# ## 6. The model for your tools
# The numbers go into a copy of your URDF. The MCAP holds the arm's description, poses, and measured and predicted torque, for a viewer such as Foxglove.

# %%
identified = estimate.export("urdf", folder / "identified.urdf", into=folder / "arm.urdf")
estimate.write_mcap(folder / "view.mcap")
page = estimate.report(folder / "report")
assert validation.passed and "upper" in identified and Path(page).is_file()
