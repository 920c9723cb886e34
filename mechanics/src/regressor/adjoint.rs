//! Gradients of a weighted sum of regressor entries, in one sweep outwards and one inwards.
//!
//! ```text
//! L = Σ_ic g_ic Y_ic = Σ_k Σ_{i≤k} s_ikᵀ K(v_k, a_k) g_ik + terms        s_ik = X_ki S_i
//! ```
//! where `g_ik` are the ten weights of row i, link k, and K is the [regressor of one body](super::BodyRegressor). The
//! partial derivatives are
//!
//! ```text
//! ∂L/∂s_ik = K(v_k, a_k) g_ik        ∂L/∂(v_k, a_k) = ∂/∂(v_k, a_k) Σ_rc P_rc K_rc(v_k, a_k),   P = Σ_{i≤k} s_ik g_ikᵀ
//! ```
//! They are carried inwards as forces, `m̄_{k-1} += X_kᵀ m̄_k`, through the recursions of `v`, `a` and `s`. Joint k turns all
//! that comes from further in, `∂(X_k m)/∂q_k = (X_k m) × S_k`, so with `(m × S)·m̄ = −S·(m ×* m̄)`
//!
//! ```text
//! ∂L/∂q_k = −S_k · (v' ×* v̄_k + a' ×* ā_k + Σ_{i<k} s_ik ×* s̄_ik)        v' = X_k v_{k-1},  a' = X_k a_{k-1}
//! ∂L/∂q̇_k = S_k · v̄_k + (v_k × S_k) · ā_k        ∂L/∂q̈_k = S_k · ā_k
//! ```
//! The cost is that of about four evaluations, for any number of columns. A term that depends on the torque that the
//! links take, `τ_t = Y_links φ_links`, adds its slope by it, times `φ_links`, to the weights of the links' columns.

use pulp::{Arch, Simd, WithSimd};

use super::body::{BodyRegressor, Weights};
use super::joint_torque::JointTorqueRegressor;
use super::part_weights::PartWeights;
use crate::dynamics::{TOGETHER, TermState, Together, samples_of};
use crate::lanes::{Lane, Wide};
use crate::spatial::{LaneForce, LaneMotion, LanePlacement};

/// What the outward sweep leaves for one link.
#[derive(Clone, Copy)]
struct LinkState<V> {
    placement: LanePlacement<V>,
    v: LaneMotion<V>,
    a: LaneMotion<V>,
    /// `X_k v_{k-1}` and `X_k a_{k-1}`.
    carried: (LaneMotion<V>, LaneMotion<V>),
}

/// Room for one pair of sweeps.
struct Workspace<V> {
    links: Vec<LinkState<V>>,
    /// s_ik for i ≤ k, row k of a triangle.
    axes: Vec<LaneMotion<V>>,
    s_bar: Vec<LaneForce<V>>,
}

impl<V: Lane> Workspace<V> {
    /// For n joints; `zero` says of how many samples.
    #[inline(always)]
    fn new(n: usize, zero: V) -> Self {
        let none = LaneMotion { ang: [zero; 3], lin: [zero; 3] };
        let placement = LanePlacement { axes: [[zero; 3]; 3], origin: [zero; 3] };
        Self {
            links: vec![LinkState { placement, v: none, a: none, carried: (none, none) }; n],
            axes: vec![none; n * (n + 1) / 2],
            s_bar: vec![LaneForce::zero(zero); n],
        }
    }
}

