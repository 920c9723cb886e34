//! The torque that expected effects add along one period of a motion, and its gradient.
//!
//! Every law is a function of the torque that the nominal parameters give (`τ`, and `τ_l` of the links alone), so that its
//! gradient by the motion is one [adjoint](JointTorqueRegressor::adjoint) of the nominal regressor, and one more at the
//! motion of the links where drives are elastic:
//!
//! ```text
//! Σ u·d:   Late    τ̄ = T Dᵀ u            Scaled    τ̄_j = share u_j          Terms    ∂d/∂(q, q̇, q̈) u,  τ̄_l = ∂d/∂τ_l u,  Warming is of speeds alone
//!          Elastic x' = x − (δ, δ̇, δ̈)    x̄' = ∂τ/∂x'ᵀ u      τ̄_l = −B (x̄'_q + Dᵀ x̄'_q̇ + Dᵀ Dᵀ x̄'_q̈)     τ̄ = −u
//! ```

use nalgebra::DMatrix;

use super::effect::{EffectLaw, ExpectedEffects};
use super::periodic_derivative::PeriodicDerivative;
use crate::dynamics::{States, TermState, TorqueTerms};
use crate::linalg::dot;
use crate::model::{Columns, Robot, StandardParameters};
use crate::regressor::{JointTorqueRegressor, PartWeights};

/// The terms of an effect, bound to a robot.
#[derive(Clone, Debug)]
struct BoundTerms {
    terms: TorqueTerms,
    /// Coefficients as the terms take them, and by column.
    values: Vec<f64>,
    by_column: Vec<f64>,
}

impl BoundTerms {
    fn new(robot: &Robot, drives: &[crate::model::DriveParameters]) -> Self {
        let parameters = StandardParameters { drives: drives.to_vec(), ..StandardParameters::zero(robot.dof()) };
        let terms = TorqueTerms::new(robot, Columns::RIGID.with_terms_of(&parameters));
        let by_column = terms.parameters().iter().map(|&id| parameters.get(id)).collect();
        Self { values: terms.values(&parameters), by_column, terms }
    }
}

/// Discrepancies of expected effects on motions with a number of samples of one period.
#[derive(Clone, Debug)]
pub struct EffectTorques {
    regressor: JointTorqueRegressor,
    /// Nominal parameters, and those of the links alone, p.
    phi: Vec<f64>,
    links: Vec<f64>,
    laws: Vec<EffectLaw>,
    /// Of the laws that are terms, in their order.
    terms: Vec<BoundTerms>,
    derivative: PeriodicDerivative,
    samples: usize,
    /// Torque of the last motion, of all parameters and of the links, N × n.
    torque: Vec<f64>,
    load: Vec<f64>,
}

impl EffectTorques {
    /// The torques in motions of `robot` with `samples` samples of a period of `period_s` s.
    pub fn new(robot: &Robot, expected: &ExpectedEffects, samples: usize, period_s: f64) -> Self {
        let nominal = &expected.nominal;
        let columns = Columns::RIGID_ROTOR_FRICTION.with_terms_of(nominal);
        let regressor = JointTorqueRegressor::with_load(robot, columns, nominal);
        let phi = nominal.vector(robot, columns).as_slice().to_vec();
        let rigid = 10 * robot.dof();
        let links = phi.iter().enumerate().map(|(c, &value)| if c < rigid { value } else { 0.0 }).collect();
        let laws: Vec<EffectLaw> = expected.effects.iter().map(|effect| effect.law.clone()).collect();
        let terms = laws.iter().filter_map(|law| match law {
            EffectLaw::Terms(drives) => Some(BoundTerms::new(robot, drives)),
            _ => None,
        });
        Self {
            terms: terms.collect(),
            derivative: PeriodicDerivative::new(samples, period_s),
            regressor,
            phi,
            links,
            laws,
            samples,
            torque: Vec::new(),
            load: Vec::new(),
        }
    }

    /// The discrepancies of each effect, by their numbers.
    pub fn effects(&self) -> Vec<std::ops::Range<usize>> {
        let mut next = 0;
        let joints = self.regressor.rows();
        let counted = self.laws.iter().map(|law| {
            let first = next;
            next += law.discrepancies(joints);
            first..next
        });
        counted.collect()
    }

