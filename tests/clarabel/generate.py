"""The least chi squared over consistent sets, as a semidefinite program solved by Clarabel: optima.csv.

Arguments: the armid command, the file to write.
"""

import json
import subprocess
import sys

import clarabel
import numpy as np
import scipy.sparse as sp

ROBOTS = ["planar-2r", "crs-a460", "puma-560", "staubli-tx40"]
LEVELS = [1e-3, 3e-2, 0.3]
HORIZON = 1e3
NOT_NEGATIVE = ("Ia", "Fv", "Fc")


class Generator:
    """The generator of numbers that the Rust test has."""

    def __init__(self, seed):
        self.x = seed

    def uniform(self, low, high):
        self.x = (self.x * 6364136223846793005 + 1442695040888963407) % 2**64
        return low + (high - low) * ((self.x >> 11) / 2**53)


def pseudo_inertia(ten):
    m, x, y, z, xx, xy, xz, yy, yz, zz = ten
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    p = np.zeros((4, 4))
    p[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    p[:3, 3] = p[3, :3] = [x, y, z]
    p[3, 3] = m
    return p


def ten_of(p):
    inertia = np.trace(p[:3, :3]) * np.eye(3) - p[:3, :3]
    i, j = [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]
    return np.concatenate([[p[3, 3]], p[:3, 3], inertia[i, j]])


def body(draw):
    """A body of some kilograms within some decimetres."""
    mass = draw.uniform(1, 5)
    centre = np.array([draw.uniform(-0.1, 0.1) for _ in range(3)])
    spread = np.diag([draw.uniform(0.002, 0.02) for _ in range(3)])
    p = np.zeros((4, 4))
    p[:3, :3] = mass * (spread + np.outer(centre, centre))
    p[:3, 3] = p[3, :3] = mass * centre
    p[3, 3] = mass
    return ten_of(p)


def problem(armid, robot, run):
    """Names, K, guess, estimate and the root of its covariance."""
    answer = subprocess.run(
        [armid, "reduce", robot, "--columns", "rigid+rotor+friction", "--json"], capture_output=True, check=True
    )
    answer = json.loads(answer.stdout)
    names = [parameter["name"] for parameter in answer["parameters"]]
    k = np.zeros((answer["rank"], len(names)))
    for row, base in enumerate(answer["base"]):
        for term in base["terms"]:
            k[row, names.index(term["parameter"])] = term["coefficient"]
    draw = Generator(1000 * ROBOTS.index(robot) + run + 1)
    guess, truth = np.zeros(len(names)), np.zeros(len(names))
    for at, name in enumerate(names):
        if name[0] == "m" and name[1].isdigit():
            guess[at : at + 10] = body(draw)
            truth[at : at + 10] = draw.uniform(0.7, 1.4) * guess[at : at + 10]
        elif name[0] == "F" or name.startswith("Ia"):
            guess[at] = draw.uniform(0.1, 2)
            truth[at] = draw.uniform(0.7, 1.4) * guess[at]
    exact = k @ truth
    deviation = LEVELS[run % 3] * (np.abs(exact) + 0.05)
    shared = np.array([draw.uniform(-1, 1) for _ in exact])
    covariance = np.outer(deviation, deviation) * (np.eye(len(exact)) + 0.3 * np.outer(shared, shared))
    estimate = exact + deviation * np.array([draw.uniform(-2.5, 2.5) for _ in exact])
    # An estimate that no arm has.
    for row, base in enumerate(answer["base"]):
        if base["name"].startswith(("Fv1", "Fc2")):
            estimate[row] = -3 * deviation[row]
    return names, k, guess, estimate, covariance


def least(names, k, guess, estimate, covariance):
    """Primal and dual value of the semidefinite program, in units of the guess."""
    b, p = k.shape
    whitening = np.linalg.inv(np.linalg.cholesky(covariance))
    places = [(i, j) for j in range(4) for i in range(j + 1)]
    units, horizon, signs, cones = np.zeros((p, p)), np.zeros((1, p + b)), [], []
    quadratic = []
    count = 0
    for at, name in enumerate(names):
        if name[0] == "m" and name[1].isdigit():
            root = np.linalg.cholesky(pseudo_inertia(guess[at : at + 10]))
            rows = np.zeros((10, p + b))
            for q, (i, j) in enumerate(places):
                x = np.zeros((4, 4))
                x[i, j] = x[j, i] = 1
                units[at : at + 10, at + q] = ten_of(root @ x @ root.T)
                rows[q, at + q] = -1 if i == j else -np.sqrt(2)
                horizon[0, at + q] = float(i == j)
            cones.append(rows)
            count += 4
        elif name.startswith(NOT_NEGATIVE):
            units[at, at] = guess[at]
            horizon[0, at] = 1
            signs.append(-np.eye(p + b)[at])
            count += 1
        elif name[0] == "F":
            units[at, at] = 1
            quadratic.append(at)
    data = np.hstack([whitening @ k @ units, -np.eye(b)])
    # The offsets' part of S is quadratic and far below H: it is left out, and shown to be small.
    rows = np.vstack([data, np.array(signs), horizon / (HORIZON * count), *cones])
    right = np.concatenate([whitening @ estimate, np.zeros(len(signs)), [1.0], np.zeros(10 * len(cones))])
    kinds = [clarabel.ZeroConeT(b), clarabel.NonnegativeConeT(len(signs) + 1)]
    kinds += [clarabel.PSDTriangleConeT(4)] * len(cones)
    hessian = sp.block_diag([sp.csc_matrix((p, p)), sp.eye(b)], format="csc")
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = 1e-11
    settings.tol_feas = 1e-10
    solver = clarabel.DefaultSolver(hessian, np.zeros(p + b), sp.csc_matrix(rows), right, kinds, settings)
    solution = solver.solve()
    x = np.array(solution.x)
    used = horizon[0] @ x / (HORIZON * count)
    offsets = 0.5 * np.sum((x[quadratic] - guess[quadratic]) ** 2) / (HORIZON * count)
    return str(solution.status), 2 * solution.obj_val, 2 * solution.obj_val_dual, used, offsets


def main():
    armid, path = sys.argv[1:]
    with open(path, "w") as out:
        out.write("robot,run,primal,dual\n")
        for robot in ROBOTS:
            for run in range(3):
                status, primal, dual, used, offsets = least(*problem(armid, robot, run))
                print(robot, run, status, primal, dual, f"S/H {used:.2g}, of offsets {offsets:.1e}")
                out.write(f"{robot},{run},{primal:.12e},{dual:.12e}\n")


main()