impl JointTorqueRegressor {
    /// Adds the gradient of `L = Σ_ic g_ic Y_ic(q, q̇, q̈)` with respect to positions, velocities and accelerations to
    /// `dq`, `dqd` and `dqdd` (n each).
    ///
    /// `g` is n × p row-major, as [`evaluate`](Self::evaluate) writes `Y`; the module's header has the equations.
    ///
    /// ```
    /// # use armid_mechanics as armid;
    /// use armid::chains;
    /// use armid::model::Columns;
    /// use armid::regressor::JointTorqueRegressor;
    /// // The effort of a body with the parameters g_i is linear in acceleration: the gradient is a mass matrix's row.
    /// let regressor = JointTorqueRegressor::new(&chains::planar_2r(), Columns::RIGID).unwrap();
    /// let mut g = vec![0.0; 2 * regressor.cols()];
    /// g[10] = 1.0; // row 1, m2: a unit mass at the tip, seen by the shoulder
    /// let (mut dq, mut dqd, mut dqdd) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    /// regressor.adjoint([&[0.0; 2]; 3], &g, [&mut dq, &mut dqd, &mut dqdd]);
    /// assert!((dqdd[0] - 0.7 * 0.7).abs() < 1e-15 && (dqdd[1] - 0.7 * 0.3).abs() < 1e-15);
    /// ```
    ///
    /// # Panics
    /// If a slice is shorter than n, or `g` than n·p.
    pub fn adjoint(&self, [q, qd, qdd]: [&[f64]; 3], g: &[f64], [dq, dqd, dqdd]: [&mut [f64]; 3]) {
        let (n, p) = (self.rows(), self.cols());
        let load = self.load_at(q, qd, qdd);
        let state = TermState { q: &q[..n], qd: &qd[..n], qdd: &qdd[..n], load: &load };
        let through_load = self.weights_through_load(&state, g);
        let of_links = through_load.as_deref().unwrap_or(g);
        self.sweep(
            &mut Workspace::new(n, 0.0),
            |k| [q[k], qd[k], qdd[k]],
            |at| of_links[at],
            |k, [by_q, by_qd, by_qdd]| {
                dq[k] += by_q;
                dqd[k] += by_qd;
                dqdd[k] += by_qdd;
            },
        );
        self.terms.add_gradient(&state, 10 * n, p, g, [dq, dqd, dqdd, &mut vec![0.0; n]]);
    }

    /// Adds the gradients of such a sum of each of many samples to `slopes`, several samples at once: bit by bit what [`Self::adjoint`] adds of
    /// each. `samples` and `slopes` are N × n row-major. `weights` writes those of a few samples, the same places each time; elsewhere they
    /// are zero.
    ///
    /// # Panics
    /// If they are not as long as each other, or not those of whole samples.
    pub fn adjoint_of_samples(
        &self,
        samples: [&[f64]; 3],
        mut weights: impl FnMut(&mut PartWeights),
        slopes: [&mut [f64]; 3],
    ) {
        let n = self.rows();
        let count = samples_of(n, samples);
        assert!(slopes.iter().all(|slopes| slopes.len() == n * count), "one place for each slope");
        if self.links.is_empty() {
            return Arch::new().dispatch(OfSamples { regressor: self, samples, weights, slopes });
        }
        let (mut part, mut g, [dq, dqd, dqdd]) =
            (PartWeights::new(self.rows(), self.cols()), vec![0.0; n * self.cols()], slopes);
        for k in 0..count {
            if k % TOGETHER == 0 {
                part.begin(k, count);
                weights(&mut part);
            }
            let own = k * n..(k + 1) * n;
            part.sample(k % TOGETHER, 0, &mut g);
            let slopes = [&mut dq[own.clone()], &mut dqd[own.clone()], &mut dqdd[own.clone()]];
            self.adjoint(samples.map(|x| &x[own.clone()]), &g, slopes);
        }
    }

