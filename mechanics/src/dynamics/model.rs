//! A robot with its parameters, ready to be evaluated.

use nalgebra::{DMatrix, Vector3};

use super::articulated::{self, ArticulatedJoint};
use super::chain::Links;
use super::composite;
use super::inverse::{self, Carried};

use super::link_pose::LinkPose;
use super::torque_terms::{TermState, TorqueTerms};
use super::turns::Turns;
use crate::model::{Columns, Robot, StandardParameters};
use crate::spatial::{Inertia, Motion};

/// Repetitions after which an acceleration under load-dependent friction is given up.
const MOST_REPETITIONS: usize = 200;

/// The equations of motion of one robot with one set of parameters. Holds its workspace, so that no evaluation
/// allocates; clone it to use it on several threads.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::chains;
/// use armid::dynamics::Dynamics;
/// use armid::model::StandardParameters;
/// use armid::spatial::Inertia;
/// use nalgebra::{Matrix3, Vector3};
/// // A point mass of 2 kg at the end of the first link, 0.4 m from the shoulder, held horizontally.
/// let robot = chains::planar_2r();
/// let mut parameters = StandardParameters::zero(2);
/// parameters.links[0] = Inertia::from_com(2.0, Vector3::zeros(), Matrix3::zeros());
/// let mut tau = [0.0; 2];
/// Dynamics::new(&robot, &parameters).inverse(&[0.0; 2], &[0.0; 2], &[0.0; 2], &mut tau);
/// assert!((tau[0] - 2.0 * 9.81 * 0.4).abs() < 1e-12 && tau[1].abs() < 1e-12);
/// ```
#[derive(Clone, Debug)]
pub struct Dynamics {
    pub(super) poses: Vec<LinkPose>,
    pub(super) axes: Vec<Motion>,
    pub(super) links: Vec<Inertia>,
    pub(super) terms: TorqueTerms,
    /// See [`TorqueTerms::values`].
    pub(super) term_values: Vec<f64>,
    /// Acceleration of the base: minus gravity.
    pub(super) base_acceleration: Motion,
    /// The terms' part in the mass matrix, row-major n × n.
    pub(super) term_inertia: Vec<f64>,
    coupled: bool,
    chain: Links,
    turns: Turns,
    /// Pose of each joint's frame, and the force that its link takes.
    carried: Vec<Carried<f64>>,
    articulated: Vec<ArticulatedJoint>,
    composite: composite::Workspace,
    /// Diagonal of `term_inertia`.
    rotors: Vec<f64>,
    term_torque: Vec<f64>,
    zeros: Vec<f64>,
    load: Vec<f64>,
    estimate: Vec<f64>,
}

