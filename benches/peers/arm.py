"""The CRS A460 as the peers see it: geometry, and Pinocchio's model with the map from parameters in DH frames to its own."""

import numpy as np
import pinocchio as pin

# Offset deg, d m, a m, alpha deg: models/crs-a460/robot.toml.
DH = [(0, 0.3302, 0, 90), (90, 0, 0.3048, 0), (-90, 0, 0, -90), (0, 0.3302, 0, 90), (0, 0, 0, -90), (0, 0.0762, 0, 0)]
KINDS = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"]
# Where Pinocchio keeps each of these ten.
IN_PINOCCHIO = [0, 1, 2, 3, 4, 5, 7, 6, 8, 9]
NAMES = [f"{kind}{link + 1}" for link in range(6) for kind in KINDS]
# Ten parameters of every link, in Pinocchio's order of its own frames: a body of 5 kg.
BODY = [5.0, 0.1, -0.2, 0.3, 0.4, 0.01, 0.5, -0.02, 0.03, 0.3]


def transform(axis, angle, translation):
    rotation = pin.AngleAxis(angle, np.eye(3)[axis]).toRotationMatrix()
    return pin.SE3(rotation, np.array(translation, dtype=float))


def pseudo_inertia(ten):
    m, x, y, z, xx, xy, xz, yy, yz, zz = ten
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    out = np.zeros((4, 4))
    out[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    out[:3, 3] = out[3, :3] = [x, y, z]
    out[3, 3] = m
    return out


def ten_of(pseudo):
    inertia = np.trace(pseudo[:3, :3]) * np.eye(3) - pseudo[:3, :3]
    x, y, z = pseudo[:3, 3]
    return [pseudo[3, 3], x, y, z, inertia[0, 0], inertia[0, 1], inertia[0, 2], inertia[1, 1], inertia[1, 2], inertia[2, 2]]


def placements():
    """Of each joint's frame in the one before, at q = 0, and after the last what is left."""
    after, steps = pin.SE3.Identity(), []
    for offset, d, a, alpha in DH:
        steps.append(after * transform(2, np.radians(offset), [0, 0, 0]))
        after = transform(2, 0.0, [a, 0, d]) * transform(0, np.radians(alpha), [0, 0, 0])
    return [*steps, after]


def build():
    """The arm in Pinocchio's joint frames, and the map from parameters in DH frames to those in joint frames."""
    model = pin.Model()
    parent, steps = 0, placements()
    change = np.zeros((60, 60))
    for i, (_, d, a, alpha) in enumerate(DH):
        parent = model.addJoint(parent, pin.JointModelRZ(), steps[i], f"joint{i + 1}")
        after = transform(2, 0.0, [a, 0, d]) * transform(0, np.radians(alpha), [0, 0, 0])
        for k in range(10):
            moved = ten_of(after.homogeneous @ pseudo_inertia(np.eye(10)[k]) @ after.homogeneous.T)
            for row, value in enumerate(moved):
                change[10 * i + IN_PINOCCHIO[row], 10 * i + k] = value
    return model, model.createData(), change


def columns_of(change, names):
    """The map from these base parameters to Pinocchio's sixty."""
    return np.ascontiguousarray(change[:, [NAMES.index(name) for name in names]])
