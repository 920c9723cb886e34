"""Logs, estimates, estimators of one's own, and what a reader is warned of."""

import pickle
import warnings

import armid
import matplotlib
import numpy as np
import pytest
from matplotlib import pyplot
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

matplotlib.use("agg")

pytestmark = pytest.mark.filterwarnings("ignore::armid.ArmidWarning")


def exact(robot, motion, parameters, noise=1e-3, rate=200.0):
    """A log of five periods of a motion with the torque of these parameters."""
    _, q, qd, qdd = (np.concatenate([one] * 5) for one in robot.sample(motion, rate))
    tau = robot.inverse_dynamics(q, qd, qdd, parameters)
    tau += noise * np.random.default_rng(3).normal(size=tau.shape)
    return armid.Log.from_arrays(q, tau, rate=rate)


def test_identity_arrays_with_known_parameters_give_them_back(robot, design):
    phi = robot.nominal()
    log = exact(robot, design, phi)
    estimate = robot.identify(log, period=design.period, onset_speed="stated")
    beta = robot.reduce().K @ phi
    assert estimate.names == robot.reduce().names
    assert np.abs((estimate.values - beta) / estimate.std).max() < 5
    low, high = estimate.interval().T
    assert (low < estimate.values).all() and (estimate.values < high).all()
    wider = estimate.interval(0.99)
    assert (wider[:, 0] < low).all() and (wider[:, 1] > high).all()
    assert estimate.unexplained()["total"] < 1e-3
    assert np.allclose(estimate.std, np.sqrt(np.diag(estimate.covariance)))
    torque = estimate.predict(log.q, log.q, log.q)
    assert torque.shape == log.q.shape and np.array_equal(estimate.predict(log.q[0], log.q[0], log.q[0]), torque[0])


def test_identity_commands_of_a_servo_are_the_torque_that_it_makes(robot, design):
    torque = exact(robot, design, robot.nominal())
    t, q, qd, _ = design.sample(200.0)
    kp, kd = np.array([90.0, 40.0]), 2.5
    commands = torque.q + (torque.effort + kd * np.concatenate([qd] * 5)) / kp
    log = armid.Log.from_arrays(torque.q, q_cmd=commands, kp=kp, kd=kd, rate=200.0)
    # Velocities by differences: of a motion up to 0.5 Hz at 200 Hz they are exact to a part of 1e-6.
    assert np.abs(log.effort - torque.effort)[5:-5].max() < 1e-4 and "those of a servo" in log.remarks[0]
    measured = armid.Log.from_arrays(torque.q, q_cmd=commands, kp=kp, kd=kd, rate=200.0, qd=np.concatenate([qd] * 5))
    assert np.abs(measured.effort - torque.effort).max() < 1e-10
    for given, said in [
        (dict(q_cmd=q), "found q_cmd= without gains"),
        (dict(q_cmd=q, kp=kp), "found q_cmd= without gains"),
        (dict(tau=q, kp=kp, kd=kd), "found tau= with gains of a servo"),
        (dict(tau=q, q_cmd=q, kp=kp, kd=kd), "found tau and q_cmd"),
        (dict(q_cmd=q, kp=[1.0, 2.0, 3.0], kd=kd), "kp has the shape"),
        (dict(q_cmd=q, kp=kp, kd=-1.0), "kd is -1, expected zero"),
        (dict(q_cmd=q, kp=kp, kd=kd, delay=np.nan), "delay is NaN s"),
        (dict(tau=q, unknown=["delay"]), "found tau= with gains of a servo"),
        (dict(q_cmd=q, kp=kp, kd=kd, unknown=["lag"]), 'unknown holds "lag", expected delay, kp1'),
        (dict(q_cmd=q, kp=kp, kd=kd, unknown=["kp3"]), "expected one of joints 1 to 2"),
        (dict(), "found no efforts"),
    ]:
        with pytest.raises(armid.ArmidError, match=said):
            armid.Log.from_arrays(q, t=t, **given)