impl Dynamics {
    /// The equations of motion of `robot` with these parameters.
    ///
    /// # Panics
    /// If the parameters are not those of as many links and drives as the robot has.
    pub fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let n = robot.dof();
        assert!(
            parameters.links.len() == n && parameters.drives.len() == n,
            "parameters of {} links and {} drives, expected {n}",
            parameters.links.len(),
            parameters.drives.len()
        );
        let terms = TorqueTerms::new(robot, Columns::default().with_terms_of(parameters)).acting(parameters);
        let term_values = terms.values(parameters);
        let term_inertia = terms.inertia(parameters);
        let chain = Links::new(robot, &parameters.links);
        Self {
            coupled: robot.coupling().is_some(),
            rotors: term_inertia.diagonal().iter().copied().collect(),
            term_inertia: term_inertia.transpose().as_slice().to_vec(),
            articulated: articulated::workspace(&chain.links),
            composite: composite::Workspace::new(n),
            carried: inverse::workspace(n, 0.0),
            turns: Turns::new(n),
            chain,
            term_torque: vec![0.0; n],
            zeros: vec![0.0; n],
            load: vec![0.0; n],
            estimate: vec![0.0; n],
            poses: robot.joints().iter().map(LinkPose::new).collect(),
            axes: robot.axes().to_vec(),
            links: parameters.links.clone(),
            terms,
            term_values,
            base_acceleration: Motion::new(Vector3::zeros(), -robot.gravity()),
        }
    }

    /// Number of joints n.
    pub fn dof(&self) -> usize {
        self.poses.len()
    }

    /// Joint efforts that produce an acceleration: recursive Newton–Euler, `O(n)`.
    ///
    /// ```text
    /// v_i = X_i v_{i-1} + S_i q̇_i                      a_i = X_i a_{i-1} + S_i q̈_i + v_i × S_i q̇_i
    /// f_i = I_i a_i + v_i ×* I_i v_i + X_{i+1}ᵀ f_{i+1}      (radkhah2007 eq. 3)
    /// τ_i = S_iᵀ f_i + τ_terms,i                             (radkhah2007 eq. 2)
    /// ```
    /// `q`, `qd`, `qdd` in rad, rad/s, rad/s² and `tau` in N·m, n each (m and N for a prismatic joint). Featherstone,
    /// table 5.1, in frames that stand on the joints.
    ///
    /// # Panics
    /// If a slice is shorter than n.
    pub fn inverse(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        self.inverse_of_links(q, qd, qdd, tau);
        self.add_terms(q, qd, qdd, &mut tau[..self.poses.len()]);
    }

    /// Joint efforts of many samples, several at once: bit by bit what [`Self::inverse`] gives of each. `q`, `qd`, `qdd` and `tau` are
    /// N × n row-major.
    ///
    /// # Panics
    /// If they are not as long as each other, or not those of whole samples.
    pub fn inverse_of_samples(&mut self, samples: [&[f64]; 3], tau: &mut [f64]) {
        let n = self.dof();
        assert_eq!(tau.len(), samples[0].len(), "one place for each effort");
        inverse::efforts_of(&self.chain, samples, tau);
        if self.terms.acts() {
            for (k, tau) in tau.chunks_exact_mut(n).enumerate() {
                let [q, qd, qdd] = samples.map(|x| &x[k * n..(k + 1) * n]);
                self.add_terms(q, qd, qdd, tau);
            }
        }
    }

    /// The efforts that the links alone take, without any term.
    #[inline]
    fn inverse_of_links(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        self.turns.take(&self.chain.links, q);
        let (turns, carried) = (&self.turns, &mut self.carried);
        let motion = |i: usize| ([q[i], qd[i], qdd[i]], turns.sine_and_cosine(i));
        inverse::efforts(&self.chain, carried, motion, |i, effort| tau[i] = effort);
    }

    /// Adds the terms to the torque `tau` that the links take.
    #[inline]
    fn add_terms(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        let n = self.dof();
        let load: &[f64] = if self.terms.needs_load {
            self.load.copy_from_slice(tau);
            &self.load
        } else {
            &[]
        };
        let state = TermState { q: &q[..n], qd: &qd[..n], qdd: &qdd[..n], load };
        self.terms.add_torque(&self.term_values, &state, tau);
    }

    /// Joint accelerations that efforts produce: `H(q) q̈ = τ − c(q, q̇) − g(q) − τ_terms`.
    ///
    /// By [`forward_composite`](Self::forward_composite) up to eleven joints and where motors are coupled, else by
    /// [`forward_articulated`](Self::forward_articulated): the faster of the two (`benches/dynamics.rs`). `q`, `qd` in rad,
    /// rad/s, `tau` in N·m, `qdd` in rad/s², n each. Not a number where friction that depends on the load is so strong
    /// that no acceleration is consistent with it.
    ///
    /// # Panics
    /// If a slice is shorter than n.
    pub fn forward(&mut self, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        if self.dof() > 11 {
            self.forward_articulated(q, qd, tau, qdd);
        } else {
            self.forward_composite(q, qd, tau, qdd);
        }
    }

    /// Joint accelerations by the mass matrix of composite bodies and its `L D Lᵀ`, `O(n³)` with a small factor.
    ///
    /// # Panics
    /// If a slice is shorter than n.
    pub fn forward_composite(&mut self, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        self.solve(q, qd, tau, qdd, |this, qdd| {
            this.turns.take(&this.chain.links, q);
            let state = (q, qd, &this.turns);
            composite::accelerations(&this.chain, &mut this.composite, &this.term_inertia, state, qdd);
        });
    }

    /// Joint accelerations by articulated bodies, `O(n)`.
    ///
    /// Where motors are coupled the rotors' part `CᵀIaC` of the mass matrix is not diagonal: a rotor is then carried by
    /// no single joint, the recursion over single joints does not hold, and the mass matrix is used instead.
    ///
    /// # Panics
    /// If a slice is shorter than n.
    pub fn forward_articulated(&mut self, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        if self.coupled {
            return self.forward_composite(q, qd, tau, qdd);
        }
        self.solve(q, qd, tau, qdd, |this, qdd| {
            this.turns.take(&this.chain.links, q);
            let state = (q, qd, &this.turns);
            articulated::accelerations(&this.chain, &mut this.articulated, &this.rotors, state, qdd);
        });
    }

    /// Accelerations by `accelerate`, which turns the efforts that the terms leave into them.
    ///
    /// A term that depends on the torque that the links take depends on the acceleration that is sought. It is found by
    /// repetition: each step multiplies the error by about the coefficients' sum, far below 1 for any gear.
    #[inline]
    fn solve(
        &mut self,
        q: &[f64],
        qd: &[f64],
        tau: &[f64],
        qdd: &mut [f64],
        mut accelerate: impl FnMut(&mut Self, &mut [f64]),
    ) {
        self.load.fill(0.0);
        self.subtract_term_torque(q, qd, tau, qdd);
        accelerate(self, qdd);
        if !self.terms.needs_load {
            return;
        }
        for _ in 0..MOST_REPETITIONS {
            self.estimate.copy_from_slice(&qdd[..self.poses.len()]);
            let mut load = std::mem::take(&mut self.load);
            self.inverse_of_links(q, qd, qdd, &mut load);
            self.load = load;
            self.subtract_term_torque(q, qd, tau, qdd);
            accelerate(self, qdd);
            let size = qdd.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            if self.estimate.iter().zip(qdd.iter()).all(|(before, now)| (before - now).abs() <= 1e-14 * size) {
                return;
            }
        }
        // What did not settle is no acceleration: a plant or a caller finds that it is not finite.
        qdd[..self.poses.len()].fill(f64::NAN);
    }

    /// What the terms leave of the efforts `tau` at zero acceleration, under the transmitted torque found last.
    #[inline]
    fn subtract_term_torque(&mut self, q: &[f64], qd: &[f64], tau: &[f64], rest: &mut [f64]) {
        let n = self.dof();
        self.term_torque.fill(0.0);
        let load: &[f64] = if self.terms.needs_load { &self.load } else { &[] };
        let state = TermState { q: &q[..n], qd: &qd[..n], qdd: &self.zeros, load };
        self.terms.add_torque(&self.term_values, &state, &mut self.term_torque);
        for ((rest, tau), term) in rest[..n].iter_mut().zip(&tau[..n]).zip(&self.term_torque) {
            *rest = tau - term;
        }
    }

    /// The mass matrix `H(q)`, n × n, links by composite bodies plus rotors.
    ///
    /// # Panics
    /// If `q` is shorter than n.
    pub fn mass_matrix(&mut self, q: &[f64]) -> DMatrix<f64> {
        let n = self.dof();
        self.turns.take(&self.chain.links, q);
        composite::mass_matrix_at(&self.chain, &mut self.composite, q, &self.turns);
        DMatrix::from_fn(n, n, |i, j| self.composite.mass[i.max(j) * n + i.min(j)] + self.term_inertia[i * n + j])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{self, ChainRecipe};
    use crate::seed::Seed;
    use crate::trajectory::States;

    #[test]
    fn identity_many_samples_have_the_bits_of_each_alone() {
        for run in 0..20 {
            let mut rng = Seed::new(17).stream("chains", run);
            let dof = 1 + usize::try_from(run % 9).unwrap();
            let recipe = ChainRecipe { coupled: run % 2 == 0, tilted: run % 3 == 0, ..ChainRecipe::new(dof) };
            let (robot, mut parameters) = recipe.draw(&mut rng);
            if run % 4 == 0 {
                parameters = parameters.links_alone();
            }
            let mut dynamics = Dynamics::new(&robot, &parameters);
            let mut states = States::new(dof);
            for _ in 0..run {
                let (q, qd, qdd) = chains::random_state(&mut rng, dof);
                states.push(&q, &qd, &qdd);
            }
            let mut all = vec![f64::NAN; states.len() * dof];
            dynamics.inverse_of_samples(states.arrays(), &mut all);
            let mut alone = vec![0.0; dof];
            for (k, found) in all.chunks_exact(dof).enumerate() {
                dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut alone);
                assert_eq!(found, alone, "chain {run}, sample {k}");
            }
        }
    }

    #[test]
    fn identity_forward_dynamics_undoes_inverse_dynamics() {
        let seed = Seed::new(12);
        for run in 0..60 {
            let mut rng = seed.stream("chains", run);
            let dof = 1 + usize::try_from(run % 13).unwrap();
            let recipe = ChainRecipe { coupled: run % 2 == 0, tilted: run % 3 == 0, ..ChainRecipe::new(dof) };
            let (robot, parameters) = recipe.draw(&mut rng);
            let mut dynamics = Dynamics::new(&robot, &parameters);
            for _ in 0..10 {
                let (q, qd, qdd) = chains::random_state(&mut rng, dof);
                let [mut tau, mut a, mut b, mut c] = std::array::from_fn(|_| vec![0.0; dof]);
                dynamics.inverse(&q, &qd, &qdd, &mut tau);
                dynamics.forward_composite(&q, &qd, &tau, &mut a);
                dynamics.forward_articulated(&q, &qd, &tau, &mut b);
                dynamics.forward(&q, &qd, &tau, &mut c);
                assert!(c == a || c == b);
                for i in 0..dof {
                    // Rounding times the condition number of the mass matrix, at most some thousands.
                    assert!((a[i] - qdd[i]).abs() < 1e-9, "chain {run}: {a:?} {qdd:?}");
                    assert!((b[i] - qdd[i]).abs() < 1e-9, "chain {run}: {b:?} {qdd:?}");
                }
            }
        }
    }
}
