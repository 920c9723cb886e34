//! The classical Runge–Kutta method of order 4 on the equations of motion, with friction refined where it is stiff.
//!
//! ```text
//! k₁ = f(y)   k₂ = f(y + h/2 k₁)   k₃ = f(y + h/2 k₂)   k₄ = f(y + h k₃)   y ← y + h/6 (k₁ + 2k₂ + 2k₃ + k₄)
//! ```
//! with `y = (q, q̇)`, torque held. Smooth Coulomb friction makes velocities near zero decay at rates up to `λ`, the largest
//! eigenvalue of `H⁻¹ D` with `D` the slopes of friction: some thousands per second at standstill. A step is then divided
//! into `⌈λ h / 1.2⌉` equal parts, at most [`MOST_PARTS`], and into a quarter more where a speed passes through the tanh. The
//! fourth root of the sum of the eigenvalues' fourth powers bounds `λ`, and the largest slopes at the speeds that the step may pass
//! through bound `D`. Away from standstill the tanh is flat and there is one part. The method is stable up to `λ h = 2.78`.
//!
//! Only friction needs the parts. In a divided step the rigid part, mass matrix and bias forces, is that of the middle of
//! the step (midpoint rule, order 2). Half a step with the rigid part of the beginning finds it, in half as many parts by the midpoint
//! rule, which is stable up to `λ h = 2`:
//!
//! ```text
//! H(qₘ) q̈ = τ − c(qₘ, q̇ₘ) − g(qₘ) − friction(q, q̇)
//! ```
//! So two rigid parts serve any number of friction's. A speed that creeps under friction then follows the forces of the middle.

use super::chain::Chain;
use super::forward::{Rigid, Room};
use armid::lanes::{Lane, Sines};

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

/// The equations of motion with a rigid part that does not change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held<const N: usize, V> {
    /// `H⁻¹`: products with it do not wait for each other, as those of a solution do.
    inverse: [[V; N]; N],
    /// `τ − c − g`.
    free: [V; N],
}

impl<const N: usize, V: Lane> Held<N, V> {
    #[inline(always)]
    fn nothing(zero: V) -> Self {
        Self { inverse: [[zero; N]; N], free: [zero; N] }
    }

    #[inline(always)]
    pub(crate) fn new(rigid: &Rigid<N, V>, tau: &[V; N]) -> Self {
        let mut held = Self::nothing(tau[0].splat(0.0));
        held.hold(rigid, tau);
        held
    }

    /// Holds this rigid part.
    #[inline(always)]
    fn hold(&mut self, rigid: &Rigid<N, V>, tau: &[V; N]) {
        rigid.factor.inverse(&mut self.inverse);
        rigid.free(tau, &mut self.free);
    }

    /// Accelerations where friction takes `taken`.
    #[inline(always)]
    pub(crate) fn accelerations(&self, taken: &[V; N]) -> [V; N] {
        let mut left = self.free;
        for i in 0..N {
            left[i] = self.free[i] - taken[i];
        }
        let mut out = left;
        for i in 0..N {
            out[i] = self.inverse[0][i] * left[0];
            for j in 1..N {
                out[i] = out[i] + self.inverse[j][i] * left[j];
            }
        }
        out
    }
}

/// Velocities and accelerations at the stages of a step.
type Stages<const N: usize, V> = [([V; N], [V; N]); 4];

/// What a step is computed in. It is room for many steps: to clear it takes time at each, and what a call returns is copied.
#[derive(Clone, Debug)]
pub(crate) struct Workspace<const N: usize, V> {
    pub(crate) room: Room<N, V>,
    held: Held<N, V>,
    stages: Stages<N, V>,
    stages_of_part: Stages<N, V>,
    taken_at_start: [V; N],
    change: [V; N],
    divided: State<N, V>,
}

impl<const N: usize, V: Lane> Workspace<N, V> {
    /// Before the first step.
    #[inline(always)]
    pub(crate) fn nothing(zero: V) -> Self {
        let zeros = [zero; N];
        let stages = [(zeros, zeros); 4];
        Self {
            room: Room::nothing(zero),
            held: Held::nothing(zero),
            stages,
            stages_of_part: stages,
            taken_at_start: zeros,
            change: zeros,
            divided: State { q: zeros, v: zeros },
        }
    }
}

#[inline(always)]
pub(crate) fn along<const N: usize, V: Lane>(x: &[V; N], slope: &[V; N], h: V) -> [V; N] {
    let mut out = *x;
    for i in 0..N {
        out[i] = x[i] + h * slope[i];
    }
    out
}

/// The state after a step of length `h`, by velocities and accelerations at its stages.
#[inline(always)]
pub(crate) fn after<const N: usize, V: Lane>(y: &State<N, V>, stages: &Stages<N, V>, h: V) -> State<N, V> {
    let [(v1, a1), (v2, a2), (v3, a3), (v4, a4)] = stages;
    let (sixth, two) = (h * h.splat(1.0 / 6.0), h.splat(2.0));
    let mut next = *y;
    for i in 0..N {
        next.q[i] = y.q[i] + sixth * (v1[i] + two * (v2[i] + v3[i]) + v4[i]);
        next.v[i] = y.v[i] + sixth * (a1[i] + two * (a2[i] + a3[i]) + a4[i]);
    }
    next
}