    /// The discrepancies along a motion, (n N) × E: row k n + i is joint i at sample k, N·m (N).
    ///
    /// # Panics
    /// If there are not as many samples as it was made for.
    pub fn evaluate(&mut self, states: &States) -> DMatrix<f64> {
        assert_eq!(states.len(), self.samples, "samples of the motion");
        let n = self.regressor.rows();
        (self.torque, self.load) = self.torques(states);
        let effects = self.effects();
        let mut d = DMatrix::zeros(n * self.samples, effects.last().map_or(0, |last| last.end));
        let mut terms = self.terms.iter();
        for (law, own) in self.laws.iter().zip(effects) {
            let mut column = d.column_mut(own.start);
            match law {
                EffectLaw::Terms(_) => {
                    let bound = terms.next().expect("one for each law of terms");
                    for (k, tau) in column.as_mut_slice().chunks_exact_mut(n).enumerate() {
                        bound.terms.add_torque(&bound.values, &self.term_state(states, k), tau);
                    }
                }
                EffectLaw::Elastic { compliance, with_link } => {
                    let of_links = self.behind(states, compliance);
                    let (torque, load) = self.torques(&of_links);
                    for (row, out) in column.iter_mut().enumerate() {
                        let whole = torque[row] - self.torque[row];
                        *out = if with_link[row % n] { whole } else { load[row] - self.load[row] };
                    }
                }
                EffectLaw::Late(time) => {
                    for (out, rate) in column.iter_mut().zip(self.derivative.apply(&self.torque)) {
                        *out = time * rate;
                    }
                }
                EffectLaw::Warming(gears) => gears.add_torque(states, column.as_mut_slice()),
                EffectLaw::Scaled(share) => {
                    for (row, torque) in self.torque.iter().enumerate() {
                        d[(row, own.start + row % n)] = share * torque;
                    }
                }
            }
        }
        d
    }

    /// Adds the gradient of `Σ u ∘ d` with respect to the states of the last evaluation, which must be handed in again; `u`
    /// has the shape of d.
    pub fn pull_back(&self, states: &States, u: &DMatrix<f64>, slopes: &mut States) {
        let n = self.regressor.rows();
        // What the torque of all parameters, and of the links, is weighted by.
        let (mut by_torque, mut by_load) = (vec![0.0; n * self.samples], vec![0.0; n * self.samples]);
        let mut terms = self.terms.iter();
        for (law, own) in self.laws.iter().zip(self.effects()) {
            let first = u.column(own.start);
            let u_first = first.as_slice();
            match law {
                EffectLaw::Terms(_) => {
                    let bound = terms.next().expect("one for each law of terms");
                    let stride = bound.by_column.len();
                    let mut weights = vec![0.0; n * stride];
                    for k in 0..self.samples {
                        let range = k * n..(k + 1) * n;
                        for (row, &u) in weights.chunks_exact_mut(stride.max(1)).zip(&u_first[range.clone()]) {
                            for (weight, value) in row.iter_mut().zip(&bound.by_column) {
                                *weight = u * value;
                            }
                        }
                        let [q, qd, qdd] = slopes.sample_mut(k);
                        let by = [q, qd, qdd, &mut by_load[range]];
                        bound.terms.add_gradient(&self.term_state(states, k), 0, stride, &weights, by);
                    }
                }
                EffectLaw::Elastic { compliance, with_link } => {
                    let of_links = self.behind(states, compliance);
                    let part = |whole: bool| -> Vec<f64> {
                        let of = |(row, u): (usize, &f64)| if with_link[row % n] == whole { *u } else { 0.0 };
                        u_first.iter().enumerate().map(of).collect()
                    };
                    let (whole, alone) = (part(true), part(false));
                    let mut bent = States::with_len(n, self.samples);
                    self.add_adjoint(&of_links, &whole, &alone, &mut bent);
                    for (to, from) in [(&mut by_torque, &whole), (&mut by_load, &alone)] {
                        to.iter_mut().zip(from).for_each(|(to, from)| *to -= from);
                    }
                    let twice = self.derivative.transposed(&self.derivative.transposed(&bent.qdd));
                    let once = self.derivative.transposed(&bent.qd);
                    for (k, by_load) in by_load.chunks_exact_mut(n).enumerate() {
                        for (i, entry) in by_load.iter_mut().enumerate() {
                            let at = |j: usize| {
                                let row = k * n + j;
                                bent.q[row] + once[row] + twice[row]
                            };
                            // B is symmetric.
                            *entry -= (0..n).map(|j| compliance[(i, j)] * at(j)).sum::<f64>();
                        }
                    }
                    for (to, from) in
                        [(&mut slopes.q, &bent.q), (&mut slopes.qd, &bent.qd), (&mut slopes.qdd, &bent.qdd)]
                    {
                        to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
                    }
                }
                EffectLaw::Late(time) => {
                    for (to, rate) in by_torque.iter_mut().zip(self.derivative.transposed(u_first)) {
                        *to += time * rate;
                    }
                }
                EffectLaw::Warming(gears) => gears.pull_back(states, u_first, slopes),
                EffectLaw::Scaled(share) => {
                    for (row, to) in by_torque.iter_mut().enumerate() {
                        *to += share * u[(row, own.start + row % n)];
                    }
                }
            }
        }
        self.add_adjoint(states, &by_torque, &by_load, slopes);
    }