def test_what_is_unknown_of_a_servo_is_estimated_by_cloe_alone(robot, design):
    kp, kd, step = np.array([90.0, 40.0]), np.array([5.0, 2.0]), 0.005
    t, command, speed, _ = design.sample(1.0 / step)
    command = np.concatenate([command] * 2)
    q, qd, reached = command[0], speed[0], []

    def slope(q, qd, goal):
        return robot.forward_dynamics(q, qd, kp * (goal - q) - kd * qd)

    late = 4
    for row in range(len(command)):
        reached.append(q)
        goal = command[max(row - late, 0)]
        half_q, half_qd = q + 0.5 * step * qd, qd + 0.5 * step * slope(q, qd, goal)
        q, qd = q + step * half_qd, qd + step * slope(half_q, half_qd, goal)
    servo = dict(q_cmd=command, kp=[90.0, 30.0], kd=kd, unknown=["delay", "kp2"], rate=1.0 / step)
    log = armid.Log.from_arrays(np.array(reached), **servo)
    estimate = robot.identify(log, "cloe", columns="rigid+rotor+viscous+coulomb", period=None, held_out=None)
    found = estimate.servo
    # Commands are held for a row, half a row late on average.
    for name, known, most in [("delay", (late + 0.5) * step, 5e-4), ("kp2", 40.0, 1.0)]:
        assert abs(found[name]["value"] - known) < most and found[name]["std"] < most, found[name]
    assert (found["delay"]["unit"], found["kp2"]["unit"], found["kp2"]["stated"]) == ("s", "N·m/rad", 30.0)
    with pytest.raises(armid.ArmidError, match="delay, kp2 of the servo is unknown, expected it to be known for the estimator wls"):
        robot.identify(log, "wls", period=None)


def test_identity_the_load_that_was_put_on_is_found():
    robot = armid.Robot.load("crs-a460")
    names, phi = robot.parameters(), robot.nominal()
    mass, x, z, own = 0.5, 0.02, 0.06, 1e-3
    load = {"m": mass, "mcx": mass * x, "mcz": mass * z, "Ixz": -mass * x * z}
    load.update({"Ixx": mass * z * z + own, "Iyy": mass * (x * x + z * z) + own, "Izz": mass * x * x + own})
    carried = phi.copy()
    for symbol, value in load.items():
        carried[names.index(f"{symbol}6")] += value
    of = dict(period=10.0, held_out=None, onset_speed="stated")
    without, with_ = (robot.identify(exact(robot, "table-one", one), **of) for one in (phi, carried))
    payload = robot.payload(without, with_)
    shown = {name: one["shown"] for name, one in payload.parameters.items() if one["shown"] is not None}
    assert {"m", "mcx", "mcz"} <= set(shown)
    assert all(abs(one["value"] - load.get(name, 0.0)) < 5 * one["std"] for name, one in shown.items())
    assert abs(payload.mass - mass) < 5 * shown["m"]["std"]
    assert np.allclose(payload.centre, [x, 0.0, z], atol=0.01) and payload.inertia.shape == (3, 3)
    assert pickle.loads(pickle.dumps(payload)).data == payload.data
    # The logs themselves, on one side or on both, are identified alike.
    logs = [exact(robot, "table-one", one) for one in (phi, carried)]
    beside = robot.payload(without, logs[1])
    assert np.allclose(beside.mass, payload.mass, rtol=1e-9)
    assert abs(robot.payload(*logs).mass - mass) < 5 * shown["m"]["std"]
    rigid = robot.identify(exact(robot, "table-one", phi), **of, columns="rigid+rotor")
    with pytest.raises(armid.ArmidError):
        robot.payload(without, rigid)


def test_identity_an_estimator_of_ones_own_is_ols_where_it_does_what_ols_does(robot, log):
    def mine(w, y):
        assert w.shape == (len(y), 13) and w.dtype == y.dtype == np.float64
        return np.linalg.lstsq(w, y, rcond=None)[0]

    def sure(w, y):
        beta = np.linalg.lstsq(w, y, rcond=None)[0]
        return beta, 4.0 * np.eye(len(beta))

    found = robot.identify(log, [mine, "ols", sure])
    assert list(found) == ["ols", "mine", "sure"]
    assert np.allclose(found["mine"].values, found["ols"].values, rtol=1e-9, atol=1e-12)
    # The same but for rounding: it is made symmetric.
    assert np.allclose(found["mine"].covariance, found["ols"].covariance, rtol=1e-10, atol=0)
    assert (found["sure"].std == 2.0).all() and found["sure"].estimator == "sure"
    named = robot.identify(log, {"a": mine})
    assert list(named) == ["a"] and np.array_equal(named["a"].values, found["mine"].values)


