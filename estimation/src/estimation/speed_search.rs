//! The search for the speeds of laws of friction, as the module of [`FrictionSpeeds`](super::FrictionSpeeds) states it: damped
//! Gauss–Newton on the projected equations.

use std::ops::ControlFlow;

use nalgebra::{DMatrix, DVector, QR};

use super::error::EstimationError;
use super::factorisation::Factorisation;
use super::linear_fit::LinearFit;
use super::measured::Measured;
use super::observation::Observation;
use super::problem::EstimationProblem;
use super::speed_columns::SpeedColumns;
use super::termination::Termination;
use crate::linalg::{BlockWhitening, LeastSquares};
use crate::observer::{Observer, Progress, Work};
use crate::signal::Samples;
use crate::statistics::student_quantile;

/// Gauss–Newton steps at most.
const ITERATIONS: usize = 100;
/// Relative change of the speeds at which the search has come to rest. The step from there is taken too.
const AT_REST: f64 = 1e-6;
/// Relative change of the speeds at which the search has come to rest where no part of the step lowers ρ.
const HIDDEN_BY_ROUNDING: f64 = 1e-4;
/// Halvings of a step at most.
const HALVINGS: usize = 20;
/// A step changes a speed by no more than this factor.
const LARGEST_FACTOR: f64 = 3.0;
/// Multiples of the stated speed at which the search may begin; of the largest speed where none is stated.
const STARTS: [f64; 4] = [1.0 / 9.0, 1.0 / 3.0, 3.0, 9.0];
const STARTS_OF_LARGEST: [f64; 4] = [0.01, 0.03, 0.1, 0.3];
/// Times that weights by the residual are found again.
const REWEIGHTED: usize = 10;
/// Relative change of the speeds at which weights by the residual have come to rest.
const WEIGHTS_AT_REST: f64 = 1e-4;

/// What the equations say of speeds.
pub(super) struct FoundSpeeds {
    /// Speed and amplitude of each joint that is sought.
    pub(super) values: Vec<Option<[Measured; 2]>>,
    /// Independent samples behind their standard deviations.
    pub(super) degrees_of_freedom: f64,
}

/// Weighted equations without what the columns explain that do not move with the speeds, so that a step costs those that do alone.
struct Projected {
    weights: BlockWhitening,
    used: Vec<bool>,
    /// Orthonormal columns of what does not move, n·M × as many.
    q: DMatrix<f64>,
    y: DVector<f64>,
}

impl Projected {
    /// All columns but those at some places.
    fn of(observation: &Observation, moving: &[usize], weights: BlockWhitening) -> Result<Self, EstimationError> {
        let still: Vec<usize> = (0..observation.base.rank()).filter(|place| !moving.contains(place)).collect();
        let used = observation.used.clone();
        let rows = observation.y.len();
        let white = weights.clone().whiten(&observation.regressor.select_columns(&still), &used)?;
        let q = if still.is_empty() { white } else { QR::new(white).q() };
        let mut projected = Self { weights, used, q, y: DVector::zeros(rows) };
        let y = DMatrix::from_column_slice(rows, 1, observation.y.as_slice());
        projected.y = projected.project(&y)?.column(0).into_owned();
        Ok(projected)
    }

    /// Σ^{-½} columns (n·M) without what does not move explains of them.
    fn project(&self, columns: &DMatrix<f64>) -> Result<DMatrix<f64>, EstimationError> {
        let mut white = self.weights.clone().whiten(columns, &self.used)?;
        let share = self.q.tr_mul(&white);
        white -= &self.q * share;
        Ok(white)
    }
}

/// Seeks the minimum of ρ over the speeds of some joints.
pub(super) struct Search<'a> {
    observation: &'a Observation,
    samples: &'a Samples,
    columns: &'a SpeedColumns<'a>,
    /// Σ, and the equations without what its columns that do not move explain; those of the first fit until then.
    projected: Option<Projected>,
    /// Of which joints.
    sought: Vec<bool>,
    observer: &'a dyn Observer,
}

