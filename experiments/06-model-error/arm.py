"""The arm of a study in numpy, of revolute joints in distal Denavit-Hartenberg frames: base regressor, true parameters, and the random motions on which predictions are scored.

Written beside the program from its documented equations (NOTATION.md, `mechanics/src/seed.rs`, `src/study/validation.rs`), so that what the
scripts of this folder say of states agrees with what `armid study` stored to rounding, and not by the same code.
"""
import hashlib
import pathlib
import tomllib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"]
DRIVE = ["Ia", "Fv", "Fc", "Fo"]


def skew(v):
    """S(v) of each row, S(v) x = v × x."""
    out = np.zeros((*v.shape, 3))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    return out - np.swapaxes(out, -1, -2)


def on_inertia(w):
    """L(w) with I w = L(w) (Ixx, Ixy, Ixz, Iyy, Iyz, Izz)."""
    out = np.zeros((*w.shape[:-1], 3, 6))
    x, y, z = w[..., 0], w[..., 1], w[..., 2]
    out[..., 0, 0], out[..., 0, 1], out[..., 0, 2] = x, y, z
    out[..., 1, 1], out[..., 1, 3], out[..., 1, 4] = x, y, z
    out[..., 2, 2], out[..., 2, 4], out[..., 2, 5] = x, y, z
    return out


class Arm:
    """Kinematics (distal Denavit-Hartenberg), limits and drives of a robot file, with parameters of the file beside it."""

    def __init__(self, name="crs-a460"):
        file = pathlib.Path(__file__).parent / name
        folder = file.parent if name.endswith(".toml") else ROOT / "models" / name
        self.file = tomllib.loads((folder / "robot.toml").read_text())
        self.joints = self.file["joint"]
        self.n = len(self.joints)
        self.names = [f"{p}{i + 1}" for i in range(self.n) for p in LINK] + [f"{p}{i + 1}" for i in range(self.n) for p in DRIVE]
        self.truth = self.vector(folder / "truth.toml")
        self.nominal = self.vector(folder / "nominal.toml")
        limit = lambda key: np.array([joint["limits"][key] for joint in self.joints], float)
        self.position = np.deg2rad(limit("position_deg"))
        self.speed = np.deg2rad(limit("velocity_deg_s"))
        self.acceleration = limit("acceleration_rad_s2")
        self.rating = limit("torque_nm")
        self.continuous = np.array([joint["limits"].get("continuous_torque_nm", np.inf) for joint in self.joints])
        drive = lambda key: np.array([joint["drive"][key] for joint in self.joints], float)
        self.sign_speed = drive("coulomb_velocity_rad_s")
        self.gear = drive("gear")
        self.noise = drive("current_noise_a") * drive("gear") * drive("torque_constant_nm_a")

    def vector(self, path):
        """Standard parameters in the order of `names`: inertias about the origin of the link's frame."""
        file, out = tomllib.loads(path.read_text()), []
        for link in file["link"]:
            m, c, i = link["mass_kg"], np.array(link["com_m"], float), link["inertia_about_com_kg_m2"]
            about = np.array([[i["xx"], i["xy"], i["xz"]], [i["xy"], i["yy"], i["yz"]], [i["xz"], i["yz"], i["zz"]]])
            about = about + m * (c @ c * np.eye(3) - np.outer(c, c))
            out += [m, *(m * c), *about[np.triu_indices(3)]]
        for drive in file["drive"]:
            out += [drive["rotor_kg_m2"], drive["viscous_nm_s_rad"], drive["coulomb_nm"], drive.get("offset_nm", 0.0)]
        return np.array(out)

    def regressor(self, q, qd, qdd, gravity=(0.0, 0.0, -9.81)):
        """Y (N, n, parameters) with τ = Y φ; q, q̇, q̈ are (N, n). `gravity` in the base frame, m/s²."""
        samples, n = q.shape
        rotation, zero = np.broadcast_to(np.eye(3), (samples, 3, 3)), np.zeros((samples, 3))
        w, al, a, place = zero, zero, zero - np.array(gravity), zero
        axes, places, y = [], [], np.zeros((samples, n, len(self.names)))
        for i, joint in enumerate(self.joints):
            dh = joint["dh"]
            axis = rotation[:, :, 2]
            axes.append(axis)
            places.append(place)
            al = al + axis * qdd[:, i, None] + np.cross(w, axis * qd[:, i, None])
            w = w + axis * qd[:, i, None]
            angle, twist = q[:, i] + np.deg2rad(dh["offset_deg"]), np.deg2rad(dh["alpha_deg"])
            c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(twist), np.sin(twist)
            turn = np.stack([np.stack([c, -s * ca, s * sa], -1), np.stack([s, c * ca, -c * sa], -1),
                             np.stack([0 * c, 0 * c + sa, 0 * c + ca], -1)], -2)
            arm = np.stack([dh["a_m"] * c, dh["a_m"] * s, 0 * c + dh["d_m"]], -1)
            arm = np.einsum("kij,kj->ki", rotation, arm)
            a = a + np.cross(al, arm) + np.cross(w, np.cross(w, arm))
            place, rotation = place + arm, rotation @ turn
            into = lambda v, r=rotation: np.einsum("kji,kj->ki", r, v)
            wl, all_, acc = into(w), into(al), into(a)
            force, moment = np.zeros((samples, 3, 10)), np.zeros((samples, 3, 10))
            force[:, :, 0], force[:, :, 1:4] = acc, skew(all_) + skew(wl) @ skew(wl)
            moment[:, :, 1:4], moment[:, :, 4:] = -skew(acc), on_inertia(all_) + skew(wl) @ on_inertia(wl)
            force, moment = rotation @ force, rotation @ moment
            for j in range(i + 1):
                about = moment + skew(place - places[j]) @ force
                y[:, j, 10 * i : 10 * i + 10] = np.einsum("ki,kip->kp", axes[j], about)
        for j in range(n):
            at = 10 * n + 4 * j
            y[:, j, at : at + 4] = np.stack([qdd[:, j], qd[:, j], np.tanh(qd[:, j] / self.sign_speed[j]), 1 + 0 * q[:, j]], -1)
        return y

    def columns(self, names):
        """Places of these parameters among the standard ones; a base parameter stands under the name of the column it keeps."""
        return [self.names.index(name) for name in names]