def test_what_an_estimator_of_ones_own_raises_reaches_the_caller(robot, log):
    class Own(Exception):
        pass

    def fails(w, y):
        raise Own("no answer")

    with pytest.raises(Own, match="no answer"):
        robot.identify(log, fails)
    for wrong in (
        lambda w, y: np.zeros(3),
        lambda w, y: (np.zeros(13), np.eye(3)),
        lambda w, y: np.full(13, np.nan),
        lambda w, y: (np.zeros(13), -np.eye(13)),
    ):
        with pytest.raises(armid.ArmidError):
            robot.identify(log, wrong)
    for wrong in (lambda w, y: None, lambda w, y: "nothing", lambda w, y: np.zeros((2, 2))):
        with pytest.raises((TypeError, ValueError)):
            robot.identify(log, wrong)
    with pytest.raises(armid.ArmidError, match="expected a mapping"):
        robot.identify(log, [fails, fails])


def test_an_estimate_is_its_file(robot, estimate, tmp_path):
    again = pickle.loads(pickle.dumps(estimate))
    assert again == estimate and hash(again) == hash(estimate)
    estimate.write(tmp_path / "E.json")
    read = armid.Estimate.read(tmp_path / "E.json")
    assert read == estimate and read.robot.joints == robot.joints
    states = np.ones((3, 2))
    assert np.array_equal(read.predict(states, states, states), estimate.predict(states, states, states))
    with pytest.raises(armid.ArmidError, match="made from arrays, which are gone, expected logs="):
        again.export("json")
    page = estimate._repr_html_()
    assert page.index("error of the torque of the fit") < page.index("<table>") and "m1 − Izz1" in page
    assert repr(estimate).startswith("<armid.Estimate of 'planar-2r' by wls: 13 parameters; error of the torque")
    table = estimate.to_pandas()
    assert list(table.index) == estimate.names and table["std"].to_numpy().tolist() == estimate.std.tolist()


def test_findings_and_suspicions_are_warned_of_at_the_callers_line(robot, log, estimate):
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        robot.identify(log)
    assert {one.category for one in seen} == {armid.ArmidWarning} and {one.filename for one in seen} == {__file__}
    assert [str(one.message) for one in seen] == [f"wls: {finding.text}" for finding in estimate.findings]
    standing = np.zeros((500, 2))
    standing[:, 1] = np.sin(np.arange(500) / 20)
    with pytest.warns(armid.ArmidWarning, match="joint 1 is at rest"):
        robot.identify(armid.Log.from_arrays(standing, np.cos(standing), rate=100.0), columns="rigid", period=None)


def test_torque_in_the_band_of_the_positions_gives_another_estimate_of_the_same_parameters(robot, log):
    plain, filtered = (robot.identify(log, torque_filter=of) for of in ("none", "same-as-positions"))
    difference = np.abs(filtered.values - plain.values)
    assert difference.max() > 0 and np.all(difference < 4.0 * (plain.std + filtered.std))


