# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
# ---

# %% [markdown]
# # Design, set-points as an array, and a robot that reports no torque
#
# You need a controller that takes positions at a constant rate. If it reports no torque, you need the gains of its servos.

# %%
import shlex
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import armid

Floats = NDArray[np.float64]

RATE = 250.0
robot = armid.Robot.load("planar-2r")

# %% [markdown]
# ## 1. A design inside all limits

# %%
design = robot.design("d-optimal", period=5.0, harmonics=3, starts=1, evaluations=30, confidence=None, baseline=False)
assert design.is_feasible
design

# %% [markdown]
# ## 2. Its set-points
# One row for each cycle of the controller. `design.to_csv` writes them for one in another language. The command `armid trajectory sample` adds
# the way from rest and back.

# %%
t, q_cmd, speed, acceleration = design.sample(RATE)
figure, axes = plt.subplots(3, sharex=True)
for ax, values, label in zip(axes, (q_cmd, speed, acceleration), ("rad", "rad/s", "rad/s²")):
    ax.plot(t, values)
    ax.set_ylabel(label)
axes[-1].set_xlabel("time (s)")

# %% [markdown]
# ## 3. The robot follows them
# Here it is simulated: a position servo, which holds each command until the next, moves an arm that is heavier than the model says. The
# controller records what it commanded, and what the encoders show.

# %%
KP, KD = np.array([900.0, 300.0]), np.array([45.0, 12.0])
truth = dict(zip(robot.parameters(), robot.nominal()))
for name in ("m2", "mcx2", "Izz2", "Fv1", "Fc2"):
    truth[name] *= 1.3


def followed(commands: Floats) -> Floats:
    """Positions at the times of the commands, rad, (N, n), by the method of Runge and Kutta."""
    step = 1.0 / RATE

    def slope(state: Floats, command: Floats) -> Floats:
        q, qd = np.split(state, 2)
        tau = KP * (command - q) - KD * qd
        return np.concatenate([qd, robot.forward_dynamics(q, qd, tau, truth)])

    state = np.concatenate([commands[0], speed[0]])
    reached = []
    for command in commands:
        reached.append(state[:2])
        k1 = slope(state, command)
        k2 = slope(state + 0.5 * step * k1, command)
        k3 = slope(state + 0.5 * step * k2, command)
        k4 = slope(state + step * k3, command)
        state = state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return np.array(reached)


commands = np.tile(q_cmd, (4, 1))
count = 2.0 * np.pi / 2**18
q = np.round(followed(commands) / count) * count

# %% [markdown]
# ## 4. Torque from commands and positions
# A servo that holds each command acts on average half a cycle late, which is the delay here.

# %%
log = armid.Log.from_arrays(q, q_cmd=commands, kp=KP, kd=KD, delay=0.5 / RATE, rate=RATE)
estimate = robot.identify(log, period=design.period)
estimate

# %% [markdown]
# ## 5. Is it right?
# The base parameters of the arm that was simulated, next to the estimate, in standard deviations.

# %%
base = robot.reduce()
known = base.K @ np.array([truth[name] for name in base.parameters])
deviations = (estimate.values - known[[base.names.index(name) for name in estimate.names]]) / estimate.std
dict(zip(estimate.names, deviations.round(1)))

# %% [markdown]
# ## 6. The same by the command

# %%
folder = Path(tempfile.mkdtemp())
table = np.column_stack([np.arange(len(q)) / RATE, q, commands])
np.savetxt(folder / "log.csv", table, delimiter=",", header="t,q1,q2,c1,c2", comments="", fmt="%.17g")
gains = f"kp={KP[0]:g}/{KP[1]:g} kd={KD[0]:g}/{KD[1]:g} delay_ms={500 / RATE:g}"
mapping = f"q=q[1-2], q_cmd=c[1-2] {gains}"
command = ["identify", "log.csv", "--robot", "planar-2r", "--rate", f"{RATE:g}", "--period", f"{design.period:g}", "--map", mapping]
print("armid", shlex.join(command))