impl<'a> Search<'a> {
    /// Over the speeds of the joints that are sought.
    pub(super) fn new(
        observation: &'a Observation,
        samples: &'a Samples,
        columns: &'a SpeedColumns<'a>,
        sought: &[bool],
        observer: &'a dyn Observer,
    ) -> Self {
        Self { observation, samples, columns, projected: None, sought: sought.to_vec(), observer }
    }

    /// Σ by the fit at these speeds; as it was where the residual of an exact fit has no covariance.
    fn weigh(&mut self, speeds: &[f64]) -> Result<(), EstimationError> {
        let observation = self.columns.observation_at(self.observation, speeds);
        let found = LinearFit::weighted(&Factorisation::new(&observation)?);
        let weights = match (found, &self.projected) {
            (Ok(LinearFit { weights: Some(weights), .. }), _) => weights,
            (_, Some(_)) => return Ok(()),
            (Err(error), None) => return Err(error),
            (Ok(_), None) => return Err(EstimationError::NotDefinite),
        };
        self.projected = Some(Projected::of(self.observation, &self.columns.places(), weights)?);
        Ok(())
    }

    fn projected(&self) -> Result<&Projected, EstimationError> {
        self.projected.as_ref().ok_or(EstimationError::NotDefinite)
    }

    /// From the start to rest, and again with weights by the residual.
    pub(super) fn ended(&mut self, kept: &[f64]) -> Result<(Vec<f64>, Termination), EstimationError> {
        self.weigh(kept)?;
        let mut speeds = self.start(kept)?;
        let (mut steps, mut repeated) = (0, 0);
        loop {
            let before = speeds.clone();
            let ended = self.descend(&mut speeds, &mut steps)?;
            let moved = change(&before, &speeds);
            repeated += 1;
            let is_measured = self.observation.noise.is_some();
            if is_measured || moved <= WEIGHTS_AT_REST || repeated > REWEIGHTED || !ended.was_successful() {
                return Ok((speeds, ended));
            }
            self.weigh(&speeds)?;
        }
    }

    /// Asks the observer whether the search goes on.
    fn go_on(&self, done: usize, total: usize) -> Result<(), EstimationError> {
        match self.observer.observe(Progress { work: Work::Steps, done, total }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(EstimationError::Interrupted),
        }
    }

    /// ρ at these speeds.
    pub(super) fn misfit(&self, speeds: &[f64]) -> Result<f64, EstimationError> {
        let projected = self.projected()?;
        let columns = projected.project(&self.columns.matrix(self.observation, speeds))?;
        let fit = LeastSquares::solve(&columns, &projected.y)?;
        Ok((&projected.y - columns * fit.solution()).norm_squared())
    }

