#!/usr/bin/env python3
"""armid design against SciPy SLSQP with Pinocchio's regressor, on the same problem and from the same starts.

CRS A460, period 10 s, 5 harmonics, 36 rigid base parameters in standard-DH frames, condition number of W_b on N = 100
samples, position, velocity and acceleration limits (12.566 rad/s² on every joint), no torque, 150 iterations each.

The peer is what such pipelines are: Pinocchio's compiled joint-torque regressor, one call per sample, forward
differences for the gradient, SciPy's SLSQP with the limits as linear constraints on the samples and their exact
Jacobian. What Python can do cheaply is done cheaply: positions, velocities and accelerations of all samples by one
matrix product, eigenvalues of the 36 × 36 Gram matrix in place of an SVD of the stack, one BLAS thread.

Times are processor times of one thread each, the peer's without its imports and set-up, armid's with everything from
the start of its process to its end, so that other work on the machine does not count.
"""

import argparse
import json
import os
import platform
import resource
import subprocess
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import pinocchio as pin
import scipy
from arm import build, columns_of
from scipy.optimize import minimize

PERIOD, HARMONICS, SAMPLES, ACCELERATION = 10.0, 5, 100, 12.566
POSITION = np.radians([175, 90, 110, 180, 105, 180])
VELOCITY = np.radians([180, 180, 180, 171, 173, 171])


class Problem:
    """Variables: a_1, b_1, …, a_5, b_5, q0 of each joint in turn, each over a size of its own."""

    def __init__(self, base, samples):
        self.model, self.data, change = build()
        self.map = columns_of(change, base)
        omega = 2 * np.pi / PERIOD
        theta = 2 * np.pi * np.arange(samples) / samples
        block = np.zeros((3, samples, 2 * HARMONICS + 1))
        for l in range(1, HARMONICS + 1):
            s, c, w = np.sin(l * theta), np.cos(l * theta), omega * l
            block[0, :, 2 * l - 2], block[0, :, 2 * l - 1] = s / w, -c / w
            block[1, :, 2 * l - 2], block[1, :, 2 * l - 1] = c, s
            block[2, :, 2 * l - 2], block[2, :, 2 * l - 1] = -w * s, w * c
        block[0, :, -1] = 1.0
        self.block = block.reshape(3 * samples, -1)
        size = np.minimum(VELOCITY, ACCELERATION / omega)
        self.scale = np.array([[v] * (2 * HARMONICS) + [p] for v, p in zip(size, POSITION)])
        self.samples = samples
        self.stack = np.empty((6 * samples, 60))
        rows, bounds = [], []
        for j in range(6):
            own = np.zeros((3 * samples, 66))
            own[:, 11 * j : 11 * j + 11] = self.block * self.scale[j]
            limit = np.repeat([POSITION[j], VELOCITY[j], ACCELERATION], samples)
            rows += [own / limit[:, None], -own / limit[:, None]]
            bounds += [np.ones(6 * samples)]
        self.rows, self.bounds = np.vstack(rows), np.concatenate(bounds)
        self.evaluations = 0

    def states(self, x):
        motion = self.block @ (x.reshape(6, -1) * self.scale).T
        return motion.reshape(3, self.samples, 6)

    def condition(self, x):
        self.evaluations += 1
        q, v, a = self.states(x)
        regress, model, data, stack = pin.computeJointTorqueRegressor, self.model, self.data, self.stack
        for k in range(self.samples):
            stack[6 * k : 6 * k + 6] = regress(model, data, q[k], v[k], a[k])
        w = stack @ self.map
        values = np.linalg.eigvalsh(w.T @ w)
        return float(np.sqrt(values[-1] / max(values[0], 1e-300)))

    def excess(self, x):
        return float((self.rows @ x - self.bounds).max())


def variables(problem, trajectory):
    x = np.zeros((6, 11))
    for j, joint in enumerate(trajectory["joint"]):
        x[j, 0:10:2], x[j, 1:10:2], x[j, 10] = joint["a"], joint["b"], joint["q0"]
    return (x / problem.scale).ravel()


