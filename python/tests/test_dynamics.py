"""The equations of motion against each other: identities between calls, and every kind of array that NumPy has."""

import armid
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

ROBOTS = ["planar-2r", "crs-a460", "staubli-tx40"]


def states_of(robot, count=40):
    generator = np.random.default_rng(7)
    return [generator.normal(size=(count, robot.dof)) for _ in range(3)]


@pytest.mark.parametrize("name", ROBOTS)
def test_identity_the_regressor_times_the_parameters_is_inverse_dynamics(name):
    robot = armid.Robot.load(name)
    q, qd, qdd = states_of(robot)
    phi = robot.nominal()
    y = robot.regressor(q, qd, qdd)
    assert y.shape == (40, robot.dof, len(robot.parameters())) and y.flags.c_contiguous
    tau = robot.inverse_dynamics(q, qd, qdd, phi)
    assert np.abs(y @ phi - tau).max() < 1e-10 * np.abs(tau).max()
    named = robot.inverse_dynamics(q, qd, qdd, dict(zip(robot.parameters(), phi)))
    assert np.array_equal(named, tau)


@pytest.mark.parametrize("name", ROBOTS)
def test_identity_normal_equations_are_those_of_the_whole_regressor(name):
    robot = armid.Robot.load(name)
    q, qd, qdd = states_of(robot)
    tau = robot.inverse_dynamics(q, qd, qdd)
    weights = 1.0 + np.arange(robot.dof)
    information, moment = robot.gram(q, qd, qdd, tau, weights)
    w = robot.regressor(q, qd, qdd).reshape(-1, information.shape[0])
    d = np.tile(weights, len(q))
    assert np.allclose(information, w.T @ (d[:, None] * w), rtol=1e-12, atol=1e-12 * information.max())
    assert np.allclose(moment, w.T @ (d * tau.ravel()), rtol=1e-11, atol=1e-11 * np.abs(moment).max())


@pytest.mark.parametrize("name", ROBOTS)
def test_identity_forward_dynamics_undoes_inverse_dynamics_and_the_mass_matrix_is_its_slope(name):
    robot = armid.Robot.load(name)
    q, qd, qdd = states_of(robot)
    tau = robot.inverse_dynamics(q, qd, qdd)
    assert np.abs(robot.forward_dynamics(q, qd, tau) - qdd).max() < 1e-7
    h = robot.mass_matrix(q)
    assert np.array_equal(h, h.transpose(0, 2, 1)) and np.linalg.eigvalsh(h).min() > 0
    slope = tau - robot.inverse_dynamics(q, qd, np.zeros_like(qdd))
    assert np.abs(np.einsum("kij,kj->ki", h, qdd) - slope).max() < 1e-9 * np.abs(slope).max()


def test_identity_the_base_predicts_what_the_regressor_does(robot, states):
    base = robot.reduce()
    phi = robot.nominal()
    y = robot.regressor(*states)
    kept = [base.parameters.index(name) for name in base.names]
    assert base.K.shape == (base.rank, len(phi)) and len(base.expressions) == base.rank
    assert np.allclose(y[:, :, kept] @ (base.K @ phi), y @ phi, atol=1e-12)


def test_identity_every_kind_of_array_gives_the_same_bits(robot, states):
    states = [np.asarray(one, dtype=np.float32) for one in states]
    expected = robot.regressor(*(one.astype(np.float64) for one in states))
    strided = [np.repeat(np.repeat(one.astype(float), 2, axis=0), 3, axis=1)[::2, ::3] for one in states]
    locked = [one.astype(float) for one in states]
    for one in locked:
        one.flags.writeable = False
    out = np.full_like(expected, np.nan)
    kinds = [
        states,
        strided,
        locked,
        [np.asfortranarray(one, dtype=float) for one in states],
        [one.tolist() for one in states],
        [one.astype(">f8") for one in states],
    ]
    for kind in kinds:
        assert robot.regressor(*kind, out=out) is out
        assert np.array_equal(out, expected)
        out[:] = np.nan
    single = robot.regressor(*(one[3] for one in states))
    assert np.array_equal(single, expected[3])
    assert robot.regressor(*(one[:0] for one in states)).shape == (0, *expected.shape[1:])


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda s: [s[0][:, :1], s[1], s[2]], r"q has the shape \[50, 1\], expected N rows of 2 joints"),
        (lambda s: [s[0], s[1][:3], s[2]], "qd has 3 rows, expected 50 as q has"),
        (lambda s: [s[0], s[1], s[2][0]], "qdd has the shape"),
        (lambda s: [s[0] * np.nan, s[1], s[2]], r"q\[0, 0\] is NaN, expected a finite number"),
        (lambda s: [s[0].astype(complex), s[1], s[2]], "q has the type complex128, expected real numbers"),
        (lambda s: [[[1, 2], [3]], s[1], s[2]], "q is not an array"),
        (lambda s: [None, s[1], s[2]], "q has the type object"),
    ],
)
def test_bad_arrays_are_refused_by_their_name(robot, states, change, said):
    with pytest.raises(armid.ArmidError, match=said):
        robot.regressor(*change(states))


def test_bad_parameters_columns_and_outputs_are_refused(robot, states):
    for call, said in [
        (lambda: robot.inverse_dynamics(*states, parameters=[1.0, 2.0, 3.0]), "parameters has 3 values, expected 28"),
        (lambda: robot.inverse_dynamics(*states, parameters={"m1": 1.0}), "parameters has no Fc1"),
        (lambda: robot.regressor(*states, columns="rigid+nonsense"), '"rigid\\+nonsense" is not rigid'),
        (lambda: robot.regressor(*states, out=np.empty((1, 2, 3))), "out is float64 of the shape"),
        (lambda: robot.gram(*states, states[0], weights=[1.0]), "weights has 1 values, expected 2"),
        (lambda: robot.gram(*states, states[0], weights=[1.0, -1.0]), "a weight is -1, expected numbers not below zero"),
        (lambda: robot.reduce(method="magic"), 'method is "magic", expected one of'),
    ]:
        with pytest.raises(armid.ArmidError, match=said):
            call()


SHAPES = arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4)
KINDS = st.sampled_from([np.float64, np.float32, np.int32, np.bool_, np.complex128, object])


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(SHAPES, KINDS), min_size=4, max_size=4), st.sampled_from([0.5, 0.0, np.nan, np.inf, 1e308]))
def test_no_shape_and_no_value_gives_anything_but_a_result_or_our_error(kinds, value):
    robot = armid.Robot.load("planar-2r")
    with np.errstate(all="ignore"):
        a, b, c, d = (np.full(shape, value).astype(kind) for shape, kind in kinds)
    calls = [
        lambda: robot.regressor(a, b, c),
        lambda: robot.gram(a, b, c, d),
        lambda: robot.gram(a, b, c, d, weights=c),
        lambda: robot.inverse_dynamics(a, b, c, parameters=d),
        lambda: robot.forward_dynamics(a, b, c, parameters=d),
        lambda: robot.forward_dynamics(a, b, c),
        lambda: robot.mass_matrix(a, parameters=d),
        lambda: armid.Log.from_arrays(a, b, t=c),
        lambda: armid.Log.from_arrays(a, b, rate=value, qd=c, q_link=d),
        lambda: armid.Log.from_arrays(a, q_cmd=b, kp=c, kd=d, delay=value, rate=100.0),
    ]
    for call in calls:
        try:
            call()
        except armid.ArmidError:
            pass