def test_logs_that_cannot_be_used_are_refused(robot, log, tmp_path):
    q = np.zeros((100, 2))
    stamps = np.arange(100) / 100.0
    for call, said in [
        (lambda: armid.Log.from_arrays(q, q), "expected either t="),
        (lambda: armid.Log.from_dataframe({"t": stamps, "x": stamps}, "t=t, q=y, tau=x"), "y"),
        (lambda: armid.Log.from_dataframe({"t": stamps, "q1": stamps[1:], "tau1": stamps}), "expected columns of one length"),
        (lambda: armid.Log.from_arrays(q, q, current=q, rate=1.0), "exactly one of tau=, current= and q_cmd="),
        (lambda: armid.Log.from_arrays(q, q, t=stamps[::-1]), "row 1"),
        (lambda: armid.Log.from_arrays(q, q, t=stamps[:5]), "t has 5 values, expected 100"),
        (lambda: armid.Log.from_arrays(q, q[:50], rate=1.0), "the efforts has 50 rows"),
        (lambda: armid.Log.from_arrays(q, q, rate=-1.0), "the rate is -1 Hz"),
        (lambda: armid.Log.from_arrays(q, q, rate=1.0, joints=["one"]), "joints has 1 values, expected 2"),
        (lambda: robot.identify(log, "magic"), 'estimator is "magic", expected a callable, or one of'),
        (lambda: robot.identify(log, period="later"), 'period is "later"'),
        (lambda: robot.identify(log, held_out=2.0), "held_out is 2, expected a share"),
        (lambda: robot.identify(log, bandwidth_hz=-1.0), "bandwidth_hz is -1"),
        (lambda: robot.identify(log, derivatives="guess"), 'derivatives is "guess"'),
        (lambda: robot.identify(log, torque_filter="guess"), 'torque_filter is "guess", expected none or same-as-positions'),
        (lambda: robot.identify([]), "no log is named"),
        (lambda: robot.identify(armid.Log.from_arrays(np.zeros((9, 3)), np.zeros((9, 3)), rate=1.0)), "3"),
        (lambda: armid.Estimate("[]"), "not an estimate"),
    ]:
        with pytest.raises(armid.ArmidError, match=said):
            call()
    bad = tmp_path / "robot.toml"
    bad.write_text('name = "x"\nwhat = 1\n')
    with pytest.raises(armid.ArmidError, match="robot.toml:2:1") as raised:
        armid.Robot.load(bad)
    assert raised.value.place is not None and raised.value.place[1:] == (2, 1)
    for call in (
        lambda: armid.Robot.load("crs-a461"),
        lambda: armid.Robot.load(tmp_path / "none.urdf"),
        lambda: armid.Log.read(tmp_path / "none.csv"),
        lambda: armid.Estimate.read(tmp_path / "none.json"),
    ):
        with pytest.raises(FileNotFoundError) as missing:
            call()
        assert isinstance(missing.value, armid.ArmidError)
    assert 'did you mean "crs-a460"' in str(pytest.raises(armid.ArmidError, armid.Robot.load, "crs-a461").value)


def test_identity_torque_is_that_of_the_page_however_it_is_shown(robot, log, estimate, tmp_path):
    torque = estimate.torque()
    rows = len(torque.t)
    assert torque.measured.shape == torque.predicted.shape == (rows, 2) and not torque.is_held_out
    difference = torque.measured - torque.predicted
    share = np.sqrt((difference**2).sum() / (torque.measured**2).sum())
    assert abs(share - estimate.unexplained()["total"]) < 1e-2 * share
    drawing = estimate.plot()
    assert drawing._repr_svg_().startswith("<svg") and "elbow" in drawing
    estimate.report(tmp_path / "page")
    drawing.write(tmp_path / "torque.svg")
    assert (tmp_path / "torque.svg").read_text() == (tmp_path / "page" / "torque.svg").read_text()
    figure, axes = pyplot.subplots()
    assert estimate.plot("elbow", ax=axes) is axes and axes.get_title() == "elbow"
    measured, predicted = (line.get_ydata() for line in axes.lines)
    assert np.array_equal(measured, torque.measured[:, 1]) and np.array_equal(predicted, torque.predicted[:, 1])
    pyplot.close(figure)
    for wrong in (lambda: estimate.plot("knee", ax=axes), lambda: estimate.plot("elbow")):
        with pytest.raises(armid.ArmidError, match="joint is"):
            wrong()
    table = estimate.to_polars()
    assert table["parameter"].to_list() == estimate.names and table["std"].to_list() == estimate.std.tolist()


def test_identity_a_viewer_sees_the_motion_and_both_torques(robot, estimate, tmp_path):
    estimate.write_mcap(tmp_path / "view.mcap")
    torque = estimate.torque()
    with open(tmp_path / "view.mcap", "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        messages = {}
        for _, channel, message, decoded in reader.iter_decoded_messages():
            messages.setdefault(channel.topic, []).append((message.log_time, decoded))
    assert set(messages) == {"/robot_description", "/tf", "/joint_states", "/predicted_torque", "/residual"}
    topics = ("/joint_states", "/predicted_torque", "/residual")
    efforts = {topic: np.array([decoded.effort for _, decoded in messages[topic]]) for topic in topics}
    assert np.array_equal(efforts["/joint_states"], torque.measured)
    assert np.array_equal(efforts["/predicted_torque"], torque.predicted)
    assert np.array_equal(efforts["/residual"], torque.measured - torque.predicted)
    ((_, description),) = messages["/robot_description"]
    assert description.data.startswith("<?xml") and "<cylinder" in description.data
    times = np.array([time for time, _ in messages["/tf"]])
    assert (np.diff(times) >= 20_000_000).all() and messages["/tf"][0][1].transforms[0].child_frame_id == "link1"
    with pytest.raises(armid.ArmidError):
        estimate.write_mcap(tmp_path)
