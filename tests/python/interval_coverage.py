"""How often stated 95 % intervals cover the true parameters of arms that Pinocchio simulates, with effects that the model omits.

    ARMID=target/debug/armid python tests/python/interval_coverage.py [--arms ur10 xarm7 z1] [--effects …] [--levels 0 1 2]
        [--noise 0.005 0.01 0.02] [--logs periodic plain] [--runs 8]

Each run draws a motion, noise and one factor of each drive. The arm without the effect does the same motion with the same noise, and the
difference of both estimates is the bias. A parameter is *moved* where bias is at least as large as noise, by the RMS over runs. *Width* is
the half width over 1.96 RMS errors, median. A *finding* is a run that reports an effect or a lack of fit. Runs whose intervals are withheld
are counted last, and are in no coverage. No line of armid's simulator runs.
"""

import argparse
import concurrent.futures
import itertools
import json
import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin

from makers_arms import ROBOTS, armid

ARMS = {
    "ur10": "ur_description/urdf/ur10_robot.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "z1": "z1_description/urdf/z1.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
}
# Share of the load; RMS of the wind-up in rad; s; share of Coulomb friction.
EFFECTS = {
    "load-friction": [0.002, 0.01, 0.05],
    "elasticity": [2e-4, 7e-4, 2.8e-3],
    "lag": [2e-4, 5e-4, 2e-3],
    "hysteresis": [0.05, 0.1, 0.2],
}
RATE, PERIOD, PERIODS, PLAIN_S, COUNT, FINE, PRESLIDING = 200, 10.0, 5, 40.0, 1e-4, 4, 0.02
TEN = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"]
DRIVE = ["Ia", "Fv", "Fc", "Fo"]
FOUND = {"effect-shown", "lack-of-fit", "residual-above-noise", "residual-correlated"}


