#!/usr/bin/env python3
"""What schemes for a step with stiff friction cost, and by how much they err.

    python3 benches/peers/stiff_friction.py

    H(q) q̈ = τ − c(q, q̇) − F tanh(q̇/v_s) − V q̇        two joints, torque held over 1 ms, v_s = 0.01 rad/s

Each scheme makes single steps from 2000 states of a motion. Its error is the largest in a velocity, against the divided Runge–Kutta
method with 200 times as many parts. Its cost is how often the rigid part (H, c) and friction are evaluated in a step that is stiff.

Reference of the linearly implicit scheme: W. H. Press et al., *Numerical Recipes*, 2nd ed., 1992, sec. 16.6 (Kaps and Rentrop, by Shampine).
"""

import numpy as np

DT, SCALE = 1e-3, 0.01
COULOMB, VISCOUS, ROTOR = np.array([6.0, 2.0]), np.array([1.5, 0.2]), np.array([0.5, 0.01])
# Masses, kg; length and centres of mass, m; inertias, kg m².
M1, M2, L1, C1, C2, I1, I2, G = 8.0, 1.2, 0.3, 0.15, 0.15, 0.08, 0.008, 9.81
COST = {}


def rigid(q, v, tau):
    """H⁻¹ (…, 2, 2) and H⁻¹ (τ − c)."""
    COST["rigid"] += 1
    c, s = np.cos(q[:, 1]), np.sin(q[:, 1])
    h = np.empty((len(q), 2, 2))
    h[:, 0, 1] = h[:, 1, 0] = M2 * (L1 * C2 * c + C2 * C2) + I2
    h[:, 1, 1] = M2 * C2 * C2 + I2 + ROTOR[1]
    h[:, 0, 0] = M1 * C1 * C1 + I1 + ROTOR[0] + M2 * (L1 * L1 + C2 * C2 + 2 * L1 * C2 * c) + I2
    inverse, k = np.linalg.inv(h), M2 * L1 * C2 * s
    far = M2 * C2 * np.cos(q[:, 0] + q[:, 1])
    bias = np.stack([-k * (2 * v[:, 0] * v[:, 1] + v[:, 1] ** 2) + G * ((M1 * C1 + M2 * L1) * np.cos(q[:, 0]) + far),
                     k * v[:, 0] ** 2 + G * far], axis=1)
    return inverse, times(inverse, tau - bias)


def times(matrix, x):
    return np.einsum("kij,kj->ki", matrix, x)


def friction(v):
    COST["friction"] += 1
    return COULOMB * np.tanh(v / SCALE) + VISCOUS * v


def slopes(v):
    return COULOMB / SCALE * (1 - np.tanh(v / SCALE) ** 2) + VISCOUS


def acceleration(q, v, tau):
    inverse, free = rigid(q, v, tau)
    return free - times(inverse, friction(v))


def runge_kutta(q, v, h, a_of):
    a1 = a_of(q, v)
    v2 = v + h / 2 * a1
    a2 = a_of(q + h / 2 * v, v2)
    v3 = v + h / 2 * a2
    a3 = a_of(q + h / 2 * v2, v3)
    v4 = v + h * a3
    a4 = a_of(q + h * v3, v4)
    return q + h / 6 * (v + 2 * (v2 + v3) + v4), v + h / 6 * (a1 + 2 * (a2 + a3) + a4)


def parts(v, inverse, free, dt):
    """As integrator.rs divides a step."""
    change = 1.5 * dt * np.abs(free - times(inverse, friction(v)))
    COST["friction"] -= 1
    d = slopes(np.maximum(0, np.abs(v) - change)) * (1 + 0.25 * np.minimum(1, change / SCALE))
    twice = (inverse * d[:, None, :]) @ inverse
    rate = np.einsum("kij,kij,ki,kj->k", twice, twice, d, d) ** 0.25
    return np.clip(np.rint(rate * dt / 1.2 + 0.5), 1, 64)


def midpoint(q, v, h, a_of):
    a = a_of(q, v)
    middle = v + h / 2 * a
    return q + h * middle, v + h * a_of(q + h / 2 * v, middle)


def in_parts(q, v, dt, count, a_of, method=runge_kutta):
    h = (dt / count)[:, None]
    for done in range(int(count.max())):
        going = (done < count)[:, None]
        q1, v1 = method(q, v, h, a_of)
        q, v = np.where(going, q1, q), np.where(going, v1, v)
    return q, v


def divided(q, v, tau, dt, finer=1):
    count = parts(v, *rigid(q, v, tau), dt)
    COST["rigid"] -= 1
    return in_parts(q, v, dt, finer * count, lambda q, v: acceleration(q, v, tau))