class Stream:
    """ChaCha8 of `mechanics/src/seed.rs`: key SHA-256(seed ‖ purpose), stream number `run`; 53-bit and ranged floats of the crate rand."""

    def __init__(self, seed, purpose, run):
        self.key = np.frombuffer(key(seed, purpose), "<u4")
        self.run, self.block, self.words = run, 0, np.zeros(0, np.uint32)

    def u64(self, count):
        while len(self.words) < 2 * count:
            self.words = np.concatenate([self.words, self.blocks(256)])
        head, self.words = self.words[: 2 * count].astype(np.uint64), self.words[2 * count :]
        return head[0::2] | head[1::2] << np.uint64(32)

    def uniform(self, count=1):
        return (self.u64(count) >> np.uint64(11)) * 2.0**-53

    def between(self, low, high, count):
        return (self.u64(count) >> np.uint64(12)) * 2.0**-52 * (high - low) + low

    def blocks(self, count):
        counter = np.arange(self.block, self.block + count, dtype=np.uint64)
        self.block += count
        state = np.zeros((16, count), np.uint32)
        state[:4] = np.frombuffer(b"expand 32-byte k", "<u4")[:, None]
        state[4:12] = self.key[:, None]
        state[12], state[13] = counter & np.uint64(0xFFFFFFFF), counter >> np.uint64(32)
        state[14], state[15] = self.run & 0xFFFFFFFF, self.run >> 32
        x = state.copy()
        roll = lambda v, by: v << np.uint32(by) | v >> np.uint32(32 - by)
        for _ in range(4):
            for a, b, c, d in [(0, 4, 8, 12), (1, 5, 9, 13), (2, 6, 10, 14), (3, 7, 11, 15),
                               (0, 5, 10, 15), (1, 6, 11, 12), (2, 7, 8, 13), (3, 4, 9, 14)]:
                for left, add, by in [(d, (a, b), 16), (b, (c, d), 12), (d, (a, b), 8), (b, (c, d), 7)]:
                    x[add[0]] += x[add[1]]
                    x[left] = roll(x[left] ^ x[add[0]], by)
        return (x + state).T.reshape(-1)