    /// Both sweeps over the links. `state` gives coordinate, velocity and acceleration of a joint, `g` the weight at a place of the n × p;
    /// `put` takes the slopes by the three.
    #[inline(always)]
    fn sweep<V: Lane>(
        &self,
        Workspace { links, axes, s_bar }: &mut Workspace<V>,
        state: impl Fn(usize) -> [V; 3],
        g: impl Fn(usize) -> V,
        mut put: impl FnMut(usize, [V; 3]),
    ) {
        let (n, p) = (self.rows(), self.cols());
        let zero = state(0)[0].splat(0.0);
        let (v, a) = self.base_at_rest();
        let (mut v, mut a) = (LaneMotion::splat(zero, &v), LaneMotion::splat(zero, &a));
        for k in 0..n {
            let [q, qd, qdd] = state(k);
            let placement = self.poses[k].in_full(self.poses[k].turn(q));
            let axis = LaneMotion::splat(zero, &self.axes[k]);
            let carried = (placement.motion_to_child(&v), placement.motion_to_child(&a));
            let rate = axis.times(qd);
            v = carried.0.plus(&rate);
            a = carried.1.plus(&axis.times(qdd)).plus(&v.cross(&rate));
            links[k] = LinkState { placement, v, a, carried };
            let (before, own) = axes.split_at_mut(k * (k + 1) / 2);
            let before = &before[before.len() - k..];
            for i in 0..k {
                own[i] = placement.motion_to_child(&before[i]);
            }
            own[k] = axis;
        }
        let (mut v_bar, mut a_bar) = (LaneForce::zero(zero), LaneForce::zero(zero));
        s_bar.fill(v_bar);
        for k in (0..n).rev() {
            let LinkState { placement, v, a, carried } = &links[k];
            let qd = state(k)[1];
            let s = &axes[k * (k + 1) / 2..][..=k];
            let axis = LaneMotion::splat(zero, &self.axes[k]);
            let body = BodyRegressor::in_lanes(v, a);
            let mut weights = Weights::nothing(zero);
            for i in 0..=k {
                let mut row = [zero; 10];
                for c in 0..10 {
                    row[c] = g(i * p + 10 * k + c);
                }
                s_bar[i] = s_bar[i].plus(&body.wrench_in_lanes(&row));
                weights.add(&s[i], &row);
            }
            let (by_v, by_a) = body.pull_back(&weights, v);
            v_bar = v_bar.plus(&by_v);
            a_bar = a_bar.plus(&by_a);
            // a_k holds v_k × S q̇: δv × S·ā = δv·(S ×* ā).
            let from_rate = axis.cross_force(&a_bar);
            let (by_qd, by_qdd) = (axis.dot(&v_bar) + v.dot(&from_rate), axis.dot(&a_bar));
            v_bar = v_bar.plus(&from_rate.times(qd));
            let mut turn = carried.0.cross_force(&v_bar).plus(&carried.1.cross_force(&a_bar));
            for i in 0..k {
                turn = turn.plus(&s[i].cross_force(&s_bar[i]));
                s_bar[i] = placement.force_to_parent(&s_bar[i]);
            }
            put(k, [-axis.dot(&turn), by_qd, by_qdd]);
            v_bar = placement.force_to_parent(&v_bar);
            a_bar = placement.force_to_parent(&a_bar);
        }
    }

    /// The torque that the links take (n), where a term depends on it; else empty.
    ///
    /// # Panics
    /// If a slice is shorter than n.
    pub fn load_at(&self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        if self.links.is_empty() {
            return Vec::new();
        }
        let mut y = vec![0.0; self.rows() * self.cols()];
        self.evaluate(q, qd, qdd, &mut y);
        self.load(0..self.rows(), &y)
    }

    /// The weights with what the terms' slopes by the links' torque add to those of the links' columns; `None` where no term
    /// depends on it.
    fn weights_through_load(&self, state: &TermState<'_>, g: &[f64]) -> Option<Vec<f64>> {
        if self.links.is_empty() {
            return None;
        }
        let (n, p) = (self.rows(), self.cols());
        let [mut dq, mut dqd, mut dqdd, mut by_load] = std::array::from_fn(|_| vec![0.0; n]);
        self.terms.add_gradient(state, 10 * n, p, g, [&mut dq, &mut dqd, &mut dqdd, &mut by_load]);
        let mut weights = g[..n * p].to_vec();
        for (row, slope) in weights.chunks_exact_mut(p).zip(&by_load) {
            for (weight, phi) in row.iter_mut().zip(&self.links) {
                *weight += slope * phi;
            }
        }
        Some(weights)
    }
}

