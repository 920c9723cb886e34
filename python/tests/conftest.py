"""What the tests share: a small arm, a recording of it, and the command with which numbers are compared."""

import json
import os
import subprocess
import warnings

import armid
import numpy as np
import pytest


@pytest.fixture(scope="session")
def robot():
    return armid.Robot.load("planar-2r")


@pytest.fixture(scope="session")
def design(robot):
    return robot.design("d-optimal", starts=1, evaluations=20, baseline=False)


@pytest.fixture(scope="session")
def log(robot, design):
    return robot.simulate(design, periods=4)


@pytest.fixture(scope="session")
def estimate(robot, log):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", armid.ArmidWarning)
        return robot.identify(log)


@pytest.fixture()
def states(robot):
    generator = np.random.default_rng(1)
    return [generator.normal(size=(50, robot.dof)) for _ in range(3)]


@pytest.fixture(scope="session")
def command():
    """Runs the command; what it prints, as JSON where it is asked for that."""
    if "ARMID" not in os.environ:
        raise RuntimeError("ARMID is not set, expected the path of the command: scripts/python-package sets it")

    def run(folder, *arguments):
        done = subprocess.run(
            [os.environ["ARMID"], *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=False
        )
        assert done.returncode in (0, 1), done.stderr
        return json.loads(done.stdout) if "--json" in arguments else done.stdout

    return run