class Arm:
    """A chain with drives that its URDF does not state."""

    def __init__(self, name):
        self.path = ROBOTS / ARMS[name]
        self.model = model = pin.buildModelFromUrdf(str(self.path))
        self.n, self.data = model.nv, model.createData()
        rng = np.random.default_rng(7)
        q, v, a = self.motion(rng, True)[1:]
        rms = np.maximum(np.sqrt(np.mean(self.links(q[::20], v[::20], a[::20])**2, axis=0)), 0.5)
        inertia = pin.crba(model, self.data, q[0]).diagonal()
        self.rotor = 0.5 * inertia * rng.uniform(0.5, 1.5, self.n)
        self.viscous = 0.1 * rms / np.abs(v).max(0) * rng.uniform(0.5, 1.5, self.n)
        self.coulomb = 0.1 * rms * rng.uniform(0.5, 1.5, self.n)

    def motion(self, rng, periodic):
        """Times and states at several times the rate: sums of tones, from rest and back where there is no period."""
        n, model = self.n, self.model
        end = PERIOD if periodic else PLAIN_S
        t = np.arange(round(end * RATE * FINE)) / (RATE * FINE)
        low, high = np.maximum(model.lowerPositionLimit, -3), np.minimum(model.upperPositionLimit, 3)
        w = 2 * np.pi / PERIOD * np.arange(1, 6) if periodic else 2 * np.pi * rng.uniform(0.05, 0.5, 5)
        size = rng.uniform(-1, 1, (n, 5)) / np.arange(1, 6)
        phase = rng.uniform(0, 2 * np.pi, (n, 5))
        turned = w[None, :, None] * t + phase[:, :, None]
        x = [(size[:, :, None] * part).sum(1) for part in (np.sin(turned), w[None, :, None] * np.cos(turned), -w[None, :, None]**2 * np.sin(turned))]
        if not periodic:
            s = np.minimum(np.minimum(t, end - t) / 2.0, 1.0)
            # Smooth to the fourth derivative, since springs are wound by accelerations.
            ramp = np.polynomial.Polynomial([0, 0, 0, 0, 0, 126, -420, 540, -315, 70])
            turn = np.where(t < end / 2, 0.5, -0.5)
            f = [ramp(s), ramp.deriv()(s) * turn, ramp.deriv(2)(s) * turn**2]
            x = [f[0] * x[0], f[1] * x[0] + f[0] * x[1], f[2] * x[0] + 2 * f[1] * x[1] + f[0] * x[2]]
        half = 0.4 * (high - low)
        factor = np.minimum(half / np.abs(x[0]).max(1), 0.6 * np.minimum(model.velocityLimit, 3.0) / np.abs(x[1]).max(1))
        q = 0.5 * (low + high) + (factor[:, None] * x[0]).T
        return t, q, (factor[:, None] * x[1]).T, (factor[:, None] * x[2]).T

    def links(self, q, v, a):
        return np.array([pin.rnea(self.model, self.data, *state) for state in zip(q, v, a)])

    def log(self, path, seed, periodic, noise, effect=None, level=0.0):
        """Writes one log; the motors' motion is what encoders show."""
        rng = np.random.default_rng(seed)
        t, q, v, a = self.motion(rng, periodic)
        factor = np.exp(rng.uniform(-np.log(2), np.log(2), self.n))
        load = self.links(q, v, a)
        if effect == "elasticity":
            # Links do the motion; what they take winds the springs in front of them.
            soft = level * factor / np.sqrt(np.mean(load**2, axis=0))
            wound = soft * load
            around = 3 if periodic else 0
            wrapped = lambda x: np.vstack([x[len(x) - around:], x, x[:around]])
            rate = lambda x: np.gradient(wrapped(x), 1 / (RATE * FINE), axis=0)[around:len(x) + around]
            first = rate(wound)
            q, v, a = q + wound, v + first, a + rate(first)
        friction = self.viscous * v + self.coulomb * np.sign(v)
        if effect == "load-friction":
            friction = friction + level * factor * np.abs(load) * np.sign(v)
        if effect == "hysteresis":
            z, state = np.zeros_like(q), np.zeros(self.n)
            for k in itertools.chain(range(len(t)) if periodic else [], range(len(t))):
                s = np.sign(v[k])
                state = s + (state - s) * np.exp(-np.abs(q[k] - q[k - 1] if k or periodic else 0 * s) / PRESLIDING)
                z[k] = state
            friction = friction + level * factor * self.coulomb * z
        torque = load + self.rotor * a + friction
        if effect == "lag":
            # What is reported acts later, by linear interpolation.
            at = np.arange(len(t)) + level * RATE * FINE
            low = np.floor(at).astype(int)
            share = (at - low)[:, None]
            pick = (lambda k: torque[k % len(t)]) if periodic else (lambda k: torque[np.minimum(k, len(t) - 1)])
            torque = (1 - share) * pick(low) + share * pick(low + 1)
        q, torque = q[::FINE], torque[::FINE]
        repeats = PERIODS if periodic else 1
        q, torque = np.tile(q, (repeats, 1)), np.tile(torque, (repeats, 1))
        q = q + COUNT * rng.uniform(-0.5, 0.5, q.shape)
        std = noise * np.sqrt(np.mean((load + self.rotor * a)**2, axis=0))
        torque = torque + std * rng.standard_normal(torque.shape)
        rows = np.column_stack([np.arange(len(q)) / RATE, np.round(q / COUNT) * COUNT, torque])
        joints = range(1, self.n + 1)
        header = ",".join(["t", *(f"q{i}" for i in joints), *(f"tau{i}" for i in joints)])
        np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.7g")

    def known(self, names):
        """Values of base parameters, each with what torque shows only together with it."""
        n, rng, rows = self.n, np.random.default_rng(0), []
        for _ in range(40):
            q, v, a = rng.uniform(-2, 2, (3, n))
            drives = np.hstack([np.diag(a), np.diag(v), np.diag(np.sign(v)), np.eye(n)])
            rows.append(np.hstack([pin.computeJointTorqueRegressor(self.model, self.data, q, v, a), drives]))
        w = np.vstack(rows)
        order = [f"{kind}{i + 1}" for i in range(n) for kind in TEN] + [f"{kind}{i + 1}" for kind in DRIVE for i in range(n)]
        grouped = np.linalg.lstsq(w[:, [order.index(name) for name in names]], w, rcond=None)[0]
        bodies = np.concatenate([body.toDynamicParameters() for body in self.model.inertias[1:]])
        return grouped @ np.concatenate([bodies, self.rotor, self.viscous, self.coulomb, np.zeros(n)])


