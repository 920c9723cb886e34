//! The search for the speeds at which friction falls, as the module of [`StribeckSpeeds`](super::StribeckSpeeds) states it: damped
//! Gauss–Newton on the projected equations.

use super::linear_fit::LinearFit;
use super::stribeck_columns::{JointColumns, StribeckColumns};
use super::{EstimationError, EstimationProblem, Factorisation, Observation, Termination};
use crate::linalg::BlockWhitening;
use crate::signal::Samples;
use crate::statistics::student_quantile;

/// Gauss–Newton steps at most.
const ITERATIONS: usize = 100;
/// Relative change of the speeds at which the search has come to rest. The step from there is taken too.
const AT_REST: f64 = 1e-6;
/// Halvings of a step at most.
const HALVINGS: usize = 20;
/// A step changes a speed by no more than this factor.
const LARGEST_FACTOR: f64 = 3.0;
/// Multiples of the start at which the search may begin.
const STARTS: [f64; 4] = [1.0 / 9.0, 1.0 / 3.0, 3.0, 9.0];
/// Times that weights by the residual are found again.
const REWEIGHTED: usize = 10;
/// A value with its standard deviation and 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SpeedValue {
    /// The value.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// What the equations say of speeds.
pub(super) struct FoundSpeeds {
    /// Speed and amplitude of each joint that is sought.
    pub(super) values: Vec<Option<[SpeedValue; 2]>>,
    /// Independent samples behind their standard deviations.
    pub(super) degrees_of_freedom: f64,
}

/// The minimum of ρ over the speeds that are sought.
pub(super) struct Search<'a> {
    observation: &'a Observation,
    samples: &'a Samples,
    columns: &'a StribeckColumns,
    /// Σ; that of the first fit until then.
    weights: Option<BlockWhitening>,
    /// Of which joints.
    pub(super) sought: Vec<bool>,
}

impl<'a> Search<'a> {
    /// Over the speeds of all joints.
    pub(super) fn new(observation: &'a Observation, samples: &'a Samples, columns: &'a StribeckColumns) -> Self {
        Self { observation, samples, columns, weights: None, sought: vec![true; columns.joints.len()] }
    }

    /// Σ by the fit at these speeds; as it was where the residual of an exact fit has no covariance.
    fn weigh(&mut self, speeds: &[f64]) -> Result<BlockWhitening, EstimationError> {
        let observation = self.columns.at(self.observation, speeds);
        let found = LinearFit::weighted(&Factorisation::new(&observation)?);
        let weights = match (found, &self.weights) {
            (Ok(LinearFit { weights: Some(weights), .. }), _) => weights,
            (_, Some(weights)) => weights.clone(),
            (Err(error), None) => return Err(error),
            (Ok(_), None) => return Err(EstimationError::NotDefinite),
        };
        self.weights = Some(weights.clone());
        Ok(weights)
    }

    /// From the start to rest, and again with weights by the residual.
    pub(super) fn ended(&mut self, kept: &[f64]) -> Result<(Vec<f64>, Termination), EstimationError> {
        let mut weights = self.weigh(kept)?;
        let mut speeds = self.start(kept)?;
        let (mut steps, mut repeated) = (0, 0);
        loop {
            let before = speeds.clone();
            let ended = self.descend(&mut speeds, &weights, &mut steps)?;
            let moved = before.iter().zip(&speeds).map(|(a, b)| (b / a - 1.0).abs()).fold(0.0, f64::max);
            repeated += 1;
            let is_measured = self.observation.noise.is_some();
            if is_measured || moved <= AT_REST || repeated > REWEIGHTED || !ended.was_successful() {
                return Ok((speeds, ended));
            }
            weights = self.weigh(&speeds)?;
        }
    }

    /// ρ at these speeds.
    pub(super) fn misfit(&self, speeds: &[f64]) -> Result<f64, EstimationError> {
        let Some(weights) = &self.weights else { return Err(EstimationError::NotDefinite) };
        let observation = self.columns.at(self.observation, speeds);
        let equations = Factorisation::new(&observation)?;
        LinearFit::with_weights(&equations, weights.clone())?.misfit(&observation)
    }

    /// The best of the multiples of the speeds of the robot file, joint by joint.
    fn start(&self, kept: &[f64]) -> Result<Vec<f64>, EstimationError> {
        let (mut best, mut speeds) = (self.misfit(kept)?, kept.to_vec());
        for (i, of) in self.columns.joints.iter().enumerate().filter(|(i, _)| self.sought[*i]) {
            for multiple in STARTS {
                let mut other = speeds.clone();
                other[i] = (multiple * kept[i]).clamp(of.bounds[0], of.bounds[1]);
                // A column of which nothing is left is no start.
                let misfit = self.misfit(&other).unwrap_or(f64::INFINITY);
                if misfit < best {
                    (best, speeds) = (misfit, other);
                }
            }
        }
        Ok(speeds)
    }