/// The state after a step of length `h` by the midpoint rule.
#[inline(always)]
pub(crate) fn after_middle<const N: usize, V: Lane>(y: &State<N, V>, middle: &([V; N], [V; N]), h: V) -> State<N, V> {
    State { q: along(&y.q, &middle.0, h), v: along(&y.v, &middle.1, h) }
}

/// `a` where `small < large`, otherwise `b`.
#[inline(always)]
fn choose<const N: usize, V: Lane>(small: V, large: V, a: &State<N, V>, b: &State<N, V>) -> State<N, V> {
    let mut out = *b;
    for i in 0..N {
        out.q[i] = small.less(large, a.q[i], b.q[i]);
        out.v[i] = small.less(large, a.v[i], b.v[i]);
    }
    out
}

/// By how much each speed may change in a step: half again as much as the acceleration at the beginning promises.
#[inline(always)]
fn changes<const N: usize, V: Lane>(a: &[V; N], dt: f64, out: &mut [V; N]) {
    for i in 0..N {
        out[i] = a[i].magnitude() * a[i].splat(1.5 * dt);
    }
}

/// How many parts a step needs, for each run, where speeds change by `change` and `turns` is 1 where friction may turn over.
#[inline(always)]
fn parts<const N: usize, V: Lane>(
    chain: &Chain<N>,
    y: &State<N, V>,
    (change, turns): (&[V; N], V),
    held: &Held<N, V>,
    dt: f64,
) -> V {
    let one = turns.splat(1.0);
    let rate = chain.forces.decay(&y.q, &y.v, change, &held.inverse);
    let needed = (rate * one.splat(dt / STIFFNESS) + one.splat(0.5)).nearest().smaller(one.splat(MOST_PARTS));
    // One where the acceleration is not a number: the caller finds the state not finite.
    one.splat(0.5).less(turns, one.less(needed, needed, one), one)
}

/// Of how many parts the half step that finds the middle has, by those of the step: `⌈parts / 2⌉`, which halves plus a quarter round to.
#[inline(always)]
pub(crate) fn parts_to_middle<V: Lane>(parts: V) -> V {
    (parts * parts.splat(0.5) + parts.splat(0.25)).nearest()
}

/// How many parts a step of one arm is divided into.
pub(crate) fn parts_of_step<const N: usize>(chain: &Chain<N>, y: &State<N, f64>, tau: &[f64; N], dt: f64) -> f64 {
    let mut room = Room::nothing(0.0);
    let mut change = *tau;
    changes(&chain.accelerate_alone(&y.q, &y.v, tau, &mut room), dt, &mut change);
    let turns = chain.forces.turns(&y.v, &change, REACH);
    if turns < 0.5 { 1.0 } else { parts(chain, y, (&change, turns), &Held::new(&room.rigid, tau), dt) }
}

/// The state `divided` after `length` in equal parts, as many as each run needs, from a state at which friction takes what it took at the
/// start: by the midpoint rule where it is `to_middle`, else by the method of order 4.
#[inline(always)]
fn in_parts<const N: usize, V: Lane>(
    chain: &Chain<N>,
    Workspace { room, held, stages_of_part: stages, taken_at_start, divided: y, .. }: &mut Workspace<N, V>,
    start: &State<N, V>,
    (length, parts): (f64, V),
    to_middle: bool,
) {
    let h = parts.splat(length).over(parts);
    let (taken, mut done, most) = (&mut room.taken, 0.0, parts.most());
    for i in 0..N {
        (taken[i], y.q[i], y.v[i]) = (taken_at_start[i], start.q[i], start.v[i]);
    }
    while done < most {
        let (mut q, mut v) = (y.q, y.v);
        for stage in 0..if to_middle { 2 } else { 4 } {
            let is_known = stage == 0 && done == 0.0;
            if !is_known {
                chain.forces.torque(&q, &v, taken);
            }
            let a = held.accelerations(taken);
            // One by one they are stored from registers, both together by a call.
            stages[stage].0 = v;
            stages[stage].1 = a;
            let ahead = if stage < 2 { h * h.splat(0.5) } else { h };
            q = along(&y.q, &v, ahead);
            v = along(&y.v, &a, ahead);
        }
        let next = if to_middle { after_middle(y, &stages[1], h) } else { after(y, stages, h) };
        // A run that has had all its parts waits for the others.
        *y = choose(h.splat(done), parts, &next, y);
        done += 1.0;
    }
}

/// Steps one arm by `dt` under held torque; compiled once for all that step arms one by one.
#[inline(never)]
pub(crate) fn step_alone<const N: usize>(
    chain: &Chain<N>,
    y: &mut State<N, f64>,
    tau: &[f64; N],
    dt: f64,
    workspace: &mut Workspace<N, f64>,
) {
    step(chain, y, tau, dt, workspace);
}

/// Where the rigid part is evaluated after the four stages of a step that is not divided.
const MIDDLE: usize = 4;