def identified(arm, folder, seed, periodic, noise, effect=None, level=0.0):
    """Names, values, half widths and kinds of findings of one run."""
    path = folder / f"{seed}-{periodic}-{noise}-{effect}-{level}.csv"
    arm.log(path, seed, periodic, noise, effect, level)
    period = ["--period", PERIOD] if periodic else []
    done = armid("identify", path, "--robot", arm.path, "--held-out", "none", "--json", *period)
    path.unlink()
    if done.returncode not in (0, 1):
        raise SystemExit(done.stderr)
    found = json.loads(done.stdout)
    base = found["base"]
    # Withheld intervals are null.
    half = [0.5 * (high - low) if low is not None else np.inf for low, high in (one["ci95"] for one in base)]
    return [one["name"] for one in base], np.array([one["value"] for one in base]), np.array(half), found


def kinds(found):
    return {finding["kind"] for finding in found["findings"]}


def cell(arm, folder, pool, runs, periodic, noise, effect, level, plain_runs):
    """Prints one line."""
    work = [pool.submit(identified, arm, folder, seed, periodic, noise, effect, level) for seed in range(runs)]
    done = [one.result() for one in work]
    names = done[0][0]
    truth = arm.known(names)
    errors, half = np.array([one[1] for one in done]) - truth, np.array([one[2] for one in done])
    clean = plain_runs if plain_runs is not None else errors
    noise_rms, bias = np.sqrt(np.mean(clean**2, 0)), np.sqrt(np.mean((errors - clean)**2, 0))
    rms = np.sqrt(np.mean(errors**2, 0))
    stated = np.isfinite(half).all(1)
    covered, width = np.abs(errors[stated]) <= half[stated], half[stated] / (1.96 * rms)
    inertial = np.array([name[:2] not in ("Fv", "Fc", "Fo") for name in names])
    moved = bias > noise_rms
    share = lambda of: f"{100 * covered[:, of].mean():5.1f}" if of.any() and stated.any() else "    –"
    everything = np.ones_like(moved)
    # Without moved ones, width is of all.
    wide = [np.median(width[:, of]) if of.any() and stated.any() else np.nan for of in (everything, moved)]
    shown = sum(bool(kinds(one[3]) & FOUND) for one in done)
    print(f"{'periodic' if periodic else 'plain':8} {noise:6} {effect or 'none':14} {level:7} | {share(everything)} {share(inertial)} "
          f"{share(~inertial)} | {moved.sum():3}/{len(names)} {share(moved)} | {wide[0]:5.2f} {wide[1]:5.2f} | {shown} {sum(~stated)}/{len(done)}", flush=True)
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arms", nargs="+", default=["ur10", "xarm7", "z1"], choices=list(ARMS))
    parser.add_argument("--effects", nargs="*", default=list(EFFECTS), choices=list(EFFECTS))
    parser.add_argument("--levels", nargs="+", type=int, default=[0, 1, 2])
    parser.add_argument("--noise", nargs="+", type=float, default=[0.005, 0.01, 0.02])
    parser.add_argument("--logs", nargs="+", default=["periodic", "plain"], choices=["periodic", "plain"])
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name in options.arms:
            arm = Arm(name)
            print(f"{name}: coverage of all, inertial, friction, % | moved, covered, % | width of all, of moved | runs with a finding, without intervals")
            for log, noise in itertools.product(options.logs, options.noise):
                of = lambda effect, level, clean: cell(arm, Path(folder), pool, options.runs, log == "periodic", noise, effect, level, clean)
                clean = of(None, 0.0, None)
                for effect, level in itertools.product(options.effects, options.levels):
                    of(effect, EFFECTS[effect][level], clean)


if __name__ == "__main__":
    main()
