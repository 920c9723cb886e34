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

use super::body::BodyRegressor;
use super::body::Weights;
use super::joint_torque::JointTorqueRegressor;
use crate::dynamics::TermState;
use crate::spatial::{Force, Motion, Placement};

/// What the outward sweep leaves for one link.
#[derive(Clone, Copy)]
struct LinkState {
    placement: Placement,
    v: Motion,
    a: Motion,
    /// `X_k v_{k-1}` and `X_k a_{k-1}`.
    carried: (Motion, Motion),
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
        let link_weights = through_load.as_deref().unwrap_or(g);
        let mut links = Vec::with_capacity(n);
        // s_ik for i ≤ k, row k of a triangle.
        let mut axes: Vec<Motion> = Vec::with_capacity(n * (n + 1) / 2);
        let (mut v, mut a) = self.base_at_rest();
        for k in 0..n {
            let placement = self.poses[k].placement(q[k]);
            let axis = self.axes[k];
            let carried = (placement.motion_to_child(&v), placement.motion_to_child(&a));
            let rate = axis * qd[k];
            v = carried.0 + rate;
            a = carried.1 + axis * qdd[k] + v.cross(&rate);
            links.push(LinkState { placement, v, a, carried });
            let previous = axes.len() - k;
            for i in 0..k {
                axes.push(placement.motion_to_child(&axes[previous + i]));
            }
            axes.push(axis);
        }
        let (mut v_bar, mut a_bar) = (Force::zero(), Force::zero());
        let mut s_bar = vec![Force::zero(); n];
        for k in (0..n).rev() {
            let LinkState { placement, v, a, carried } = &links[k];
            let s = &axes[k * (k + 1) / 2..][..=k];
            let axis = &self.axes[k];
            let body = BodyRegressor::new(v, a);
            let mut weights = Weights::default();
            for i in 0..=k {
                let row = link_weights[i * p + 10 * k..].first_chunk().expect("a row holds ten columns per link");
                s_bar[i] += body.wrench(row);
                weights.add(&s[i], row);
            }
            let (by_v, by_a) = body.pull_back(&weights, v);
            v_bar += by_v;
            a_bar += by_a;
            // a_k holds v_k × S q̇: δv × S·ā = δv·(S ×* ā).
            let from_rate = axis.cross_force(&a_bar);
            dqd[k] += axis.dot(&v_bar) + v.dot(&from_rate);
            dqdd[k] += axis.dot(&a_bar);
            v_bar += from_rate * qd[k];
            let mut turn = carried.0.cross_force(&v_bar) + carried.1.cross_force(&a_bar);
            for i in 0..k {
                turn += s[i].cross_force(&s_bar[i]);
                s_bar[i] = placement.force_to_parent(&s_bar[i]);
            }
            dq[k] -= axis.dot(&turn);
            v_bar = placement.force_to_parent(&v_bar);
            a_bar = placement.force_to_parent(&a_bar);
        }
        self.terms.add_gradient(&state, 10 * n, p, g, [dq, dqd, dqdd, &mut vec![0.0; n]]);
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
}