def key(seed, purpose):
    return hashlib.sha256(seed.to_bytes(8, "little") + purpose.encode()).digest()


def child(seed, purpose, index):
    """`Seed::child`."""
    turned = (index << 32 | index >> 32) & (2**64 - 1)
    return int.from_bytes(key(seed ^ turned, purpose)[:8], "big")


def series(a, b, q0, period, times):
    """q, q̇, q̈ (N, n) of Fourier series in the convention of NOTATION.md; a, b are (n, H)."""
    order = np.arange(1, a.shape[1] + 1) * 2 * np.pi / period
    phase = times[:, None] * order
    s, c = np.sin(phase), np.cos(phase)
    q = q0 + (s @ (a / order).T) - (c @ (b / order).T)
    return q, c @ a.T + s @ b.T, -(s * order) @ a.T + (c * order) @ b.T


def trajectory(stored, samples):
    """States of a design of `summary.json` at `samples` equidistant times of a period."""
    a, b = (np.array([joint[k] for joint in stored["joints"]]) for k in "ab")
    q0 = np.array([joint["q0"] for joint in stored["joints"]])
    period = stored["period_s"]
    return series(a, b, q0, period, np.arange(samples) * period / samples)


def random_motions(arm, plan):
    """The random validation motions of a study's plan, (q, q̇, q̈) of each at `samples` times."""
    settings, experiment = plan["validation"], plan["experiment"]
    return [random_motion(arm, plan["seed"], index, experiment["period_s"], experiment["harmonics"], settings["samples"])
            for index in range(settings["trajectories"])]


def random_motion(arm, seed, index, period, harmonics, samples):
    """The first draw whose torque by the nominal parameters is inside the ratings at full and at 30 % of its speed."""
    shrink, fine = 1.0, np.arange(20000) * period / 20000
    for draw in range(100):
        stream = Stream(child(seed, "validation", draw), "paper start", index)
        a, b = np.zeros((arm.n, harmonics)), np.zeros((arm.n, harmonics))
        count = max(100, 4 * harmonics)
        phase = 2 * np.pi * np.outer(np.arange(count), np.arange(1, harmonics + 1)) / count
        for j in range(arm.n):
            velocity = stream.between(-arm.speed[j], arm.speed[j], count)
            a[j], b[j] = 2 / count * np.cos(phase).T @ velocity, 2 / count * np.sin(phase).T @ velocity
        q, qd, qdd = series(a, b, 0.0, period, fine)
        width = arm.position[:, 1] - arm.position[:, 0]
        use = np.max([np.ptp(q, axis=0) / width, abs(qd).max(0) / arm.speed, abs(qdd).max(0) / arm.acceleration], axis=0)
        scale = 0.999 / use
        a, b, q = a * scale[:, None], b * scale[:, None], q * scale
        low, high = arm.position[:, 0] + 0.0005 * width - q.min(0), arm.position[:, 1] - 0.0005 * width - q.max(0)
        q0 = low + np.concatenate([stream.uniform() for _ in range(arm.n)]) * np.maximum(high - low, 0)
        if draw >= 20:
            shrink *= 0.95
            a, b = a * shrink, b * shrink
        inside = True
        for speed in (1.0, 0.3):
            q, qd, qdd = series(a, b, q0, period, np.arange(500) * period / 500)
            tau = arm.regressor(q, speed * qd, speed**2 * qdd) @ arm.nominal
            inside &= (abs(tau).max(0) <= 0.99 * arm.rating).all()
            inside &= (np.sqrt((tau**2).mean(0)) <= 0.99 * arm.continuous).all()
        if inside:
            return series(a, b, q0, period, np.arange(samples) * period / samples)
    raise SystemExit(f"validation motion {index}: no draw of 100 is inside the torque ratings")
