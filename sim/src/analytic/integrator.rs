//! The classical Runge–Kutta method of order 4 on the equations of motion, refined where friction is stiff.
//!
//! ```text
//! k₁ = f(y)   k₂ = f(y + h/2 k₁)   k₃ = f(y + h/2 k₂)   k₄ = f(y + h k₃)   y ← y + h/6 (k₁ + 2k₂ + 2k₃ + k₄)
//! ```
//! with `y = (q, q̇)`, torque held. Smooth Coulomb friction makes velocities near zero decay at rates up to
//! `λ = tr(M⁻¹ D)`, `D` the slopes of friction: some thousands per second at standstill. A step is divided into
//! `⌈λ h / 1.2⌉` equal parts, at most [`MOST_PARTS`], `λ` bounded over the speeds that the step may pass through. Away
//! from standstill the tanh is flat and there is one part. The method is stable up to `λ h = 2.78`.

use super::chain::Chain;
use super::forward::Factor;
use armid::lanes::Lane;

/// Largest `λ h` of a part of a step.
const STIFFNESS: f64 = 1.2;
/// Beyond this many `v_s` the slope of the smooth sign, below 4e-5 of the slope at zero, is no longer looked at.
const REACH: f64 = 5.7;
/// More parts than this a step never has.
const MOST_PARTS: f64 = 64.0;

/// Coordinates and velocities.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State<const N: usize, V> {
    pub(crate) q: [V; N],
    pub(crate) v: [V; N],
}

#[inline(always)]
fn along<const N: usize, V: Lane>(x: &[V; N], slope: &[V; N], h: V) -> [V; N] {
    let mut out = *x;
    for i in 0..N {
        out[i] = x[i] + h * slope[i];
    }
    out
}

/// One step of length `h` whose first slope `a1` is known.
#[inline(always)]
fn advance<const N: usize, V: Lane>(chain: &Chain<N>, y: &State<N, V>, a1: &[V; N], tau: &[V; N], h: V) -> State<N, V> {
    let half = h * h.splat(0.5);
    let v2 = along(&y.v, a1, half);
    let (a2, _) = chain.accelerate(&along(&y.q, &y.v, half), &v2, tau);
    let v3 = along(&y.v, &a2, half);
    let (a3, _) = chain.accelerate(&along(&y.q, &v2, half), &v3, tau);
    let v4 = along(&y.v, &a3, h);
    let (a4, _) = chain.accelerate(&along(&y.q, &v3, h), &v4, tau);
    let sixth = h * h.splat(1.0 / 6.0);
    let two = h.splat(2.0);
    let mut end = *y;
    for i in 0..N {
        end.q[i] = y.q[i] + sixth * (y.v[i] + two * (v2[i] + v3[i]) + v4[i]);
        end.v[i] = y.v[i] + sixth * (a1[i] + two * (a2[i] + a3[i]) + a4[i]);
    }
    end
}

/// How many parts a step needs, for each run.
#[inline(always)]
fn parts<const N: usize, V: Lane>(chain: &Chain<N>, y: &State<N, V>, a: &[V; N], factor: &Factor<N, V>, dt: f64) -> V {
    let one = a[0].splat(1.0);
    // Half again as much as the acceleration at the beginning promises.
    let mut change = *a;
    for i in 0..N {
        change[i] = a[i].magnitude() * one.splat(1.5 * dt);
    }
    let turns = chain.forces.turns(&y.v, &change, REACH);
    if turns.most() < 0.5 {
        return one;
    }
    let rate = chain.forces.decay(&y.q, &y.v, &change, factor);
    let needed = (rate * one.splat(dt / STIFFNESS) + one.splat(0.5)).nearest().smaller(one.splat(MOST_PARTS));
    // One where the acceleration is not a number: the caller finds the state not finite.
    one.splat(0.5).less(turns, one.less(needed, needed, one), one)
}

/// How many parts a step of one arm is divided into.
#[inline(always)]
pub(crate) fn parts_of_step<const N: usize>(chain: &Chain<N>, y: &State<N, f64>, tau: &[f64; N], dt: f64) -> f64 {
    let (a, factor) = chain.accelerate(&y.q, &y.v, tau);
    parts(chain, y, &a, &factor, dt)
}

/// Steps every run by `dt` under held torque.
#[inline(always)]
pub(crate) fn step<const N: usize, V: Lane>(chain: &Chain<N>, y: &mut State<N, V>, tau: &[V; N], dt: f64) {
    let (mut a, factor) = chain.accelerate(&y.q, &y.v, tau);
    let parts = parts(chain, y, &a, &factor, dt);
    let h = parts.splat(dt).over(parts);
    *y = advance(chain, y, &a, tau, h);
    let most = parts.most();
    let mut done = 1.0;
    while done < most {
        (a, _) = chain.accelerate(&y.q, &y.v, tau);
        let next = advance(chain, y, &a, tau, h);
        // A run that has had all its parts waits for the others.
        let done_parts = parts.splat(done);
        for i in 0..N {
            y.q[i] = done_parts.less(parts, next.q[i], y.q[i]);
            y.v[i] = done_parts.less(parts, next.v[i], y.v[i]);
        }
        done += 1.0;
    }
}
