"""C source of the A460's regressor, inverse and forward dynamics by CasADi's symbols, checked against Pinocchio."""

import casadi as ca
import numpy as np
import pinocchio as pin
from arm import BODY, build, placements

GRAVITY = [0.0, 0.0, -9.81]


def cross_matrix(v):
    return ca.skew(v)


def turn(q):
    c, s = ca.cos(q), ca.sin(q)
    return ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))


def exact(matrix):
    """Right angles as they are meant: the generated code then has neither their products nor their sums."""
    rounded = np.where(np.abs(matrix) < 1e-15, 0.0, matrix)
    return ca.sparsify(ca.DM(np.where(np.abs(np.abs(rounded) - 1) < 1e-15, np.sign(rounded), rounded)))


def motion_transform(step, q):
    """Takes spatial motions, angular part first, from a joint's parent to the joint."""
    rotation = ca.mtimes(exact(step.rotation), ca.sparsify(turn(q)))
    x = ca.SX(6, 6)
    x[:3, :3] = rotation.T
    x[3:, 3:] = rotation.T
    x[3:, :3] = -ca.mtimes(rotation.T, ca.sparsify(cross_matrix(exact(step.translation))))
    return ca.sparsify(x)


def motion_cross(v, m):
    return ca.vertcat(ca.cross(v[:3], m[:3]), ca.cross(v[:3], m[3:]) + ca.cross(v[3:], m[:3]))


def force_cross(v, f):
    return ca.vertcat(ca.cross(v[:3], f[:3]) + ca.cross(v[3:], f[3:]), ca.cross(v[:3], f[3:]))


def inertia_matrix(ten):
    m, x, y, z, xx, xy, yy, xz, yz, zz = ten
    h = cross_matrix(ca.DM([x, y, z]))
    rotational = ca.DM([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return ca.vertcat(ca.horzcat(rotational, h), ca.horzcat(h.T, m * ca.DM.eye(3)))


def per_rotation(w):
    x, y, z = ca.vertsplit(w)
    # In Pinocchio's order: xx, xy, yy, xz, yz, zz.
    return ca.vertcat(ca.horzcat(x, y, 0, z, 0, 0), ca.horzcat(0, x, y, 0, z, 0), ca.horzcat(0, 0, 0, x, y, z))


def body_regressor(v, a):
    """Moment and force of one body per unit of each of its ten parameters."""
    w, dw = v[:3], a[:3]
    b = a[3:] + ca.cross(w, v[3:])
    moment = ca.horzcat(ca.SX(3, 1), -cross_matrix(b), per_rotation(dw) + ca.mtimes(cross_matrix(w), per_rotation(w)))
    force = ca.horzcat(b, cross_matrix(dw) + ca.mtimes(cross_matrix(w), cross_matrix(w)), ca.SX(3, 6))
    return ca.vertcat(moment, force)


def symbols():
    q, v, a = (ca.SX.sym(name, 6) for name in "qva")
    steps = placements()
    transforms = [motion_transform(steps[k], q[k]) for k in range(6)]
    axis = ca.DM([0, 0, 1, 0, 0, 0])
    body = inertia_matrix(BODY)

    speed, acceleration = ca.SX(6, 1), ca.vertcat(ca.SX(3, 1), -ca.DM(GRAVITY))
    speeds, accelerations = [], []
    for k, x in enumerate(transforms):
        speed = ca.mtimes(x, speed) + axis * v[k]
        acceleration = ca.mtimes(x, acceleration) + axis * a[k] + motion_cross(speed, axis * v[k])
        speeds.append(speed)
        accelerations.append(acceleration)

    regressor, axes = ca.SX(6, 60), []
    for k, x in enumerate(transforms):
        axes = [*[ca.mtimes(x, s) for s in axes], axis]
        of_body = body_regressor(speeds[k], accelerations[k])
        for i, s in enumerate(axes):
            regressor[i, 10 * k : 10 * k + 10] = ca.mtimes(s.T, of_body)

    torque, force = ca.SX(6, 1), ca.SX(6, 1)
    for k in reversed(range(6)):
        force += ca.mtimes(body, accelerations[k]) + force_cross(speeds[k], ca.mtimes(body, speeds[k]))
        torque[k] = force[2]
        force = ca.mtimes(transforms[k].T, force)

    # Articulated bodies; the efforts are in place of the accelerations.
    inertias, biases, kept = [ca.SX(body)] * 6, [force_cross(s, ca.mtimes(body, s)) for s in speeds], {}
    curvature = [motion_cross(speeds[k], axis * v[k]) for k in range(6)]
    for k in reversed(range(6)):
        column = inertias[k][:, 2]
        kept[k] = (column, 1 / column[2], a[k] - biases[k][2])
        if k:
            column, inverse, u = kept[k]
            left = inertias[k] - ca.mtimes(column, column.T) * inverse
            bias = biases[k] + ca.mtimes(left, curvature[k]) + column * (u * inverse)
            inertias[k - 1] = inertias[k - 1] + ca.mtimes(transforms[k].T, ca.mtimes(left, transforms[k]))
            biases[k - 1] = biases[k - 1] + ca.mtimes(transforms[k].T, bias)
    found, moved = ca.SX(6, 1), ca.vertcat(ca.SX(3, 1), -ca.DM(GRAVITY))
    for k in range(6):
        column, inverse, u = kept[k]
        moved = ca.mtimes(transforms[k], moved) + curvature[k]
        found[k] = (u - ca.dot(column, moved)) * inverse
        moved += axis * found[k]

    state = [q, v, a]
    return {"regressor": (state, regressor), "rnea": (state, torque), "aba": (state, found)}


def write(folder):
    """`generated.c` in the folder, with its functions checked at random states."""
    functions = [ca.Function(name, inputs, [ca.cse(ca.densify(value))]) for name, (inputs, value) in symbols().items()]
    model, data, _ = build()
    for joint in range(1, 7):
        model.inertias[joint] = pin.Inertia.FromDynamicParameters(np.array(BODY))
    data = model.createData()
    draw = np.random.default_rng(3)
    for _ in range(20):
        q, v, a = draw.uniform(-3, 3, (3, 6))
        regressor, rnea, aba = (np.array(f(q, v, a)).squeeze() for f in functions)
        for found, expected in [(regressor, pin.computeJointTorqueRegressor(model, data, q, v, a)),
                                (rnea, pin.rnea(model, data, q, v, a)), (aba, pin.aba(model, data, q, v, a))]:
            assert np.all(np.abs(found - expected) < 1e-9 * np.abs(expected).max()), "the generated code computes something else"
    generator = ca.CodeGenerator("generated.c", {"with_header": False, "main": False})
    for function in functions:
        generator.add(function)
    generator.generate(f"{folder}/")
