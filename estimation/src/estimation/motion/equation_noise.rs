//! Noise of the equations that errors of the measured motion make.
//!
//! ```text
//! ε_k ← ε_k + Σ_j (a_jk ė_jk + b_jk ë_jk)        a_j = ∂τ/∂q̇_j, b_j = ∂τ/∂q̈_j
//! R(l) = Σ_j (mean_k a_jk a_jkᵀ) Σ_h p_jh ω_h² cos(2π h l/M) + (mean_k b_jk b_jkᵀ) Σ_h p_jh ω_h⁴ cos(2π h l/M)
//! ```
//! p_jh is the power of the error of joint j's position at harmonic h, in the mean over one of M blocks. In the band that positions are kept
//! in it is the noise. What the encoder's rounding does again in each period is in it, so that this noise need not scatter over periods.
//! Beyond the band the error is the motion itself, which is left out. It equals the noise at the end of the band. Friction that reverses
//! makes steps of the acceleration, so from there on its power falls with the sixth power of h.
//!
//! Errors of velocity and acceleration are not correlated at one instant. At others their products cancel in each joint's own covariance,
//! and are left out. So is the error of the position itself, over which gravity hardly changes.
//!
//! Tests of laws need it, as columns of laws are made of the same motion. Weights and intervals go by the scatter over periods alone.
//!
//! Source: R. Pintelon, J. Schoukens, *System Identification*, Wiley, 2012, chapter 8, for errors of a measured input as noise of the
//! equations.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::dynamics::States;
use crate::estimation::observation::Observation;
use crate::linalg::product;
use crate::model::Robot;
use crate::regressor::JointTorqueRegressor;
use crate::signal::{JoinedExperiment, NoiseModel, Samples};

/// Blocks at which torque is differentiated by the motion, at most.
const PLACES: usize = 256;

/// One joint's part.
struct JointErrors {
    /// Powers of the velocity and of the acceleration at each harmonic, from the first on.
    powers: Vec<[f64; 2]>,
    /// Means of a aᵀ and of b bᵀ, n × n.
    squares: [DMatrix<f64>; 2],
}

/// That noise of the torque that the parameters `beta` (b) give along the samples, each experiment one period; `None` where the noise of the
/// positions' harmonics is not known. Of experiments that are joined it is the mean.
pub(in crate::estimation) fn motion_noise(
    robot: &Robot,
    observation: &Observation,
    samples: &Samples,
    beta: &DVector<f64>,
) -> Option<NoiseModel> {
    if samples.blocks() != observation.samples() {
        return None;
    }
    let of = |(range, of)| MotionErrors::new(&TorqueSlopes::new(robot, observation, samples, beta, range), &of);
    let each: Vec<MotionErrors> = samples.experiments().map(of).collect::<Option<_>>()?;
    let all: usize = each.iter().map(|of| of.cosines.len()).sum();
    let shortest = each.iter().map(|of| of.cosines.len()).min()?;
    let lag = |l: usize| {
        let parts = each.iter().map(|of| of.lag(l) * (of.cosines.len() as f64 / all as f64));
        parts.fold(DMatrix::zeros(observation.dof, observation.dof), |sum, part| sum + part)
    };
    Some(NoiseModel::known(lag, shortest / 2))
}

/// What errors of the motion do in one experiment.
struct MotionErrors {
    joints: Vec<JointErrors>,
    /// cos(2π k/M) for each of M blocks.
    cosines: Vec<f64>,
}

impl MotionErrors {
    fn new(slopes: &TorqueSlopes<'_>, of: &JoinedExperiment) -> Option<Self> {
        let period_s = of.period_s?;
        let blocks = of.samples / slopes.block;
        if of.position_floor.len() != slopes.observation.dof || blocks == 0 {
            return None;
        }
        let joint = |j| {
            let powers = powers(of, slopes.block, period_s, j);
            let deviation = powers.iter().map(|power| power[0]).sum::<f64>().sqrt();
            JointErrors { powers, squares: slopes.squares(j, deviation) }
        };
        let cosine = |k| libm::cos(std::f64::consts::TAU * k as f64 / blocks as f64);
        let joints = (0..slopes.observation.dof).map(joint).collect();
        Some(Self { joints, cosines: (0..blocks).map(cosine).collect() })
    }

