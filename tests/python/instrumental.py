#!/usr/bin/env python3
"""Instrumental variables in NumPy: the numbers that estimation/src/estimation/tests/instrumental.rs holds.

One hinge without weight, 60 instants: inertia, viscous and Coulomb friction, offset. The regressor W is that of a motion with
errors, the instruments Z are that of another one without. beta = (Z'W)^-1 Z'y, its standard deviations for white noise of a known
size, and the Durbin-Wu-Hausman statistic by its augmented regression.
"""

import numpy as np

k = np.arange(60.0)
t = 0.05 * k
speed = np.cos(1.1 * t) + 0.5 * np.sin(2.3 * t)
acceleration = -1.1 * np.sin(1.1 * t) + 1.15 * np.cos(2.3 * t)


def columns(speed, acceleration):
    return np.column_stack([acceleration, speed, np.tanh(speed / 0.01), np.ones_like(speed)])


w = columns(speed + 0.002 * np.sin(17 * k), acceleration + 0.02 * np.cos(13 * k))
z = columns(0.98 * speed, 0.97 * acceleration)
y = columns(speed, acceleration) @ [2.0, 0.5, 0.3, 0.1] + 0.02 * np.sin(29 * k)
inverse = np.linalg.inv(z.T @ w)
beta = inverse @ (z.T @ y)
std = 0.03 * np.sqrt(np.diag(inverse @ (z.T @ z) @ inverse.T))


def squares(x):
    return np.sum((y - x @ np.linalg.lstsq(x, y, rcond=None)[0]) ** 2)


# The offset is its own instrument: nothing of its column is left. Of friction's there is where the sign is another.
rest = (w - z @ np.linalg.lstsq(z, w, rcond=None)[0])[:, :3]
both = squares(np.column_stack([w, rest]))
statistic = (squares(w) - both) / (both / (60 - 4 - 3))
np.set_printoptions(precision=17)
print("beta", beta.tolist())
print("std", std.tolist())
print("Durbin-Wu-Hausman", statistic, "of", np.linalg.matrix_rank(np.column_stack([w, z])) - 4)