def run_armid(binary, seed, iterations, folder):
    """The answer, and the processor time of the whole process, s."""
    command = [binary, "design", "crs-a460", "--criterion", "condition", "--columns", "rigid", "--margin", "0", "--period", str(PERIOD),
               "--harmonics", str(HARMONICS), "--max-acceleration", str(ACCELERATION), "--ignore-torque",
               "--ignore-clearance", "--no-ramps", "--starts", "1", "--seed", str(seed), "--iterations", str(iterations),
               "--evaluations", "4000", "--no-baseline", "--json", "-o", str(Path(folder) / "T.toml")]
    environment = dict(os.environ, RAYON_NUM_THREADS="1")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return answer, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run_peer(problem, x0, iterations):
    problem.evaluations = 0
    began = time.process_time()
    constraint = {"type": "ineq", "fun": lambda x: problem.bounds - problem.rows @ x, "jac": lambda x: -problem.rows}
    # The logarithm, as armid minimises it: SLSQP converges faster on it than on the number itself.
    found = minimize(lambda x: np.log(problem.condition(x)), x0, method="SLSQP", constraints=[constraint],
                     options={"maxiter": iterations, "ftol": 1e-9})
    seconds, evaluations = time.process_time() - began, problem.evaluations
    return {"value": problem.condition(found.x), "seconds": seconds, "iterations": int(found.nit), "evaluations": evaluations,
             "excess": problem.excess(found.x), "message": found.message}


def compare(armid, seeds, iterations, folder):
    """Both sides in turn from the first guess of each seed."""
    reduced = json.loads(subprocess.run([armid, "reduce", "crs-a460", "--columns", "rigid", "--json"], check=True,
                                        capture_output=True, text=True).stdout)
    base = [entry["name"] for entry in reduced["base"]]
    problem, fine = Problem(base, SAMPLES), Problem(base, 5000)
    rows = []
    print(f"{'seed':>4} {'':>6} {'value':>8} {'seconds':>9} {'iterations':>10} {'evaluations':>11} {'excess':>9}")
    for seed in seeds:
        # No iteration: the first guess itself, from which both begin.
        first, _ = run_armid(armid, seed, 0, folder)
        ours, seconds = run_armid(armid, seed, iterations, folder)
        # The same problem: both sides must agree on what our design is worth, on 5000 samples.
        check = fine.condition(variables(fine, ours["trajectory"]))
        assert abs(check / ours["condition"] - 1) < 1e-8, (check, ours["condition"])
        start = variables(problem, first["trajectory"])
        peer = run_peer(problem, start, iterations)
        # Evaluations cost the same each, so time is shared out by their number.
        further, more = ours, seconds
        if ours["value"] > peer["value"]:
            further, more = run_armid(armid, seed, 4000, folder)
        reached = next((p["evaluations"] for p in further["history"] if p["value"] <= peer["value"]), None)
        to_same = None if reached is None else more * reached / further["evaluations"]
        row = {"seed": seed, "start_condition": problem.condition(start),
               "armid": {"seconds": seconds} | {key: ours[key] for key in ("value", "condition", "iterations", "evaluations", "worst_limit_use")},
               "peer": peer, "ratio_iterations": peer["seconds"] / seconds,
               "armid_seconds_to_peer_value": to_same,
               "ratio_same_value": None if to_same is None else peer["seconds"] / to_same}
        rows.append(row)
        used = max(ours["worst_limit_use"][key] for key in ("position", "velocity", "acceleration"))
        print(f"{seed:>4} {'armid':>6} {ours['value']:8.2f} {seconds:9.4f} {ours['iterations']:>10} {ours['evaluations']:>11} {used - 1:9.1e}")
        print(f"{'':>4} {'SLSQP':>6} {peer['value']:8.2f} {peer['seconds']:9.4f} {peer['iterations']:>10} {peer['evaluations']:>11} {peer['excess']:9.1e}")
        same = "-" if to_same is None else f"{row['ratio_same_value']:.0f}"
        print(f"{'':>4} time of the peer over armid's: {row['ratio_iterations']:.0f} for {iterations} iterations, {same} to the peer's value")
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--armid", default="target/release/armid", help="the binary")
    parser.add_argument("--iterations", type=int, default=150)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("-o", "--output", default=str(Path(__file__).parent / "results.json"))
    arguments = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        rows = compare(arguments.armid, arguments.seeds, arguments.iterations, folder)
    result = {"problem": {"robot": "crs-a460", "period_s": PERIOD, "harmonics": HARMONICS, "samples": SAMPLES,
                          "acceleration_rad_s2": ACCELERATION, "base_parameters": 36, "iterations": arguments.iterations},
              "versions": {"python": platform.python_version(), "numpy": np.__version__, "scipy": scipy.__version__,
                           "pinocchio": pin.__version__},
              "machine": {"system": platform.system(), "architecture": platform.machine(), "threads": 1, "time": "processor time, s"},
              "runs": rows,
              "least_ratio_iterations": min(row["ratio_iterations"] for row in rows),
              "least_ratio_same_value": min((row["ratio_same_value"] or 0.0) for row in rows)}
    Path(arguments.output).write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