def linearly_implicit(q, v, tau, dt):
    """Four stages, order 4, exact Jacobian, which is not counted."""
    y, n, before = np.hstack([q, v]), len(q), dict(COST)

    def f(y):
        return np.hstack([y[:, 2:], acceleration(y[:, :2], y[:, 2:], tau)])

    jacobian = np.stack([(f(y + step) - f(y - step)) / 2e-7 for step in 1e-7 * np.eye(4)], axis=2)
    COST.update(before)
    matrix = np.eye(4) / (0.5 * dt) - jacobian
    solve = lambda right: np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
    k1 = solve(f(y))
    k2 = solve(f(y + 2 * k1) - 8 * k1 / dt)
    last = f(y + 48 / 25 * k1 + 6 / 25 * k2)
    k3 = solve(last + (372 / 25 * k1 + 12 / 5 * k2) / dt)
    k4 = solve(last - (112 / 125 * k1 + 54 / 125 * k2 + 2 / 5 * k3) / dt)
    y = y + 19 / 9 * k1 + k2 / 2 + 25 / 108 * k3 + 125 / 108 * k4
    return y[:, :2], y[:, 2:]


def split(q, v, tau, dt):
    """Strang: half a step of each joint's own friction under the acceleration at the beginning, exact; the rest; the other half."""
    inverse, free = rigid(q, v, tau)
    COST["rigid"] -= 1
    own = np.einsum("kii->ki", inverse) * COULOMB
    held = free - times(inverse, friction(v)) + own * np.tanh(v / SCALE)

    def half(v):
        before = dict(COST)
        for _ in range(100):
            v = runge_kutta(v, v, dt / 200, lambda _, v: held - own * np.tanh(v / SCALE))[1]
        COST.update(before)
        COST["friction"] += 1
        return v

    rest = lambda q, v: acceleration(q, v, tau) - held + own * np.tanh(v / SCALE)
    q, v = runge_kutta(q, half(v), dt, rest)
    return q, half(v)


def held(q, v, tau, dt):
    """The rigid part of the beginning is held while friction takes its parts."""
    inverse, free = rigid(q, v, tau)
    return in_parts(q, v, dt, parts(v, inverse, free, dt), lambda _, v: free - times(inverse, friction(v)))


def middle(q, v, tau, dt):
    """As integrator.rs: the rigid part is that of the middle, which half a step with that of the beginning finds by the midpoint rule.
    Undivided steps are whole."""
    inverse, free = rigid(q, v, tau)
    count = parts(v, inverse, free, dt)
    q1, v1 = in_parts(q, v, dt / 2, np.ceil(count / 2), lambda _, v: free - times(inverse, friction(v)), midpoint)
    inverse, free = rigid(q1, v1, tau)
    found = in_parts(q, v, dt, count, lambda _, v: free - times(inverse, friction(v)))
    before = dict(COST)
    whole = runge_kutta(q, v, dt, lambda q, v: acceleration(q, v, tau))
    COST.update(before)
    return tuple(np.where(count[:, None] > 1, a, b) for a, b in zip(found, whole))


SCHEMES = {
    "divided": divided,
    "linearly implicit, 4 stages": linearly_implicit,
    "friction split off (Strang)": split,
    "rigid part held": held,
    "rigid part of the middle": middle,
}


def states(size, rate, rest):
    t = np.arange(2000)[:, None] * DT
    w = rate * np.array([1.0, 1.3])
    phase, amplitude = w * t + np.array([0.0, 1.0]), size * np.array([1.0, 0.8])
    q, v, a = np.array([0.2, -0.5]) + amplitude * np.sin(phase), amplitude * w * np.cos(phase), -amplitude * w * w * np.sin(phase)
    inverse, free = rigid(q, v, np.zeros_like(q))
    torque = times(np.linalg.inv(inverse), a - free) + friction(v)
    if rest:
        # Held against gravity, and pushed by up to 1.1 times the friction.
        v = np.zeros_like(v)
        inverse, free = rigid(q, v, v)
        torque = times(np.linalg.inv(inverse), -free) + 1.1 * COULOMB * np.sin(np.array([20.0, 31.0]) * t)
    return q, v, torque


def main():
    print("| scheme | rigid parts | frictions | fast reversals | slow reversals | at rest | of them at a tenth of the step |")
    print("|---|---|---|---|---|---|---|")
    rows = {name: [] for name in SCHEMES}
    for motion in ((0.5, 8.0, False), (0.05, 3.0, False), (0.05, 3.0, True)):
        COST.update(rigid=0, friction=0)
        q, v, tau = states(*motion)
        _, exact = divided(q, v, tau, DT, 200)
        stiff = parts(v, *rigid(q, v, tau), DT)
        mean = stiff[stiff > 1].mean()
        for name, step in SCHEMES.items():
            COST.update(rigid=0, friction=0)
            found = step(q, v, tau, DT)[1]
            cost = dict(COST)
            # Parts are made of all states at once: as many as the stiffest needs.
            cost = {kind: count if count < 10 else count - 4 * (stiff.max() - mean) for kind, count in cost.items()}
            small = q, v
            for _ in range(10):
                small = step(*small, tau, DT / 10)
            rows[name].append((cost, np.abs(found - exact).max(), np.abs(small[1] - exact).max()))
    for name, found in rows.items():
        rest = found[2][0]
        errors = " | ".join(f"{error:.1e}" for _, error, _ in found)
        print(f"| {name} | {rest['rigid']:.0f} | {rest['friction']:.0f} | {errors} | {', '.join(f'{small:.1e}' for _, _, small in found)} |")


if __name__ == "__main__":
    main()