    fn lag(&self, l: usize) -> DMatrix<f64> {
        let mut sum: Option<DMatrix<f64>> = None;
        for joint in &self.joints {
            let mut shares = [0.0; 2];
            for (h, powers) in (1..).zip(&joint.powers) {
                let cosine = self.cosines[h * l % self.cosines.len()];
                shares[0] += powers[0] * cosine;
                shares[1] += powers[1] * cosine;
            }
            for (squares, share) in joint.squares.iter().zip(shares) {
                let part = squares * share;
                sum = Some(sum.map_or_else(|| part.clone(), |sum| sum + &part));
            }
        }
        sum.unwrap_or_default()
    }
}

/// Powers of the errors of a block's mean velocity and acceleration of joint j, at each harmonic.
fn powers(of: &JoinedExperiment, block: usize, period_s: f64, j: usize) -> Vec<[f64; 2]> {
    let block = block as f64;
    let last = of.position_band_hz[j] * period_s;
    (1..of.samples.div_ceil(2))
        .map(|h| {
            let left_out = if h as f64 > last { (last / h as f64).powi(6) } else { 1.0 };
            let phase = std::f64::consts::PI * h as f64 / of.samples as f64;
            let mean = libm::sin(phase * block) / (block * libm::sin(phase));
            // A line of amplitude A has the power A²/2.
            let position = 0.5 * of.position_floor[j] * left_out * mean * mean;
            let square = (std::f64::consts::TAU * h as f64 / period_s).powi(2);
            [position * square, position * square * square]
        })
        .collect()
}

/// Torque along some of the blocks, by parameters, and how it changes with the motion.
struct TorqueSlopes<'a> {
    observation: &'a Observation,
    regressor: JointTorqueRegressor,
    beta: &'a DVector<f64>,
    /// Samples in a block.
    block: usize,
    /// Which blocks.
    places: Vec<usize>,
    /// Their states, each at the middle of its block.
    states: States,
}

impl<'a> TorqueSlopes<'a> {
    /// Along the blocks of a range of samples.
    fn new(
        robot: &Robot,
        observation: &'a Observation,
        samples: &Samples,
        beta: &'a DVector<f64>,
        range: Range<usize>,
    ) -> Self {
        let blocks = range.start / samples.block..range.end / samples.block;
        let step = blocks.len().div_ceil(PLACES).max(1);
        let places: Vec<usize> = blocks.step_by(step).collect();
        let mut states = States::new(observation.dof);
        for place in &places {
            let k = place * samples.block + samples.block / 2;
            states.push(samples.states.q(k), samples.states.qd(k), samples.states.qdd(k));
        }
        Self { observation, regressor: observation.joint_regressor(robot), beta, block: samples.block, places, states }
    }

    /// Means of a aᵀ and b bᵀ of joint j, n × n, by errors of its velocity with this deviation: what they do also where friction bends.
    fn squares(&self, j: usize, deviation: f64) -> [DMatrix<f64>; 2] {
        let moved = |velocity: f64, acceleration: f64| {
            let (n, mut states) = (self.states.dof, self.states.clone());
            states.qd.iter_mut().skip(j).step_by(n).for_each(|qd| *qd += velocity);
            states.qdd.iter_mut().skip(j).step_by(n).for_each(|qdd| *qdd += acceleration);
            let w = self.regressor.stack_means(&states, &self.observation.base.kept, 1);
            product(&w, &DMatrix::from_column_slice(self.beta.len(), 1, self.beta.as_slice()))
        };
        if deviation == 0.0 {
            let n = self.observation.dof;
            return [DMatrix::zeros(n, n), DMatrix::zeros(n, n)];
        }
        let by_velocity = (moved(deviation, 0.0) - moved(-deviation, 0.0)) / (2.0 * deviation);
        let by_acceleration = moved(0.0, 0.5) - moved(0.0, -0.5);
        [by_velocity, by_acceleration].map(|slope| self.mean_square(slope.as_slice()))
    }

    /// Mean of x_k x_kᵀ of vectors stacked one after the other, over the equations.
    fn mean_square(&self, x: &[f64]) -> DMatrix<f64> {
        let n = self.observation.dof;
        let (mut sum, mut count) = (DMatrix::<f64>::zeros(n, n), DMatrix::<f64>::zeros(n, n));
        for (x, place) in x.chunks_exact(n).zip(&self.places) {
            let used = &self.observation.used[place * n..(place + 1) * n];
            for a in (0..n).filter(|&a| used[a]) {
                for b in (0..n).filter(|&b| used[b]) {
                    sum[(a, b)] += x[a] * x[b];
                    count[(a, b)] += 1.0;
                }
            }
        }
        let shared = |a: usize, b: usize| (count[(a, a)] * count[(b, b)]).sqrt().max(1.0);
        DMatrix::from_fn(n, n, |a, b| sum[(a, b)] / shared(a, b))
    }
}
