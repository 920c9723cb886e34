"""What the tests on the URDFs of others share: where the files are, the command, and Clarabel's bound on an export."""

import os
import subprocess
import sys
from pathlib import Path

import clarabel
import numpy as np
from scipy import sparse

ARMID = Path(os.environ["ARMID"]).resolve()
SHARE = "cmeel.prefix/share/example-robot-data/robots"
ROBOTS = next(path for path in (Path(entry) / SHARE for entry in sys.path) if path.is_dir())


def armid(*arguments):
    return subprocess.run([ARMID, *map(str, arguments)], capture_output=True, text=True)


def least_chi_squared(reduction, estimate, answer):
    """The least squared Mahalanobis distance of consistent parameters from an estimate: Clarabel's semidefinite program."""
    names = [p["name"] for p in reduction["parameters"]]
    k = np.zeros((len(reduction["base"]), len(names)))
    for row, base in enumerate(reduction["base"]):
        for term in base["terms"]:
            k[row, names.index(term["parameter"])] = term["coefficient"]
    beta = np.array([p["value"] for p in estimate["base"]])
    # Whitened, and each parameter in units of what was exported.
    whiten = np.linalg.inv(np.linalg.cholesky(np.array(estimate["covariance"])))
    values = {p["name"]: abs(p["value"]) for p in answer["parameters"]}
    size = np.array([max(values[name], 1e-3) for name in names])
    b, p = k.shape
    rows, right, cones = [np.hstack([whiten @ k * size, -np.eye(b)])], [whiten @ beta], [clarabel.ZeroConeT(b)]
    friction = [i for i, name in enumerate(names) if name.startswith(("Fv", "Fc", "Ia"))]
    if friction:
        rows.append(-np.eye(p + b)[friction])
        right.append(np.zeros(len(friction)))
        cones.append(clarabel.NonnegativeConeT(len(friction)))
    half = np.array([[-0.5, 0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, -0.5]])
    for link in range(1, 1 + sum(name.startswith("m") and name[1:].isdigit() for name in names)):
        at = {kind: names.index(f"{kind}{link}") for kind in
              ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"]}
        entries = {(3, 3): [(at["m"], 1)]}
        for i, axis in enumerate("xyz"):
            entries[i, 3] = [(at["mc" + axis], 1)]
            entries[i, i] = [(at[f"I{a}{a}"], half[i, j]) for j, a in enumerate("xyz")]
            for j in range(i):
                entries[j, i] = [(at["I" + "xyz"[j] + "xyz"[i]], -1)]
        block = np.zeros((10, p + b))
        for row, (i, j) in enumerate((i, j) for j in range(4) for i in range(j + 1)):
            for column, value in entries[i, j]:
                block[row, column] = -value * size[column] * (1 if i == j else np.sqrt(2))
        rows.append(block)
        right.append(np.zeros(10))
        cones.append(clarabel.PSDTriangleConeT(4))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    objective = sparse.csc_matrix(np.diag([0.0] * p + [1.0] * b))
    constraints = sparse.csc_matrix(np.vstack(rows))
    solution = clarabel.DefaultSolver(objective, np.zeros(p + b), constraints, np.concatenate(right), cones, settings).solve()
    return 2 * solution.obj_val