    /// The step of ln v at these speeds.
    fn step(&self, speeds: &[f64], weights: &BlockWhitening) -> Result<Vec<f64>, EstimationError> {
        let observation = self.columns.at(self.observation, speeds);
        let equations = Factorisation::new(&observation)?;
        let fit = LinearFit::with_weights(&equations, weights.clone())?.fit;
        let extended = self.columns.with_slopes(&observation, speeds, fit.solution(), &self.sought);
        let fit = Factorisation::new(&extended)?.weighted(weights)?;
        let mut last = fit.solution().iter().skip(self.observation.base.rank());
        Ok(self.sought.iter().map(|&sought| if sought { last.next().copied().unwrap_or(0.0) } else { 0.0 }).collect())
    }

    /// These speeds after a part of a step, within bounds.
    fn moved(&self, speeds: &[f64], step: &[f64], part: f64) -> Vec<f64> {
        let largest = libm::log(LARGEST_FACTOR);
        let one = |i: usize| speeds[i] * libm::exp(part * step[i].clamp(-largest, largest));
        let within = |(i, of): (usize, &JointColumns)| one(i).clamp(of.bounds[0], of.bounds[1]);
        self.columns.joints.iter().enumerate().map(within).collect()
    }

    /// Damped Gauss–Newton with fixed weights.
    fn descend(
        &self,
        speeds: &mut Vec<f64>,
        weights: &BlockWhitening,
        iterations: &mut usize,
    ) -> Result<Termination, EstimationError> {
        let (mut rho, mut last_step) = (self.misfit(speeds)?, f64::INFINITY);
        while *iterations < ITERATIONS {
            *iterations += 1;
            let Ok(step) = self.step(speeds, weights) else {
                return Ok(Termination::Singular { iterations: *iterations });
            };
            let whole = self.moved(speeds, &step, 1.0);
            last_step = speeds.iter().zip(&whole).map(|(a, b)| (b / a - 1.0).abs()).fold(0.0, f64::max);
            if last_step <= AT_REST {
                *speeds = whole;
                return Ok(Termination::Converged { iterations: *iterations, last_step });
            }
            let mut lower = None;
            for halving in 0..HALVINGS {
                let tried = self.moved(speeds, &step, 0.5_f64.powi(halving as i32));
                let misfit = self.misfit(&tried).unwrap_or(f64::INFINITY);
                if misfit < rho {
                    lower = Some((tried, misfit));
                    break;
                }
            }
            let Some((tried, misfit)) = lower else {
                return Ok(Termination::Stalled { iterations: *iterations, last_step });
            };
            (*speeds, rho) = (tried, misfit);
        }
        Ok(Termination::IterationLimit { iterations: *iterations, last_step })
    }

    /// Speed and amplitude of each joint that is sought, by the estimate of (β, ln v) at these speeds.
    pub(super) fn values(&self, speeds: &[f64]) -> Result<FoundSpeeds, EstimationError> {
        let Some(weights) = &self.weights else { return Err(EstimationError::NotDefinite) };
        let observation = self.columns.at(self.observation, speeds);
        let equations = Factorisation::new(&observation)?;
        let beta = LinearFit::with_weights(&equations, weights.clone())?.fit;
        let extended = self.columns.with_slopes(&observation, speeds, beta.solution(), &self.sought);
        let equations = Factorisation::new(&extended)?;
        let linear = LinearFit::with_weights(&equations, weights.clone())?;
        let problem = EstimationProblem::new(&extended).with_samples(self.samples).with_factorisation(&equations);
        let estimate = linear.estimate("wls", &problem, &linear.fit, Termination::Direct)?;
        let t = student_quantile(0.975, estimate.degrees_of_freedom);
        let mut logarithms = estimate.base.iter().skip(self.observation.base.rank());
        let value = |(i, of): (usize, &JointColumns)| {
            let std = if self.sought[i] { logarithms.next()?.std } else { return None };
            let v = speeds[i];
            let speed = SpeedValue { value: v, std: v * std, ci95: [v * libm::exp(-t * std), v * libm::exp(t * std)] };
            let amplitude = &estimate.base[of.columns[0].place];
            let amplitude = SpeedValue { value: amplitude.value, std: amplitude.std, ci95: amplitude.ci95 };
            Some([speed, amplitude])
        };
        let values = self.columns.joints.iter().enumerate().map(value).collect();
        Ok(FoundSpeeds { values, degrees_of_freedom: estimate.degrees_of_freedom })
    }
}
