//! The torque of laws that drives have and models omit, along a measured motion.
//!
//! ```text
//! load friction      s |τ_l| sgn q̇            and s a sgn(τ_l q̇) τ_rms/2 a_rms where a rotor cannot be told from its link
//! current lag        T dτ/dt                   τ without Coulomb friction, whose jumps have no rate
//! elasticity         τ_l(x − (δ, δ̇, δ̈)) − τ_l(x)        δ = s τ_l/max|τ_l| at one joint
//! presliding         s Fc z        z ← sgn q̇ + (z − sgn q̇) exp(−|Δq|/d)        at three distances d
//! ```
//! τ_l is what the links take, by the estimate. A size of one is the realistic level of the effect.

use nalgebra::DMatrix;

use crate::dynamics::{Dynamics, States};
use crate::estimation::error::EstimationError;
use crate::estimation::load_friction::standard;
use crate::estimation::observation::Observation;
use crate::experiment::EffectKind;
use crate::model::term::{COULOMB, LOAD_FRICTION, ROTOR, VISCOUS};
use crate::model::{ParameterId, ParameterKind, Robot, StandardParameters};
use crate::signal::{Samples, differences, differences_periodic};

/// Distances of presliding, rad (m): half-decades about those of gears.
const DISTANCES: [f64; 3] = [0.003, 0.01, 0.03];
/// Friction that follows displacement, as a share of Coulomb friction.
const PRESLIDING_SHARE: f64 = 0.1;
/// A rotor's share of a load in which it is hidden: anywhere between none and all.
const HIDDEN_SHARE: f64 = 0.5;

/// One law, at the drives of an arm.
pub(super) struct Law {
    /// The effect.
    pub(super) effect: EffectKind,
    /// The level that a size of one stands for.
    pub(super) level: f64,
    /// Its unit; empty for a share.
    pub(super) unit: &'static str,
    /// Its torque, (n·M) × coefficients; zero in rows that are no equation.
    pub(super) columns: DMatrix<f64>,
}

impl Law {
    /// An effect at its realistic size.
    fn realistic(effect: EffectKind, columns: DMatrix<f64>) -> Self {
        Self { effect, level: effect.entry().realistic, unit: effect.entry().unit, columns }
    }
}

/// The motion, and torque that the estimate gives.
struct Motion<'a> {
    observation: &'a Observation,
    samples: &'a Samples,
    /// Without noise that differentiation would raise.
    states: States,
    parameters: StandardParameters,
    /// What the links take, N × n.
    load: Vec<f64>,
    /// That, and what rotors and viscous friction take.
    smooth: Vec<f64>,
}

/// The laws that the columns of the observation do not have, by the estimate `beta` (b).
///
/// # Errors
/// [`EstimationError`] where torque cannot be filtered as the measured one was.
pub(super) fn omitted(
    robot: &Robot,
    observation: &Observation,
    samples: &Samples,
    beta: &nalgebra::DVector<f64>,
) -> Result<Vec<Law>, EstimationError> {
    let n = observation.dof;
    let phi = standard(&observation.base, beta);
    let parameters = StandardParameters::from_vector(robot, observation.columns, &phi);
    let mut smooth_parameters = parameters.clone();
    for drive in &mut smooth_parameters.drives {
        *drive = drive.only(|term| term.is_inertia() || term == VISCOUS);
    }
    let states = samples.calm_states()?;
    let torque = |parameters: &StandardParameters| {
        let (mut arm, mut all) = (Dynamics::new(robot, parameters), vec![0.0; n * samples.len()]);
        for (k, tau) in all.chunks_exact_mut(n).enumerate() {
            arm.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
        }
        all
    };
    let (load, smooth) = (torque(&parameters.links_alone()), torque(&smooth_parameters));
    let motion = Motion { observation, samples, states, parameters, load, smooth };
    let mut laws = vec![motion.current_lag()?, motion.elasticity(robot), motion.presliding()?];
    if !observation.columns.has(LOAD_FRICTION) {
        laws.insert(0, motion.load_friction(robot)?);
    }
    Ok(laws)
}

