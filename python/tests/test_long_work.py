"""Long calls: they tell how far they are, let other threads run, and end when they are asked to."""

import os
import pickle
import signal
import threading
import time

import armid
import numpy as np
import pytest

pytestmark = pytest.mark.filterwarnings("ignore::armid.ArmidWarning")

PLAN = """
name = "tiny"
question = "Does it go on where it was ended?"
robot = "planar-2r"
seed = 3
runs = 6

[experiment]
period_s = 2.0
harmonics = 3
rate_hz = 1000.0
periods = 3
discarded_periods = 1

[identification]
columns = "rigid"
derivatives = "fourier"
samples_per_period = 200
estimators = ["ols"]

[validation]
trajectories = 2
samples = 50

[reference]
mass_kg = 0.1
first_moment_kg_m = 0.02
inertia_kg_m2 = 0.01
viscous_nm_s_rad = 0.1
torque_nm = 0.1

[[design]]
name = "random"
making = "random"
criterion = "condition"
starts = 2
evaluations = 5
"""


def endless(**more):
    """A design that would take days."""
    return armid.Robot.load("crs-a460").design("d-optimal", starts=1000, evaluations=100_000, **more)


def assert_ctrl_c_ends(call, after_s):
    # A shell that starts a program in the background has it ignore this signal.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    asked = threading.Timer(after_s, lambda: os.kill(os.getpid(), signal.SIGINT))
    asked.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
    finally:
        # A call that ended by itself is no reason to interrupt the next test.
        asked.cancel()
        asked.join()
        signal.signal(signal.SIGINT, before)


def test_ctrl_c_ends_a_design_while_other_threads_run():
    ticks, over = [], threading.Event()

    def tick():
        while not over.wait(0.01):
            ticks.append(time.monotonic())

    other = threading.Thread(target=tick)
    other.start()
    try:
        assert_ctrl_c_ends(endless, 0.5)
    finally:
        over.set()
        other.join()
    assert len(ticks) > 5


def test_ctrl_c_ends_every_other_long_call(robot, design, tmp_path):
    log = robot.simulate(design, periods=16)
    plan = tmp_path / "study.toml"
    plan.write_text(PLAN.replace("runs = 6", "runs = 100000"))
    for call in [
        lambda: robot.simulate(design, periods=1000),
        lambda: robot.identify(log, "cloe"),
        lambda: robot.identify(log, select="all"),
        lambda: armid.study(plan, tmp_path / "study"),
    ]:
        # The shortest of them takes half a second.
        assert_ctrl_c_ends(call, 0.1)


def test_progress_is_told_and_its_exception_ends_the_work():
    class Enough(Exception):
        pass

    seen = []

    def progress(done, total, what):
        seen.append((done, total, what))
        if what == "evaluations" and done > 0:
            raise Enough

    with pytest.raises(Enough):
        endless(progress=progress)
    assert all(0 <= done <= total for done, total, _ in seen)


def test_set_points_of_a_design_are_its_motion(robot, design, tmp_path):
    t, q, qd, qdd = design.sample(1000)
    assert t.shape == (10_000,) and q.shape == qd.shape == qdd.shape == (10_000, 2)
    inner = slice(1, -1)
    assert np.abs(np.gradient(q, t, axis=0)[inner] - qd[inner]).max() < 1e-4 * np.abs(qd).max()
    assert np.abs(np.gradient(qd, t, axis=0)[inner] - qdd[inner]).max() < 1e-4 * np.abs(qdd).max()
    design.to_csv(tmp_path / "q.csv", 100)
    table = np.loadtxt(tmp_path / "q.csv", delimiter=",", skiprows=1)
    assert np.array_equal(table, np.column_stack(design.sample(100)))
    again = pickle.loads(pickle.dumps(design))
    assert again == design and np.array_equal(again.sample(100)[1], design.sample(100)[1])
    assert design.is_feasible and design.criterion == "d-optimal"
    with pytest.raises(armid.ArmidError, match="expected a whole number"):
        design.sample(0.33)


def test_designs_and_experiments_that_cannot_be_are_refused(robot, design):
    for call, said in [
        (lambda: robot.design("best"), 'criterion is "best", expected a callable, or one of'),
        (lambda: robot.design(), "expected either criterion= or payload="),
        (lambda: robot.design("condition", starts=0), "the number of starts is 0"),
        (lambda: robot.design("condition", frozen={"knee": 0.0}), 'the joint to hold still is "knee"'),
        (lambda: robot.design("condition", family="spiral"), 'family is "spiral"'),
        (lambda: robot.simulate("nowhere.toml"), "trajectory file not found"),
        (lambda: robot.simulate(design, engine="magic"), 'engine is "magic", expected one of'),
        (lambda: robot.simulate(design, effects={"magic": 1.0}), "effects: "),
        (lambda: robot.simulate(design, rate=0.0), "rate"),
    ]:
        with pytest.raises(armid.ArmidError, match=said):
            call()


def test_a_study_that_was_ended_goes_on_to_the_same_results(tmp_path):
    plan = tmp_path / "study.toml"
    plan.write_text(PLAN)
    whole = armid.study(plan, tmp_path / "whole")
    assert whole.data["whole"]["runs"] == 12 and whole.report().is_file()
    assert whole.rows().num_rows == 12

    class Enough(Exception):
        pass

    def progress(done, total, what):
        if what == "runs" and done > 0:
            raise Enough

    try:
        armid.study(plan, tmp_path / "ended", progress=progress)
    except Enough:
        pass
    armid.study(plan, tmp_path / "ended", resume=True)
    assert (tmp_path / "ended" / "summary.json").read_bytes() == (tmp_path / "whole" / "summary.json").read_bytes()