/// Several samples at once.
struct OfSamples<'a, F> {
    regressor: &'a JointTorqueRegressor,
    samples: [&'a [f64]; 3],
    weights: F,
    slopes: [&'a mut [f64]; 3],
}

impl<F: FnMut(&mut PartWeights)> WithSimd for OfSamples<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { regressor, samples, mut weights, slopes: [dq, dqd, dqdd] } = self;
        let (n, p) = (regressor.rows(), regressor.cols());
        let mut state = Together::new(n);
        let mut work = Workspace::new(n, Wide::new(simd, simd.splat_f64s(0.0)));
        let (mut part, mut found) = (PartWeights::new(n, p), vec![[[0.0; TOGETHER]; 3]; n]);
        // Laws of terms are evaluated sample by sample. None depends on the load here.
        let terms = p - 10 * n;
        let (mut of_terms, mut by_load) = (vec![0.0; n * terms], vec![0.0; n]);
        let all = samples_of(n, samples);
        for first in (0..all).step_by(TOGETHER) {
            let count = TOGETHER.min(all - first);
            state.fill(samples, first, 1, count);
            part.begin(first, all);
            weights(&mut part);
            for vector in 0..TOGETHER / S::F64_LANES {
                let at = |x: &[f64; TOGETHER]| Wide::new(simd, S::as_simd_f64s(x).0[vector]);
                regressor.sweep(
                    &mut work,
                    #[inline(always)]
                    |k| [at(&state.q[k]), at(&state.qd[k]), at(&state.qdd[k])],
                    #[inline(always)]
                    |place| at(part.line(place)),
                    #[inline(always)]
                    |k, slopes| {
                        for (to, slope) in found[k].iter_mut().zip(slopes) {
                            S::as_mut_simd_f64s(to).0[vector] = slope.x;
                        }
                    },
                );
            }
            for lane in 0..count {
                let own = (first + lane) * n..(first + lane + 1) * n;
                let slopes = [&mut dq[own.clone()], &mut dqd[own.clone()], &mut dqdd[own.clone()]];
                for (component, slopes) in slopes.into_iter().enumerate() {
                    for (slope, found) in slopes.iter_mut().zip(&found) {
                        *slope += found[component][lane];
                    }
                }
                if terms == 0 {
                    continue;
                }
                part.sample(lane, 10 * n, &mut of_terms);
                let [q, qd, qdd] = samples.map(|x| &x[own.clone()]);
                let slopes = [&mut dq[own.clone()], &mut dqd[own.clone()], &mut dqdd[own], &mut by_load];
                regressor.terms.add_gradient(&TermState { q, qd, qdd, load: &[] }, 0, terms, &of_terms, slopes);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{self, ChainRecipe};
    use crate::model::term::LOAD_FRICTION;
    use crate::model::{Columns, Robot, StandardParameters};
    use crate::seed::Seed;
    use rand::RngExt;

    struct Case {
        robot: Robot,
        parameters: StandardParameters,
        state: [Vec<f64>; 3],
        g: Vec<f64>,
    }

    /// Forty random chains of one to eight joints, revolute and prismatic, of either convention, coupled or not.
    fn cases(columns: Columns) -> impl Iterator<Item = Case> {
        (0..40).map(move |run| {
            let mut rng = Seed::new(21).stream("adjoint", run);
            let dof = 1 + usize::try_from(run % 8).unwrap();
            let recipe = ChainRecipe { coupled: run % 2 == 0, tilted: run % 3 == 0, ..ChainRecipe::new(dof) };
            let (robot, parameters) = recipe.draw(&mut rng);
            let (q, qd, qdd) = chains::random_state(&mut rng, dof);
            let g = (0..dof * columns.parameters(&robot).len()).map(|_| rng.random_range(-1.0..1.0)).collect();
            Case { robot, parameters, state: [q, qd, qdd], g }
        })
    }

    fn gradient(regressor: &JointTorqueRegressor, [q, qd, qdd]: &[Vec<f64>; 3], g: &[f64]) -> [Vec<f64>; 3] {
        let zeros = vec![0.0; q.len()];
        let mut d = [zeros.clone(), zeros.clone(), zeros];
        let [dq, dqd, dqdd] = &mut d;
        regressor.adjoint([q, qd, qdd], g, [dq, dqd, dqdd]);
        d
    }

    #[test]
    fn identity_gradient_is_central_differences_of_the_regressor() {
        let free = Columns::RIGID_ROTOR_FRICTION;
        for (columns, case) in
            [free, free.with_term(LOAD_FRICTION)].into_iter().flat_map(|c| cases(c).map(move |case| (c, case)))
        {
            let regressor = JointTorqueRegressor::with_load(&case.robot, columns, &case.parameters);
            let found = gradient(&regressor, &case.state, &case.g);
            let mut y = vec![0.0; case.g.len()];
            let mut value = |state: &[Vec<f64>; 3]| -> f64 {
                regressor.evaluate(&state[0], &state[1], &state[2], &mut y);
                y.iter().zip(&case.g).map(|(y, g)| y * g).sum()
            };
            for part in 0..3 {
                for j in 0..case.robot.dof() {
                    let mut along = |step: f64| {
                        let mut state = case.state.clone();
                        state[part][j] += step;
                        value(&state)
                    };
                    // Richardson: error h⁴ times a fifth derivative, which the Coulomb law makes large.
                    let h = 2e-4;
                    let wide = (along(2.0 * h) - along(-2.0 * h)) / (4.0 * h);
                    let narrow = (along(h) - along(-h)) / (2.0 * h);
                    let expected = (4.0 * narrow - wide) / 3.0;
                    let size = expected.abs().max(10.0);
                    assert!((found[part][j] - expected).abs() < 1e-7 * size, "{} {expected}", found[part][j]);
                }
            }
        }
    }

    #[test]
    fn identity_many_samples_have_the_bits_of_each_alone_on_every_width() {
        let free = Columns::RIGID_ROTOR_FRICTION;
        for (columns, case) in
            [free, free.with_term(LOAD_FRICTION)].into_iter().flat_map(|c| cases(c).map(move |case| (c, case)))
        {
            let (n, count) = (case.robot.dof(), 11);
            let regressor = JointTorqueRegressor::with_load(&case.robot, columns, &case.parameters);
            let mut rng = Seed::new(22).stream("adjoint", n as u64);
            let draw = |rng: &mut _| chains::random_state(rng, n * count);
            let (q, qd, qdd) = draw(&mut rng);
            let states = [&q[..], &qd, &qdd];
            let weights_of = |k: usize| -> Vec<f64> { case.g.iter().map(|g| (k as f64 - 4.5) * g).collect() };
            let weights = |part: &mut PartWeights| {
                (0..part.count).for_each(|k| part.put_sample(k, &weights_of(part.first + k)));
            };
            let mut expected = [vec![0.25; n * count], vec![0.5; n * count], vec![0.75; n * count]];
            let [mut wide, mut narrow] = [expected.clone(), expected.clone()];
            for k in 0..count {
                let own = k * n..(k + 1) * n;
                regressor.adjoint(
                    states.map(|x| &x[own.clone()]),
                    &weights_of(k),
                    expected.each_mut().map(|x| &mut x[own.clone()]),
                );
            }
            regressor.adjoint_of_samples(states, weights, wide.each_mut().map(Vec::as_mut_slice));
            assert_eq!(wide, expected);
            if regressor.links.is_empty() {
                let slopes = narrow.each_mut().map(Vec::as_mut_slice);
                Arch::Scalar.dispatch(OfSamples { regressor: &regressor, samples: states, weights, slopes });
                assert_eq!(narrow, expected);
            }
        }
    }
}
