//! The speed at which friction falls: Stribeck velocities, which enter the equations in another way than in proportion.
//!
//! ```text
//! y = W(v) β + ε        v_S,i = v_i of joint i        min over v of ρ(v) = min over β of ‖Σ^{-½}(y − W(v) β)‖²
//! y ≈ W(v) β + Σ_i D_i δ_i        D_i = φ_i ∂w_i/∂ln v_i = φ_i 2 (q̇_i/v_i)² w_i        v_i ← v_i exp(α δ_i)
//! ```
//! Variable projection: β is solved again for every v, and Gauss–Newton moves v alone. The derivative of each Stribeck column, times
//! the amplitude φ_i that the fit has at v, is one column more; its coefficient δ_i is the step of ln v_i. α is halved until ρ falls. The search
//! begins with the speeds of the robot file or with those multiples of them by 3 and 9 that have a lower ρ, joint by joint, and keeps
//! between a thousandth of a joint's largest speed (or half of the lowest speed among its equations, where that is more) and the
//! largest. At the minimum δ = 0, and the covariance of the same equations is that of (β, ln v): with the correlation of the noise and the
//! [`discrepancy`](super::discrepancy) that any weighted estimate has. Intervals are those of ln v_i, so that their ends are positive.
//!
//! Weights are the scatter over periods; where there is none, the residual of the fit, found again at the speeds that came out.
//!
//! A speed exists where there is friction that falls. Where the amplitude of a joint is not told from zero at 0.1 % over all joints (stricter
//! than 5 %, since the largest of many speeds' amplitudes is tested), where ln v_i has a standard deviation above a half, or where the search ended at
//! a bound, the joint is undecided: it keeps the speed of the robot file, and the others are sought again without it.
//!
//! Assumes exact states. Fails where equations are left out below a speed of the size of v_i: what is left of the column is then alike for
//! many speeds. A minimum is a local one, beyond those starting points.
//!
//! References: G. H. Golub, V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least squares problems whose variables
//! separate", SIAM J. Numer. Anal. 10(2), 1973; L. Kaufman, "A variable projection method for solving separable nonlinear least squares
//! problems", BIT 15, 1975, for the derivative that leaves out how β moves.

use super::linear_fit::LinearFit;
use super::stribeck_columns::{JointColumns, StribeckColumns};
use super::{Estimate, EstimationError, EstimationProblem, Factorisation, Observation, Termination};
use crate::linalg::BlockWhitening;
use crate::model::Robot;
use crate::model::term::Stribeck;
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
/// Level of the test that an amplitude is not zero, over all joints.
const LEVEL: f64 = 0.001;
/// Largest standard deviation of the logarithm of a speed that is one.
const LARGEST_STD: f64 = 0.5;

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

/// Friction that falls as one joint starts to move.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct StribeckSpeed {
    /// Joint, from one.
    pub joint: usize,
    /// The speed of the robot file, rad/s (m/s).
    pub stated: f64,
    /// The speed that was found, rad/s (m/s); `None` where the data do not decide it.
    pub speed: Option<SpeedValue>,
    /// Static above Coulomb friction, N·m (N), its standard deviation with that of the speed; `None` as above.
    pub amplitude: Option<SpeedValue>,
}

/// The speeds of all joints that have a Stribeck column.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct StribeckSpeeds {
    /// Joint by joint.
    pub joints: Vec<StribeckSpeed>,
    /// √(ρ/equations) by the speeds of the robot file, each joint's within its bounds, and by those found, with the same weights.
    pub weighted_rms: [f64; 2],
    /// How the search ended.
    pub termination: Termination,
}

impl StribeckSpeeds {
    /// Joints, from one, whose speed the data do not decide.
    #[must_use]
    pub fn undecided(&self) -> Vec<usize> {
        self.joints.iter().filter(|joint| joint.speed.is_none()).map(|joint| joint.joint).collect()
    }

    /// The robot with the speeds that were found.
    ///
    /// # Panics
    /// If the robot has fewer joints than this is of.
    #[must_use]
    pub fn robot(&self, robot: &Robot) -> Robot {
        let mut drives: Vec<_> = robot.joints().iter().map(|joint| joint.drive.clone()).collect();
        for joint in &self.joints {
            if let Some(speed) = joint.speed {
                drives[joint.joint - 1].shapes.insert(Stribeck::VELOCITY.key.to_owned(), speed.value);
            }
        }
        robot.clone().with_drives(drives)
    }
}

/// The speeds of the Stribeck columns of an observation, `None` where it has none.
pub(super) fn stribeck_speeds(
    robot: &Robot,
    observation: &Observation,
    samples: &Samples,
) -> Result<Option<StribeckSpeeds>, EstimationError> {
    let columns = StribeckColumns::of(robot, observation, samples);
    if columns.joints.is_empty() {
        return Ok(None);
    }
    let stated: Vec<f64> =
        columns.joints.iter().map(|of| robot.joints()[of.joint].drive.shape(&Stribeck::VELOCITY)).collect();
    let kept: Vec<f64> =
        columns.joints.iter().zip(&stated).map(|(of, speed)| speed.clamp(of.bounds[0], of.bounds[1])).collect();
    let mut search = Search { observation, samples, columns: &columns, weights: None, sought: vec![true; kept.len()] };
    loop {
        let (speeds, termination) = search.ended(&kept)?;
        let (estimate, found) = search.values(&speeds)?;
        let t = student_quantile(1.0 - 0.5 * LEVEL / kept.len() as f64, estimate.degrees_of_freedom);
        let before = search.sought.clone();
        for (i, value) in found.iter().enumerate() {
            let inside = speeds[i] > columns.joints[i].bounds[0] && speeds[i] < columns.joints[i].bounds[1];
            search.sought[i] &= value.is_some_and(|[speed, amplitude]| {
                inside && amplitude.value.abs() > t * amplitude.std && speed.std < LARGEST_STD * speed.value
            });
        }
        if search.sought != before {
            continue;
        }
        let equations = observation.equations().max(1) as f64;
        let weighted_rms = [search.misfit(&kept)?, search.misfit(&speeds)?].map(|rho| (rho / equations).sqrt());
        let joint = |(i, value): (usize, &Option<[SpeedValue; 2]>)| StribeckSpeed {
            joint: columns.joints[i].joint + 1,
            stated: stated[i],
            speed: value.map(|[speed, _]| speed),
            amplitude: value.map(|[_, amplitude]| amplitude),
        };
        let joints = found.iter().enumerate().map(joint).collect();
        return Ok(Some(StribeckSpeeds { joints, weighted_rms, termination }));
    }
}

/// The minimum of ρ over the speeds that are sought.
struct Search<'a> {
    observation: &'a Observation,
    samples: &'a Samples,
    columns: &'a StribeckColumns,
    /// Σ; that of the first fit until then.
    weights: Option<BlockWhitening>,
    /// Of which joints.
    sought: Vec<bool>,
}

impl Search<'_> {
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
    fn ended(&mut self, kept: &[f64]) -> Result<(Vec<f64>, Termination), EstimationError> {
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
    fn misfit(&self, speeds: &[f64]) -> Result<f64, EstimationError> {
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

    /// The estimate of (β, ln v) at these speeds, and of each joint that is sought its speed and amplitude.
    fn values(&self, speeds: &[f64]) -> Result<(Estimate, Vec<Option<[SpeedValue; 2]>>), EstimationError> {
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
        let found = self.columns.joints.iter().enumerate().map(value).collect();
        Ok((estimate, found))
    }
}
