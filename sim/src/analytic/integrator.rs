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
pub(crate) fn parts_of_step<const N: usize>(chain: &Chain<N>, y: &State<N, f64>, tau: &[f64; N], dt: f64) -> f64 {
    let (a, factor) = chain.accelerate_alone(&y.q, &y.v, tau);
    parts(chain, y, &a, &factor, dt)
}

/// Steps one arm by `dt` under held torque; compiled once for all that step arms one by one.
#[inline(never)]
pub(crate) fn step_alone<const N: usize>(chain: &Chain<N>, y: &mut State<N, f64>, tau: &[f64; N], dt: f64) {
    step(chain, y, tau, dt);
}

/// Steps every run by `dt` under held torque. Stages are a loop, so that the equations of motion, which are all inlined, are
/// compiled once and not at each of them.
#[inline(always)]
pub(crate) fn step<const N: usize, V: Lane>(chain: &Chain<N>, y: &mut State<N, V>, tau: &[V; N], dt: f64) {
    let one = tau[0].splat(1.0);
    let (mut parts_of_runs, mut h, mut most, mut done) = (one, one.splat(dt), f64::INFINITY, 0.0);
    let mut stages = [(y.v, y.v); 4];
    while done < most {
        let (mut q, mut v) = (y.q, y.v);
        for stage in 0..4 {
            let (a, factor) = chain.accelerate(&q, &v, tau);
            if most == f64::INFINITY {
                parts_of_runs = parts(chain, y, &a, &factor, dt);
                h = one.splat(dt).over(parts_of_runs);
                most = parts_of_runs.most();
            }
            stages[stage] = (v, a);
            let ahead = if stage < 2 { h * one.splat(0.5) } else { h };
            q = along(&y.q, &v, ahead);
            v = along(&y.v, &a, ahead);
        }
        let [(v1, a1), (v2, a2), (v3, a3), (v4, a4)] = &stages;
        let (sixth, two) = (h * one.splat(1.0 / 6.0), one.splat(2.0));
        let done_parts = one.splat(done);
        for i in 0..N {
            let next_q = y.q[i] + sixth * (v1[i] + two * (v2[i] + v3[i]) + v4[i]);
            let next_v = y.v[i] + sixth * (a1[i] + two * (a2[i] + a3[i]) + a4[i]);
            // A run that has had all its parts waits for the others.
            y.q[i] = done_parts.less(parts_of_runs, next_q, y.q[i]);
            y.v[i] = done_parts.less(parts_of_runs, next_v, y.v[i]);
        }
        done += 1.0;
    }
}
