"""Every notebook runs from its first cell to its last, and its numbers are the command's."""

import pathlib
import runpy

import armid
import matplotlib
import numpy as np
import pytest

NOTEBOOKS = pathlib.Path(__file__).parents[1] / "notebooks"


def paper(found, command, folder):
    ranks = {columns: command(folder, "reduce", "crs-a460", "--columns", columns, "--json")["rank"] for columns in found["ranks"]}
    assert ranks == found["ranks"]


def own_robot(found, command, folder):
    """The samples of the log in a table, whose stamps are rounded."""
    log, names = found["log"], ["t", *(f"{name}{joint}" for name in ("q", "tau") for joint in (1, 2, 3))]
    table = np.column_stack([log.t, log.q, log.effort])
    np.savetxt(folder / "log.csv", table, delimiter=",", header=",".join(names), comments="", fmt="%.17g")
    command(found["folder"], "identify", folder / "log.csv", "--robot", "arm.urdf", "--period", "none", "-o", folder / "E.json")
    ours, theirs = found["estimate"], armid.Estimate.read(folder / "E.json")
    assert ours.names == theirs.names and (np.abs(ours.values - theirs.values) < 1e-3 * ours.std).all()


def set_points(found, command, folder):
    command(found["folder"], *found["command"], "-o", folder / "E.json")
    assert np.array_equal(armid.Estimate.read(folder / "E.json").values, found["estimate"].values)
    assert np.abs(found["deviations"]).max() < 4


def estimators(found, command, folder):
    asked = ["--estimator", ",".join(found["NAMES"]), "--period", "none", "--onset-speed", "stated", "--json"]
    for one in command(found["folder"], "identify", "log.csv", "--robot", "planar-2r", *asked):
        ours = found["estimates"][one["estimator"]]
        assert [base["value"] for base in one["base"]] == list(ours.values)


def study(found, command, folder):
    command(folder, "study", found["folder"] / "study.toml", "-o", folder / "results", "--quiet")
    assert (folder / "results/summary.json").read_bytes() == (found["folder"] / "results/summary.json").read_bytes()


@pytest.mark.filterwarnings("ignore::armid.ArmidWarning")
@pytest.mark.parametrize("check", [paper, own_robot, set_points, estimators, study], ids=lambda check: check.__name__)
def test_identity_a_notebook_runs_and_has_the_numbers_of_the_command(check, command, tmp_path):
    matplotlib.use("agg")
    check(runpy.run_path(str(NOTEBOOKS / f"{check.__name__}.py")), command, tmp_path)


def test_every_notebook_is_run():
    assert {path.stem for path in NOTEBOOKS.glob("*.py")} == {check.__name__ for check in (paper, own_robot, set_points, estimators, study)}
