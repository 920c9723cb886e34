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
use super::lane::Lane;

/// Largest `λ h` of a part of a step.
const STIFFNESS: f64 = 1.2;
/// Beyond this many `v_s` the slope of the smooth sign, below 4e-5 of the slope at zero, is no longer looked at.
const REACH: f64 = 5.7;
/// More parts than this a step never has.
pub(crate) const MOST_PARTS: usize = 64;

/// Coordinates and velocities.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State<const N: usize, V> {
    pub(crate) q: [V; N],
    pub(crate) v: [V; N],
}

#[inline(always)]
fn along<const N: usize, V: Lane>(x: &[V; N], slope: &[V; N], h: V) -> [V; N] {
    std::array::from_fn(|i| x[i] + h * slope[i])
}

/// One step of length `h` whose first slope `a1` is known.
#[inline(always)]
fn advance<const N: usize, V: Lane>(chain: &Chain<N>, y: &State<N, V>, a1: &[V; N], tau: &[V; N], h: V) -> State<N, V> {
    let half = h * V::splat(0.5);
    let v2 = along(&y.v, a1, half);
    let (a2, _) = chain.accelerate(&along(&y.q, &y.v, half), &v2, tau);
    let v3 = along(&y.v, &a2, half);
    let (a3, _) = chain.accelerate(&along(&y.q, &v2, half), &v3, tau);
    let v4 = along(&y.v, &a3, h);
    let (a4, _) = chain.accelerate(&along(&y.q, &v3, h), &v4, tau);
    let sixth = h * V::splat(1.0 / 6.0);
    let two = V::splat(2.0);
    State {
        q: std::array::from_fn(|i| y.q[i] + sixth * (y.v[i] + two * (v2[i] + v3[i]) + v4[i])),
        v: std::array::from_fn(|i| y.v[i] + sixth * (a1[i] + two * (a2[i] + a3[i]) + a4[i])),
    }
}

/// How many parts a step needs.
fn parts<const N: usize>(chain: &Chain<N>, y: &State<N, f64>, a: &[f64; N], factor: &Factor<N, f64>, dt: f64) -> usize {
    // Half again as much as the acceleration at the beginning promises.
    let change = a.map(|a| 1.5 * a.abs() * dt);
    if !chain.friction.may_turn(&y.v, &change, REACH) {
        return 1;
    }
    let rate = chain.friction.decay(&y.v, &change, &factor.inverse());
    let parts = (rate * dt / STIFFNESS).ceil();
    // NaN becomes one part; the caller finds the state not finite.
    (parts.min(MOST_PARTS as f64) as usize).max(1)
}

/// Steps one run by `dt` under held torque.
pub(crate) fn step<const N: usize>(chain: &Chain<N>, y: &mut State<N, f64>, tau: &[f64; N], dt: f64) {
    let (mut a, factor) = chain.accelerate(&y.q, &y.v, tau);
    let parts = parts(chain, y, &a, &factor, dt);
    let h = dt / parts as f64;
    *y = advance(chain, y, &a, tau, h);
    for _ in 1..parts {
        (a, _) = chain.accelerate(&y.q, &y.v, tau);
        *y = advance(chain, y, &a, tau, h);
    }
}
