"""Estimators and criteria of one's own, beside ours in a design and in a study."""

import pickle
import warnings

import armid
import numpy as np
import pandas
import polars
import pytest

pytestmark = pytest.mark.filterwarnings("ignore::armid.ArmidWarning")

PLAN = """
name = "own"
question = "Do methods of one's own take part?"
robot = "planar-2r"
seed = 3
runs = 2

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
estimators = ["ols", "mine"]

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
name = "ours"
making = "optimised"
criterion = "d-optimal"
starts = 1
evaluations = 10

[[design]]
name = "own"
making = "optimised"
criterion = "log-det"
starts = 1
evaluations = 10
"""


def log_det(information):
    return -np.linalg.slogdet(information)[1], -np.linalg.inv(information)


def least_squares(w, y):
    return np.linalg.lstsq(w, y, rcond=None)[0]


def test_identity_a_criterion_of_ones_own_is_d_optimal_where_it_does_what_that_does(robot):
    of = dict(starts=1, evaluations=40, baseline=False)
    ours, own = robot.design("d-optimal", **of), robot.design(log_det, **of)
    assert own.criterion == "log_det" and own.is_feasible
    # Ours reports ln det M, which is the larger the better.
    assert abs(own.value + ours.value) < 1e-6 * abs(ours.value)
    assert np.abs(own.sample(100)[1] - ours.sample(100)[1]).max() < 1e-4


def test_what_a_criterion_of_ones_own_raises_or_gets_wrong_reaches_the_caller(robot):
    class Own(Exception):
        pass

    def fails(information):
        raise Own("no value")

    with pytest.raises(Own, match="no value"):
        robot.design(fails, starts=1, evaluations=5)
    for wrong, said in [
        (lambda m: 1.0, "did not return"),
        (lambda m: (1.0, np.eye(2)), "S of criterion <lambda>"),
        (lambda m: (np.nan, -np.linalg.inv(m)), "is NaN"),
        (lambda m: (-np.linalg.slogdet(m)[1], np.linalg.inv(m)), "expected d value = tr"),
    ]:
        with pytest.raises(armid.ArmidError, match=said):
            robot.design(wrong, starts=1, evaluations=5)
    with pytest.raises(armid.ArmidError, match="expected a name or a callable"):
        robot.design(3)


def test_identity_methods_of_ones_own_take_part_in_a_study(tmp_path):
    plan = tmp_path / "study.toml"
    plan.write_text(PLAN)
    with pytest.raises(armid.ArmidError, match='identification.estimators is "mine"'):
        armid.study(plan, tmp_path / "none")
    own = dict(estimators={"mine": least_squares}, criteria={"log-det": log_det})
    study = armid.study(plan, tmp_path / "out", **own)
    table = study.rows("parameters")
    # By Arrow's C interface, which copies nothing.
    values = polars.DataFrame(table)
    assert values.shape == (table.num_rows, table.num_columns)
    assert pandas.DataFrame(table.to_pandas()).shape == values.shape
    by = values.partition_by("estimator", as_dict=True)
    assert np.allclose(by[("mine",)]["estimate"], by[("ols",)]["estimate"], rtol=1e-8, atol=1e-11)
    assert pickle.loads(pickle.dumps(study)).data == study.data
    page = study.report().read_text()
    assert "log-det" in page and "mine" in page
    with pytest.raises(armid.ArmidError, match='table is "designs"'):
        study.rows("designs")
    # Finished work is found again.
    again = armid.study(plan, tmp_path / "out", resume=True, **own)
    assert again.data == study.data


def test_a_run_whose_estimator_raises_is_one_without_an_estimate(tmp_path):
    plan = tmp_path / "study.toml"
    plan.write_text(PLAN)

    def fails(w, y):
        raise ValueError("no answer")

    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        study = armid.study(plan, tmp_path / "out", estimators={"mine": fails}, criteria={"log-det": log_det})
    assert any("ValueError: no answer" in str(one.message) for one in seen)
    runs = study.rows().to_pandas()
    assert set(runs[runs["estimator"] == "ols"]["status"]) != set(runs[runs["estimator"] == "mine"]["status"])