impl Motion<'_> {
    fn load_friction(&self, robot: &Robot) -> Result<Law, EstimationError> {
        let (n, states) = (self.observation.dof, &self.states);
        let level = EffectKind::LoadFriction.entry().realistic;
        let mut columns = Vec::new();
        for (j, joint) in robot.joints().iter().enumerate() {
            let of = |x: &[f64], k: usize| x[k * n + j];
            let direction =
                |k: usize| of(&states.qd, k).signum() * soft(of(&states.qd, k), joint.drive.coulomb_velocity);
            let own = (0..states.len()).map(|k| level * of(&self.load, k).abs() * direction(k)).collect();
            columns.push((j, own));
            let rotor = ParameterId { kind: ParameterKind::Term(ROTOR), index: j };
            if !self.observation.base.kept.iter().any(|&at| self.observation.base.parameters[at] == rotor) {
                let rms = |x: &[f64]| ((0..states.len()).map(|k| of(x, k).powi(2)).sum::<f64>()).sqrt();
                let acceleration = rms(&states.qdd);
                let inertia = if acceleration > 0.0 { rms(&self.load) / acceleration } else { 0.0 };
                let scale = HIDDEN_SHARE * level * inertia;
                let hidden = |k: usize| scale * of(&states.qdd, k) * of(&self.load, k).signum() * direction(k);
                columns.push((j, (0..states.len()).map(hidden).collect()));
            }
        }
        Ok(Law::realistic(EffectKind::LoadFriction, self.of_joints(columns)?))
    }

    fn current_lag(&self) -> Result<Law, EstimationError> {
        let n = self.observation.dof;
        let level = EffectKind::CurrentLag.entry().realistic;
        let rate = self.rate(&self.smooth);
        let own = |j: usize| rate.iter().skip(j).step_by(n).map(|rate| 1e-3 * level * rate).collect();
        Ok(Law::realistic(EffectKind::CurrentLag, self.of_joints((0..n).map(|j| (j, own(j))))?))
    }

    fn elasticity(&self, robot: &Robot) -> Law {
        let (n, samples) = (self.observation.dof, self.samples);
        let level = EffectKind::Elasticity.entry().realistic;
        let most: Vec<f64> = (0..n)
            .map(|j| self.load.iter().skip(j).step_by(n).fold(0.0_f64, |most, load| most.max(load.abs())))
            .collect();
        let wound: Vec<f64> = self
            .load
            .iter()
            .enumerate()
            .map(|(at, load)| if most[at % n] > 0.0 { 1e-3 * level * load / most[at % n] } else { 0.0 })
            .collect();
        let first = self.rate(&wound);
        let second = self.rate(&first);
        let states = [&self.states.q, &self.states.qd, &self.states.qdd].map(|x| samples.block_means(x, n));
        let wound = [wound, first, second].map(|x| samples.block_means(&x, n));
        let mut links = Dynamics::new(robot, &self.parameters.links_alone());
        let mut columns = DMatrix::zeros(self.observation.y.len(), n);
        let (mut rigid, mut soft) = (vec![0.0; n], vec![0.0; n]);
        for block in 0..samples.blocks() {
            let row = block * n;
            let mut at = states.each_ref().map(|x| x[row..row + n].to_vec());
            links.inverse(&at[0], &at[1], &at[2], &mut rigid);
            for j in 0..n {
                for (x, wound) in at.iter_mut().zip(&wound) {
                    x[j] -= wound[row + j];
                }
                links.inverse(&at[0], &at[1], &at[2], &mut soft);
                for (x, states) in at.iter_mut().zip(&states) {
                    x[j] = states[row + j];
                }
                for i in (0..n).filter(|i| self.observation.used[row + i]) {
                    columns[(row + i, j)] = soft[i] - rigid[i];
                }
            }
        }
        Law::realistic(EffectKind::Elasticity, columns)
    }

    fn presliding(&self) -> Result<Law, EstimationError> {
        let n = self.observation.dof;
        let mut columns = Vec::new();
        for (j, drive) in self.parameters.drives.iter().enumerate() {
            let size = PRESLIDING_SHARE * drive[COULOMB].abs();
            let q: Vec<f64> = self.states.q.iter().skip(j).step_by(n).copied().collect();
            for distance in DISTANCES {
                let each = self.samples.experiments();
                let each = each.map(|(range, of)| displacement(&q[range], distance, of.period_s.is_some()));
                columns.push((j, each.flatten().map(|z| size * z).collect()));
            }
        }
        let level = PRESLIDING_SHARE;
        Ok(Law { effect: EffectKind::Presliding, level, unit: "", columns: self.of_joints(columns)? })
    }

    /// Columns of torque of one joint each, N, filtered as the measured torque was, means over blocks.
    fn of_joints(&self, columns: impl IntoIterator<Item = (usize, Vec<f64>)>) -> Result<DMatrix<f64>, EstimationError> {
        let n = self.observation.dof;
        let columns: Vec<_> = columns.into_iter().collect();
        let mut all = DMatrix::zeros(self.observation.y.len(), columns.len());
        for (c, (j, torque)) in columns.into_iter().enumerate() {
            let filtered = self.samples.filtered_as_torque(torque, 1)?;
            for (block, mean) in self.samples.block_means(&filtered, 1).into_iter().enumerate() {
                let row = block * n + j;
                if self.observation.used[row] {
                    all[(row, c)] = mean;
                }
            }
        }
        Ok(all)
    }

    /// Change with time of N × n numbers.
    fn rate(&self, x: &[f64]) -> Vec<f64> {
        let (n, step) = (self.observation.dof, 1.0 / self.samples.rate_hz);
        let mut rate = vec![0.0; x.len()];
        for j in 0..n {
            let own: Vec<f64> = x.iter().skip(j).step_by(n).copied().collect();
            let own = self.samples.experiments().flat_map(|(range, of)| {
                let own = &own[range];
                if of.period_s.is_some() { differences_periodic(own, step).0 } else { differences(own, step).0 }
            });
            for (to, own) in rate.iter_mut().skip(j).step_by(n).zip(own) {
                *to = own;
            }
        }
        rate
    }
}

/// The state z of presliding along positions of one joint, which may be a period.
fn displacement(q: &[f64], distance: f64, is_periodic: bool) -> Vec<f64> {
    let Some(&last) = q.last() else { return Vec::new() };
    let mut z = 0.0_f64;
    let mut slide = |k: usize| {
        let moved = match k.checked_sub(1) {
            Some(before) => q[k] - q[before],
            None if is_periodic => q[k] - last,
            None => 0.0,
        };
        let sliding = if moved == 0.0 { 0.0 } else { moved.signum() };
        z = sliding + (z - sliding) * libm::exp(-moved.abs() / distance);
        z
    };
    if is_periodic {
        // Once around, so that the period begins as it ends.
        for k in 0..q.len() {
            slide(k);
        }
    }
    (0..q.len()).map(slide).collect()
}

/// How much of Coulomb friction there is at a speed.
fn soft(speed: f64, onset: f64) -> f64 {
    if onset > 0.0 { libm::tanh(speed.abs() / onset) } else { f64::from(u8::from(speed != 0.0)) }
}
