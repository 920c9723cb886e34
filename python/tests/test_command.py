"""The package gives the numbers of the command, to the bit."""

import json

import armid
import numpy as np
import pandas
import polars
import pytest

pytestmark = pytest.mark.filterwarnings("ignore::armid.ArmidWarning")


@pytest.fixture(scope="module")
def folder(command, tmp_path_factory):
    """A design, its recording as MCAP and as a table, and the command's estimates of both."""
    folder = tmp_path_factory.mktemp("command")
    command(folder, "design", "planar-2r", *"--criterion d-optimal --starts 1 --evaluations 20 --no-baseline -o T.toml".split())
    (folder / "experiment.toml").write_text('robot = "planar-2r"\ntrajectory = "T.toml"\nperiods = 4\n')
    for name in ("R.mcap", "R.csv"):
        command(folder, "run", "experiment.toml", "-o", name)
    command(folder, "identify", "R.mcap", "--estimator", "ols,wls", "-o", "E.json")
    command(folder, "identify", "R.csv", *"--robot planar-2r --period 10 --from 13 -o C.json".split())
    return folder


def test_identity_a_design_has_the_bytes_of_the_command(folder, design):
    assert design.to_toml() == (folder / "T.toml").read_text()


def test_identity_a_simulated_experiment_has_the_samples_of_the_command(folder, log):
    recorded = armid.Log.read(folder / "R.mcap")
    assert np.array_equal(recorded.q, log.q) and np.array_equal(recorded.effort, log.effort)
    assert (recorded.effort_kind, recorded.joints) == (log.effort_kind, log.joints)


def test_identity_estimates_of_a_recording_are_the_command_s(folder, monkeypatch):
    monkeypatch.chdir(folder)
    log = armid.Log.read("R.mcap")
    found = log.robot.identify(log, ["ols", "wls"])
    for ours, theirs in zip(found.values(), json.loads((folder / "E.json").read_text())):
        # Advice names options there and keywords here.
        ours = ours.data
        assert len(ours["verdict"].pop("findings")) == len(theirs["verdict"].pop("findings"))
        for one in ours["findings"] + theirs["findings"]:
            one.pop("advice")
        assert ours == theirs


def test_identity_a_table_and_its_arrays_are_one_log(folder, robot, monkeypatch):
    monkeypatch.chdir(folder)
    of = dict(period=10.0, start=13.0)
    command = armid.Estimate.read("C.json")
    table = np.loadtxt("R.csv", delimiter=",", skiprows=1)
    t, q, efforts = table[:, 0], table[:, 1:3], table[:, 3:5]
    kind = armid.Log.read("R.csv").effort_kind
    arrays = armid.Log.from_arrays(q, t=t, **{"tau" if kind == "torque" else "current": efforts})
    columns = pandas.read_csv("R.csv")
    frames = [armid.Log.from_dataframe(df) for df in (columns, polars.from_pandas(columns), columns.to_dict("list"))]
    for log in ("R.csv", arrays, *frames):
        ours = robot.identify(log, **of)
        assert np.array_equal(ours.values, command.values) and np.array_equal(ours.std, command.std)
        assert ours.unexplained() == command.unexplained()


def test_identity_what_follows_from_an_estimate_is_the_command_s(folder, command, tmp_path, monkeypatch):
    monkeypatch.chdir(folder)
    estimate = armid.Estimate.read("C.json")
    told = command(folder, "validate", "C.json", "R.mcap", "--json")
    ours = estimate.validate("R.mcap").data
    assert ours == told
    for to in ("urdf", "json", "c"):
        command(folder, "export", "C.json", "--to", to, "-o", f"model.{to}")
        assert estimate.export(to, tmp_path / f"model.{to}") == (folder / f"model.{to}").read_text()
        assert (tmp_path / f"model.{to}").read_text() == (folder / f"model.{to}").read_text()
    command(folder, "report", "C.json", "-o", "page")
    page = estimate.report(tmp_path / "page")
    with open(page) as drawn, open(folder / "page" / "report.html") as expected:
        assert drawn.read() == expected.read()


def test_identity_base_parameters_are_the_command_s(folder, command):
    told = command(folder, "reduce", "crs-a460", "--columns", "rigid+rotor+friction", "--json")
    base = armid.Robot.load("crs-a460").reduce()
    assert base.rank == told["rank"]
    assert base.expressions == [one["expression"] for one in told["base"]]
    places = {name: place for place, name in enumerate(base.parameters)}
    for row, one in zip(base.K, told["base"]):
        expected = np.zeros(len(places))
        for term in one["terms"]:
            expected[places[term["parameter"]]] = term["coefficient"]
        assert np.array_equal(row, expected)
