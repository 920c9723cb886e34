"""The Python package against Pinocchio's from Python, on a UR5: equality, then times of one run.

    PYTHONPATH=SITE venv/bin/python benches/peers/python_package.py [--samples 10000] [--turns 15]

`SITE` holds the package, optimised: `pip install --target SITE .` makes it. `venv` has pin and example-robot-data. One thread; the least of
all turns of each side, which take turns. Equality is to 1e-9 of the largest entry: the URDF's angles, printed with few digits, are read as
the angles that they stand for.
"""
import argparse
import json
import sysconfig
import time

import numpy as np
import pinocchio as pin

import armid

# Where Pinocchio's m, mc, Ixx, Ixy, Iyy, Ixz, Iyz, Izz stand among armid's ten.
PLACES = [0, 1, 2, 3, 4, 5, 7, 6, 8, 9]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--turns", type=int, default=15)
    options = parser.parse_args()
    urdf = f"{sysconfig.get_path('purelib')}/cmeel.prefix/share/example-robot-data/robots/ur_description/urdf/ur5_robot.urdf"
    model = pin.buildModelFromUrdf(urdf)
    data, robot = model.createData(), armid.Robot.load(urdf, tip_link="ee_link")
    n, p, count = robot.dof, 10 * robot.dof, options.samples
    random = np.random.default_rng(1)
    q, qd, qdd = (random.uniform(-2.0, 2.0, (count, n)) for _ in range(3))
    # The same parameters on both sides: what the URDF states.
    phi = robot.nominal("rigid")
    order = np.concatenate([10 * link + np.array(PLACES) for link in range(n)])

    def peer_regressor():
        return [pin.computeJointTorqueRegressor(model, data, q[k], qd[k], qdd[k]).copy() for k in range(count)]

    def peer_gram(tau):
        information, moment = np.zeros((p, p)), np.zeros(p)
        for k in range(count):
            y = pin.computeJointTorqueRegressor(model, data, q[k], qd[k], qdd[k])
            information += y.T @ y
            moment += y.T @ tau[k]
        return information, moment

    def peer_inverse():
        return np.array([pin.rnea(model, data, q[k], qd[k], qdd[k]).copy() for k in range(count)])

    y, expected = robot.regressor(q, qd, qdd, "rigid"), np.array(peer_regressor())
    tau, torque = robot.inverse_dynamics(q, qd, qdd, phi, "rigid"), peer_inverse()
    pairs = {
        "regressor": (y[:, :, order], expected),
        "inverse dynamics": (tau, torque),
        "gram": (robot.gram(q, qd, qdd, torque, columns="rigid")[0][np.ix_(order, order)], peer_gram(torque)[0]),
    }
    differences = {name: float(np.abs(own - peer).max() / np.abs(peer).max()) for name, (own, peer) in pairs.items()}
    assert max(differences.values()) < 1e-9, differences

    out = np.empty_like(y)
    calls = {
        "regressor": (lambda: robot.regressor(q, qd, qdd, "rigid"), peer_regressor),
        "regressor, into memory that is there": (lambda: robot.regressor(q, qd, qdd, "rigid", out=out), peer_regressor),
        "gram": (lambda: robot.gram(q, qd, qdd, torque, columns="rigid"), lambda: peer_gram(torque)),
        "inverse dynamics": (lambda: robot.inverse_dynamics(q, qd, qdd, phi, "rigid"), peer_inverse),
        "memory of the regressor, written alone": (lambda: np.empty_like(y).fill(1.0), peer_regressor),
    }

    def seconds(call):
        begin = time.perf_counter()
        call()
        return time.perf_counter() - begin

    found = {}
    for name, (own, peer) in calls.items():
        turns = [(seconds(own), seconds(peer)) for _ in range(options.turns)]
        ours, theirs = (1e3 * min(times) for times in zip(*turns))
        found[name] = {"own_ms": round(ours, 2), "peer_ms": round(theirs, 2), "ratio": round(theirs / ours, 1)}
    print(json.dumps({"samples": count, "differences": differences, "times": found}, indent=1))


if __name__ == "__main__":
    main()