/// Steps every run by `dt` under held torque. Evaluations are a loop, so that the equations of motion, which are all inlined,
/// are compiled once and not at each of them.
#[inline(always)]
pub(crate) fn step<const N: usize, V: Sines>(
    chain: &Chain<N>,
    y: &mut State<N, V>,
    tau: &[V; N],
    dt: f64,
    workspace: &mut Workspace<N, V>,
) {
    let one = tau[0].splat(1.0);
    let h = one.splat(dt);
    let (mut parts_of_runs, mut some_whole, mut some_divided) = (one, true, false);
    let (mut q, mut v) = (y.q, y.v);
    for evaluation in 0..=MIDDLE {
        if evaluation == MIDDLE {
            if !some_divided {
                break;
            }
            (q, v) = (workspace.divided.q, workspace.divided.v);
        } else if evaluation > 0 && !some_whole {
            continue;
        }
        let Workspace { room, held, stages, taken_at_start, change, .. } = &mut *workspace;
        chain.parts(&q, &v, room, evaluation < MIDDLE);
        let mut turns = one;
        if evaluation < MIDDLE {
            let a = room.rigid.accelerations(tau, &room.taken);
            if evaluation == 0 {
                changes(&a, dt, change);
                turns = chain.forces.turns(&v, change, REACH);
                some_divided = turns.most() > 0.5;
            }
            stages[evaluation].0 = v;
            stages[evaluation].1 = a;
            let ahead = if evaluation < 2 { h * one.splat(0.5) } else { h };
            q = along(&y.q, &v, ahead);
            v = along(&y.v, &a, ahead);
        }
        if some_divided && (evaluation == 0 || evaluation == MIDDLE) {
            held.hold(&room.rigid, tau);
            let (mut length, mut parts_of_length) = (dt, parts_of_runs);
            if evaluation == 0 {
                *taken_at_start = room.taken;
                parts_of_runs = parts(chain, y, (change, turns), held, dt);
                some_divided = parts_of_runs.most() > 1.0;
                some_whole = (-parts_of_runs).most() == -1.0;
                (length, parts_of_length) = (0.5 * dt, parts_to_middle(parts_of_runs));
            }
            if some_divided {
                in_parts(chain, workspace, y, (length, parts_of_length), evaluation == 0);
            }
        }
    }
    let whole = after(y, &workspace.stages, h);
    *y = if some_divided { choose(one, parts_of_runs, &workspace.divided, &whole) } else { whole };
}

#[cfg(test)]
mod tests {
    use super::*;
    use armid::conformance::chains::{self, ChainRecipe};
    use armid::dynamics::Dynamics;
    use armid::seed::Seed;
    use nalgebra::DMatrix;

    #[test]
    fn identity_the_rate_of_friction_is_at_least_the_largest_eigenvalue_and_not_far_above() {
        const N: usize = 5;
        let (still, step) = ([0.0; N], 1e-7);
        for run in 0..8 {
            let mut rng = Seed::new(31).stream("friction", run);
            let recipe = ChainRecipe { coupled: run % 2 == 1, tilted: true, ..ChainRecipe::new(N) };
            let (robot, parameters) = recipe.draw(&mut rng);
            let (q, ..) = chains::random_state(&mut rng, N);
            let at: [f64; N] = std::array::from_fn(|i| q[i]);
            let chain = Chain::<N>::new(&robot, &parameters);
            let mut room = Room::nothing(0.0);
            chain.accelerate_alone(&at, &still, &still, &mut room);
            let rate = chain.forces.decay(&at, &still, &still, &Held::new(&room.rigid, &still).inverse);

            // Mass matrix and damping at standstill, column by column from the core's torques.
            let mut dynamics = Dynamics::new(&robot, &parameters);
            let mut torque = |speed: (usize, f64), acceleration: (usize, f64)| {
                let (mut qd, mut qdd, mut tau) = (still, still, vec![0.0; N]);
                (qd[speed.0], qdd[acceleration.0]) = (speed.1, acceleration.1);
                dynamics.inverse(&at, &qd, &qdd, &mut tau);
                tau
            };
            let rest = torque((0, 0.0), (0, 0.0));
            let mut mass = DMatrix::zeros(N, N);
            let mut damping = DMatrix::zeros(N, N);
            for j in 0..N {
                let (pushed, ahead, back) =
                    (torque((0, 0.0), (j, 1.0)), torque((j, step), (0, 0.0)), torque((j, -step), (0, 0.0)));
                for i in 0..N {
                    mass[(i, j)] = pushed[i] - rest[i];
                    damping[(i, j)] = (ahead[i] - back[i]) / (2.0 * step);
                }
            }
            let rates = (mass.try_inverse().unwrap() * damping).complex_eigenvalues();
            let largest = rates.iter().map(|rate| rate.norm()).fold(0.0, f64::max);
            let most = 2.0 * (N as f64).sqrt() * largest;
            assert!(rate > largest * (1.0 - 1e-5) && rate < most, "chain {run}: {rate} for {largest}");
        }
    }
}