    /// The motion of the links behind springs, where the motors do this one.
    fn behind(&self, states: &States, compliance: &DMatrix<f64>) -> States {
        let n = states.dof;
        let mut bend = vec![0.0; self.load.len()];
        for (bend, load) in bend.chunks_exact_mut(n).zip(self.load.chunks_exact(n)) {
            for (i, bend) in bend.iter_mut().enumerate() {
                *bend = load.iter().enumerate().map(|(j, load)| compliance[(i, j)] * load).sum();
            }
        }
        let rate = self.derivative.apply(&bend);
        let second = self.derivative.apply(&rate);
        let less = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x - y).collect();
        States { dof: n, q: less(&states.q, &bend), qd: less(&states.qd, &rate), qdd: less(&states.qdd, &second) }
    }

    /// Torque by all parameters and by those of the links, N × n.
    fn torques(&self, states: &States) -> (Vec<f64>, Vec<f64>) {
        let (n, p) = (self.regressor.rows(), self.regressor.cols());
        let mut y = vec![0.0; n * p];
        let (mut torque, mut load) = (Vec::with_capacity(n * states.len()), Vec::with_capacity(n * states.len()));
        let rigid = 10 * n;
        for k in 0..states.len() {
            self.regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut y);
            for row in y.chunks_exact(p) {
                let links = dot(&row[..rigid], &self.phi[..rigid]);
                load.push(links);
                torque.push(links + dot(&row[rigid..], &self.phi[rigid..]));
            }
        }
        (torque, load)
    }

    fn term_state<'a>(&'a self, states: &'a States, k: usize) -> TermState<'a> {
        let n = states.dof;
        TermState { q: states.q(k), qd: states.qd(k), qdd: states.qdd(k), load: &self.load[k * n..(k + 1) * n] }
    }

    /// Adds the gradient of `Σ u·τ + Σ u_l·τ_l`.
    fn add_adjoint(&self, states: &States, by_torque: &[f64], by_load: &[f64], slopes: &mut States) {
        let n = self.regressor.rows();
        let weights = |part: &mut PartWeights| {
            for k in 0..part.count {
                for i in 0..n {
                    let at = (part.first + k) * n + i;
                    for (c, (phi, link)) in self.phi.iter().zip(&self.links).enumerate() {
                        part.line_mut(i, c)[k] = by_torque[at] * phi + by_load[at] * link;
                    }
                }
            }
        };
        self.regressor.adjoint_of_samples(states.arrays(), weights, slopes.arrays_mut());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::ChainRecipe;
    use crate::dynamics::Dynamics;
    use crate::excitation::{ExpectedEffect, WarmGear, WarmGears, radkhah2007_start};
    use crate::model::term::{LOAD_FRICTION, STRIBECK};
    use crate::seed::Seed;
    use crate::trajectory::PeriodicMotion;
    use rand::RngExt;

    const SAMPLES: usize = 64;
    const PERIOD_S: f64 = 4.0;

    /// A chain, coupled or not, whose reversals are slow, and a slow motion of it.
    fn case(coupled: bool) -> (Robot, StandardParameters, States) {
        let recipe = ChainRecipe { coupled, ..ChainRecipe::new(3) };
        let (robot, parameters) = recipe.draw(&mut Seed::new(71).stream("chains", 0));
        let robot = robot
            .with_joints(|joint| {
                joint.drive.coulomb_velocity = 0.3;
                joint.limits.position = (-2.0, 2.0);
                joint.limits.velocity = 1.5;
            })
            .unwrap();
        let start = radkhah2007_start(&robot, PERIOD_S, 2, Seed::new(71), 0).unwrap();
        (robot, parameters, start.sample(SAMPLES))
    }

    /// One gear at each joint, and one that two joints turn.
    fn warm_gears(n: usize) -> WarmGears {
        let speeds = DMatrix::from_fn(n + 1, n, |g, j| if g == j || g == n && j < 2 { 1.0 } else { 0.0 });
        let gear = WarmGear { viscous: 0.4, coulomb: 0.3, fade: 0.3, rise_per_watt: 0.5, lost: 0.2 };
        WarmGears { speeds, gears: vec![gear; n + 1] }
    }

    fn effects(n: usize) -> Vec<ExpectedEffect> {
        let effect = |name: &str, law| ExpectedEffect { name: name.to_owned(), law };
        let compliance = DMatrix::from_fn(n, n, |i, j| 1e-3 * if i == j { 1.0 } else { 0.1 });
        vec![
            effect("terms", EffectLaw::Terms(vec![[(LOAD_FRICTION, 0.05), (STRIBECK, 0.4)].into_iter().collect(); n])),
            effect("elastic", EffectLaw::Elastic { compliance, with_link: (0..n).map(|i| i == 1).collect() }),
            effect("late", EffectLaw::Late(2e-3)),
            effect("scaled", EffectLaw::Scaled(0.03)),
            effect("warming", EffectLaw::Warming(warm_gears(n))),
        ]
    }

    fn torque(robot: &Robot, parameters: &StandardParameters, states: &States) -> Vec<f64> {
        let mut dynamics = Dynamics::new(robot, parameters);
        let mut tau = vec![0.0; states.dof * states.len()];
        for (k, tau) in tau.chunks_exact_mut(states.dof).enumerate() {
            dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
        }
        tau
    }

    #[test]
    fn identity_terms_add_what_inverse_dynamics_adds_with_them() {
        for coupled in [false, true] {
            let (robot, parameters, states) = case(coupled);
            let expected = ExpectedEffects { nominal: parameters.clone(), effects: effects(3), are_carried: false };
            let d = EffectTorques::new(&robot, &expected, SAMPLES, PERIOD_S).evaluate(&states);
            let mut with = parameters.clone();
            for drive in &mut with.drives {
                drive[LOAD_FRICTION] += 0.05;
                drive[STRIBECK] += 0.4;
            }
            let (plain, with) = (torque(&robot, &parameters, &states), torque(&robot, &with, &states));
            for row in 0..d.nrows() {
                assert!((d[(row, 0)] - (with[row] - plain[row])).abs() < 1e-10, "{row}");
                assert!((d[(row, 3 + row % 3)] - 0.03 * plain[row]).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn analytic_links_behind_springs_take_the_torque_of_their_own_motion() {
        // From the other end: the links do a known motion, and their torque winds the springs in front of them.
        let (robot, parameters, of_links) = case(false);
        for (scale, most) in [(1.0, 0.15), (0.1, 0.015), (0.01, 0.0015)] {
            let error = elastic_error(&robot, &parameters, &of_links, scale);
            // To first order in the wind-up.
            assert!(error < most, "{scale}: {error}");
        }
    }

    /// Error of the law, relative, where springs are `scale` times as soft.
    fn elastic_error(robot: &Robot, parameters: &StandardParameters, of_links: &States, scale: f64) -> f64 {
        let n = robot.dof();
        let ExpectedEffect { law: EffectLaw::Elastic { compliance, .. }, .. } = effects(n).remove(1) else { panic!() };
        let compliance = compliance * scale;
        let load = torque(robot, &parameters.links_alone(), of_links);
        let start = radkhah2007_start(robot, PERIOD_S, 2, Seed::new(71), 0).unwrap();
        let wound = |t: f64| -> Vec<f64> {
            let state =
                |order: usize| -> Vec<f64> { (0..n).map(|j| start.curve(j, order).value(start.omega() * t)).collect() };
            let mut tau = vec![0.0; n];
            Dynamics::new(robot, &parameters.links_alone()).inverse(&state(0), &state(1), &state(2), &mut tau);
            (0..n).map(|i| (0..n).map(|j| compliance[(i, j)] * tau[j]).sum()).collect()
        };
        let mut motors = of_links.clone();
        for k in 0..SAMPLES {
            let (t, h) = (PERIOD_S * k as f64 / SAMPLES as f64, 2e-3);
            let at: Vec<Vec<f64>> = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|s| wound(t + s * h)).into();
            for j in 0..n {
                let x = |i: usize| at[i][j];
                motors.q[k * n + j] += x(2);
                motors.qd[k * n + j] += (8.0 * (x(3) - x(1)) - (x(4) - x(0))) / (12.0 * h);
                motors.qdd[k * n + j] += (16.0 * (x(3) + x(1)) - (x(4) + x(0)) - 30.0 * x(2)) / (12.0 * h * h);
            }
        }
        let law = EffectLaw::Elastic { compliance, with_link: vec![false; n] };
        let effects = vec![ExpectedEffect { name: "e".to_owned(), law }];
        let expected = ExpectedEffects { nominal: parameters.clone(), effects, are_carried: false };
        let d = EffectTorques::new(robot, &expected, SAMPLES, PERIOD_S).evaluate(&motors);
        let by_motors = torque(robot, &parameters.links_alone(), &motors);
        let exact: Vec<f64> = load.iter().zip(&by_motors).map(|(load, by_motors)| load - by_motors).collect();
        let size = exact.iter().map(|x| x * x).sum::<f64>().sqrt();
        let error = exact.iter().zip(d.column(0).iter()).map(|(x, d)| (x - d).powi(2)).sum::<f64>().sqrt();
        error / size
    }

    #[test]
    fn identity_gradient_is_central_differences() {
        for coupled in [false, true] {
            let (robot, parameters, states) = case(coupled);
            let expected = ExpectedEffects { nominal: parameters, effects: effects(3), are_carried: false };
            let mut torques = EffectTorques::new(&robot, &expected, SAMPLES, PERIOD_S);
            let mut rng = Seed::new(72).stream("weights", u64::from(coupled));
            let d = torques.evaluate(&states);
            let u = DMatrix::from_fn(d.nrows(), d.ncols(), |_, _| rng.random_range(-1.0..1.0));
            let mut slopes = States::with_len(3, SAMPLES);
            torques.pull_back(&states, &u, &mut slopes);
            let draw: [Vec<f64>; 3] =
                std::array::from_fn(|_| (0..3 * SAMPLES).map(|_| rng.random_range(-1.0..1.0)).collect());
            let expected: f64 = [&slopes.q, &slopes.qd, &slopes.qdd]
                .into_iter()
                .flatten()
                .zip(draw.iter().flatten())
                .map(|(slope, d)| slope * d)
                .sum();
            let mut at = |h: f64| {
                let moved = |x: &[f64], d: &[f64]| x.iter().zip(d).map(|(x, d)| x + h * d).collect();
                let (q, qd, qdd) =
                    (moved(&states.q, &draw[0]), moved(&states.qd, &draw[1]), moved(&states.qdd, &draw[2]));
                torques.evaluate(&States { dof: 3, q, qd, qdd }).component_mul(&u).sum()
            };
            let h = 1e-4;
            let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            assert!((difference - expected).abs() < 1e-6 * expected.abs().max(1.0), "{difference} {expected}");
        }
    }
}