    /// The best of the multiples of the speeds of the robot file, joint by joint.
    fn start(&self, kept: &[f64]) -> Result<Vec<f64>, EstimationError> {
        let mut speeds = self.moved(kept, &vec![0.0; kept.len()], 0.0);
        let mut best = self.misfit(&speeds).unwrap_or(f64::INFINITY);
        for (i, of) in self.columns.joints.iter().enumerate().filter(|(i, _)| self.sought[*i]) {
            self.go_on(i, self.sought.len())?;
            let [least, largest] = of.bounds;
            let (starts, unit) = if kept[i] > least { (STARTS, kept[i]) } else { (STARTS_OF_LARGEST, largest) };
            for multiple in starts {
                let mut other = speeds.clone();
                other[i] = (multiple * unit).clamp(least, largest);
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
    fn step(&self, speeds: &[f64]) -> Result<Vec<f64>, EstimationError> {
        let projected = self.projected()?;
        let own = projected.project(&self.columns.matrix(self.observation, speeds))?;
        let fit = LeastSquares::solve(&own, &projected.y)?;
        let places = self.columns.places();
        let beta = |place| places.iter().position(|own| *own == place).map_or(0.0, |at| fit.solution()[at]);
        let slopes = projected.project(&self.columns.slopes(self.observation, speeds, beta, &self.sought))?;
        let mut all = own.resize_horizontally(places.len() + slopes.ncols(), 0.0);
        all.columns_mut(places.len(), slopes.ncols()).copy_from(&slopes);
        let fit = LeastSquares::solve(&all, &projected.y)?;
        let mut last = fit.solution().iter().skip(places.len());
        Ok(self.sought.iter().map(|&sought| if sought { last.next().copied().unwrap_or(0.0) } else { 0.0 }).collect())
    }

    /// These speeds after a part of a step; those that are sought within bounds.
    fn moved(&self, speeds: &[f64], step: &[f64], part: f64) -> Vec<f64> {
        let largest = libm::log(LARGEST_FACTOR);
        let one = |i: usize| speeds[i] * libm::exp(part * step[i].clamp(-largest, largest));
        let within = |i: usize| one(i).clamp(self.columns.joints[i].bounds[0], self.columns.joints[i].bounds[1]);
        (0..speeds.len()).map(|i| if self.sought[i] { within(i) } else { speeds[i] }).collect()
    }

    /// Damped Gauss–Newton with fixed weights.
    fn descend(&self, speeds: &mut Vec<f64>, iterations: &mut usize) -> Result<Termination, EstimationError> {
        let (mut rho, mut last_step) = (self.misfit(speeds)?, f64::INFINITY);
        while *iterations < ITERATIONS {
            self.go_on(*iterations, ITERATIONS)?;
            *iterations += 1;
            let Ok(step) = self.step(speeds) else {
                return Ok(Termination::Singular { iterations: *iterations });
            };
            let whole = self.moved(speeds, &step, 1.0);
            last_step = change(speeds, &whole);
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
                // Rounding of ρ hides what such a step gains.
                return Ok(if last_step <= HIDDEN_BY_ROUNDING {
                    Termination::Converged { iterations: *iterations, last_step }
                } else {
                    Termination::Stalled { iterations: *iterations, last_step }
                });
            };
            (*speeds, rho) = (tried, misfit);
        }
        Ok(Termination::IterationLimit { iterations: *iterations, last_step })
    }

    /// Speed and amplitude of each joint that is sought, by the estimate of (β, ln v) on `observation`, the equations at these speeds.
    pub(super) fn values(&self, speeds: &[f64], observation: &Observation) -> Result<FoundSpeeds, EstimationError> {
        let weights = &self.projected()?.weights;
        let equations = Factorisation::new(observation)?;
        let beta = LinearFit::with_weights(&equations, weights.clone())?.fit;
        let extended = self.columns.with_slopes(observation, speeds, beta.solution(), &self.sought);
        let equations = Factorisation::new(&extended)?;
        let linear = LinearFit::with_weights(&equations, weights.clone())?;
        let problem = EstimationProblem {
            samples: Some(self.samples),
            factorisation: Some(&equations),
            ..EstimationProblem::new(&extended)
        };
        let estimate = linear.estimate("wls", &problem, &linear.fit, Termination::Direct)?;
        let t = student_quantile(0.975, estimate.degrees_of_freedom);
        let mut logarithms = estimate.base.iter().skip(self.observation.base.rank());
        let value = |(i, of): (usize, &super::speed_columns::JointColumns)| {
            let std = if self.sought[i] { logarithms.next()?.std } else { return None };
            let v = speeds[i];
            let speed = Measured { value: v, std: v * std, ci95: [v * libm::exp(-t * std), v * libm::exp(t * std)] };
            let amplitude = &estimate.base[of.columns[0].place];
            let amplitude = Measured { value: amplitude.value, std: amplitude.std, ci95: amplitude.ci95 };
            Some([speed, amplitude])
        };
        let values = self.columns.joints.iter().enumerate().map(value).collect();
        Ok(FoundSpeeds { values, degrees_of_freedom: estimate.degrees_of_freedom })
    }
}

/// Largest relative change of a speed; none of one that stays.
pub(super) fn change(before: &[f64], after: &[f64]) -> f64 {
    let pairs = before.iter().zip(after).filter(|(before, after)| before != after);
    pairs.map(|(before, after)| (after / before - 1.0).abs()).fold(0.0, f64::max)
}
