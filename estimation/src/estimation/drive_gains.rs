//! Gains of all drives at once, from logs without and with a load that is known.
//!
//! ```text
//! κ_i y_i,k − w_i,k β = ℓ_i,k        ℓ = 0 without the load, w_i,k K_n θ with it        κ_i true over stated torque constant
//! least squares, weighted, ridge      min ‖A x − ℓ‖ over x = (β, κ), rows weighted with their residual, with a penalty
//! total least squares                 y_i,k = (w_i,k β + ℓ_i,k)/κ_i + ε_i,k: the noise is that of y alone
//! ```
//! One log determines torque up to a common factor for all joints whose links move each other: with all gains and all parameters one per cent
//! larger nothing is seen. A load of known θ (ten parameters in the frame of the last link) sets the scale. Friction and offsets must be
//! the same in both logs, and the load's own parameters are taken as exact: an error of θ is one of the gains.
//!
//! The noise of y stands in the columns of A, so that the first three draw κ towards zero, by about the share of the noise in
//! the power of what the load moves. No interval of their scatter holds that, so they have none. Total least squares has no such bias and is
//! maximum likelihood for normal noise.
//!
//! References: M. Gautier, S. Briot, "Global identification of joint drive gains and dynamic parameters of robots", Journal of Dynamic
//! Systems, Measurement, and Control 136(5), 2014; J. Swevers and others as in `ml` for noise of one side only.

use nalgebra::{DMatrix, DVector};

use super::error::EstimationError;
use super::factorisation::Factorisation;
use super::identification::Identification;
use super::observation::Observation;
use super::residual::residual_noise;
use super::ridge::Shrunk;
use super::termination::Termination;
use crate::estimation::linear_fit::LinearFit;
use crate::linalg::{LeastSquares, LeastSquaresError, product, transpose_product};
use crate::signal::Samples;
use crate::spatial::Inertia;
use crate::statistics::student_quantile;

/// Iterations of total least squares at most; Gauss–Newton takes some five.
const ITERATIONS: usize = 50;

/// Relative change of the gains at which the iteration has come to rest.
const AT_REST: f64 = 1e-10;

/// Change of the torque, as a part of the measured one, at which friction of the load rests.
const LOAD_AT_REST: f64 = 1e-8;

/// How the equations of the gains are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum GainMethod {
    /// Every equation alike.
    #[serde(rename = "ols")]
    LeastSquares,
    /// Each joint's equations over the RMS of their residual.
    #[serde(rename = "wls")]
    Weighted,
    /// The noise of the measured torque alone, where it is.
    #[serde(rename = "tls")]
    Total,
    /// Weighted, and everything drawn towards zero as by `ridge`.
    #[serde(rename = "ridge")]
    Ridge,
}

crate::input::named! { GainMethod { LeastSquares: "ols", Weighted: "wls", Total: "tls", Ridge: "ridge" } }

/// The gain of one drive.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct DriveGain {
    /// True over stated torque constant.
    pub value: f64,
    /// Standard deviation; `None` by a method that noise biases.
    pub std: Option<f64>,
    /// 95 % interval; `None` as above.
    pub ci95: Option<[f64; 2]>,
}

/// Gains and parameters of an arm, from both logs.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveGains {
    /// How they were found.
    pub method: GainMethod,
    /// The gain of each joint, n.
    pub gains: Vec<DriveGain>,
    /// The base parameters without the load, by true torques, b.
    pub beta: DVector<f64>,
    /// Independent samples behind the standard deviations; `None` where there are none.
    pub degrees_of_freedom: Option<f64>,
    /// How it ended.
    pub termination: Termination,
}

impl DriveGains {
    /// Joints whose gain is not 1, at a level of 5 % over all joints together (Bonferroni): their stated constants are wrong. None by a
    /// method that has no intervals.
    pub fn wrong_joints(&self) -> Vec<usize> {
        let Some(freedom) = self.degrees_of_freedom else { return Vec::new() };
        let t = student_quantile(1.0 - 0.025 / self.gains.len() as f64, freedom);
        let is_wrong = |gain: &DriveGain| gain.std.is_some_and(|std| (gain.value - 1.0).abs() > t * std);
        (0..self.gains.len()).filter(|&joint| is_wrong(&self.gains[joint])).collect()
    }

    /// Joints whose gain the load does not show: the 95 % interval holds zero, has no end, or is not there.
    pub fn hidden_joints(&self) -> Vec<usize> {
        let is_hidden = |gain: &DriveGain| !gain.ci95.is_some_and(|ends| ends[0] > 0.0 && ends[1].is_finite());
        (0..self.gains.len()).filter(|&joint| is_hidden(&self.gains[joint])).collect()
    }
}

/// Gains of all drives, from the equations of an arm `without` and `with` a load on its last link.
///
/// # Errors
/// [`EstimationError::OtherRobot`] or [`EstimationError::OtherBase`] where the equations are not of one arm and base,
/// [`EstimationError::NotExcited`] where the motion or the load does not show a gain or parameter, [`EstimationError::NotDefinite`] where the
/// penalty of `ridge` has no answer.
pub fn drive_gains(
    without: &Observation,
    with: &Observation,
    load: &Inertia,
    method: GainMethod,
) -> Result<DriveGains, EstimationError> {
    let logs = TwoLogs::of(without, with, load)?;
    let direct = |x: &DVector<f64>| Ok(logs.result(method, x.clone(), Termination::Direct, None));
    let plain = logs.linear(&vec![1.0; without.dof])?;
    if method == GainMethod::LeastSquares {
        return direct(plain.solution());
    }
    let weights: Vec<f64> = logs.rms(plain.solution()).iter().map(|rms| 1.0 / rms.max(f64::MIN_POSITIVE)).collect();
    let weighted = logs.linear(&weights)?;
    match method {
        GainMethod::LeastSquares | GainMethod::Weighted => direct(weighted.solution()),
        GainMethod::Ridge => direct(&logs.shrunk(&weighted, &weights)?.beta),
        GainMethod::Total => logs.total(&weighted, &weights),
    }
}

/// The equations of an arm `without` and `with` a load for columns with friction of the load, at the torque of the links by the gains and parameters
/// of the weighted fit; repeated until that rests. The equations as they are where no column depends on it.
///
/// Intervals of gains by them take that torque as exact.
///
/// # Errors
/// As [`drive_gains`]; [`EstimationError::LoadNotAtRest`].
pub fn gain_equations(
    of: &Identification,
    [without, with]: [&Samples; 2],
    load: &Inertia,
) -> Result<[Observation; 2], EstimationError> {
    let linear = [of.observation(without)?, of.observation(with)?];
    let Some(mut beta) = linear[0].linear_at.clone() else { return Ok(linear) };
    let (none, mut change) = (Inertia::from_array(&[0.0; 10]), f64::INFINITY);
    for _ in 0..ITERATIONS {
        let at_load = [of.observation_at(without, &beta, &none)?, of.observation_at(with, &beta, load)?];
        let next = drive_gains(&at_load[0], &at_load[1], load, GainMethod::Weighted)?.beta;
        change = (&at_load[0].regressor * (&next - &beta)).norm() / at_load[0].y.norm().max(f64::MIN_POSITIVE);
        beta = next;
        if change <= LOAD_AT_REST {
            return Ok(at_load);
        }
    }
    Err(EstimationError::LoadNotAtRest { change, rounds: ITERATIONS, rest: LOAD_AT_REST })
}

/// Sensitivity of base parameters to the gains: `∂β̂/∂ ln κ_i` of weighted least squares, b × n. A constant of joint i that is stated one per cent too
/// small moves them by a hundredth of column i; all columns together are β̂.
///
/// # Errors
/// As [`Factorisation::least_squares`].
pub fn gain_slopes(observation: &Observation) -> Result<DMatrix<f64>, EstimationError> {
    let equations = Factorisation::new(observation)?;
    let linear = LinearFit::weighted(&equations)?;
    let Some(weights) = &linear.weights else { return Err(EstimationError::NotDefinite) };
    let n = observation.dof;
    let columns: Result<Vec<_>, EstimationError> = (0..n)
        .map(|i| {
            let mut one = observation.clone();
            for (row, y) in one.y.iter_mut().enumerate() {
                *y = if row % n == i { *y } else { 0.0 };
            }
            let fit = Factorisation::new(&one)?.weighted(weights)?;
            Ok(fit.solution().clone())
        })
        .collect();
    Ok(DMatrix::from_columns(&columns?))
}

/// The equations of both logs.
struct TwoLogs<'a> {
    logs: [&'a Observation; 2],
    /// ℓ of both.
    known: [DVector<f64>; 2],
}

impl<'a> TwoLogs<'a> {
    fn of(without: &'a Observation, with: &'a Observation, load: &Inertia) -> Result<Self, EstimationError> {
        if without.robot != with.robot {
            let (first, second) = (without.robot.clone(), with.robot.clone());
            return Err(EstimationError::OtherRobot { first, second });
        }
        if without.base != with.base {
            return Err(EstimationError::OtherBase { found: with.base.names(), expected: without.base.names() });
        }
        let (base, theta) = (&with.base, load.to_array());
        let mut change = DVector::zeros(base.rank());
        for (column, value) in base.columns_of_last_link().into_iter().zip(theta) {
            change += base.k.column(column) * value;
        }
        let known = [DVector::zeros(without.y.len()), &with.regressor * change];
        Ok(Self { logs: [without, with], known })
    }

    fn joints(&self) -> usize {
        self.logs[0].dof
    }

    fn rank(&self) -> usize {
        self.logs[0].base.rank()
    }

    /// A of one log, rows × (b + n), each row times the weight of its joint.
    fn rows(&self, log: usize, weights: &[f64]) -> DMatrix<f64> {
        let (n, b, observation) = (self.joints(), self.rank(), self.logs[log]);
        DMatrix::from_fn(observation.y.len(), b + n, |row, column| {
            let joint = row % n;
            weights[joint]
                * match column.checked_sub(b) {
                    None => -observation.regressor[(row, column)],
                    Some(of) if of == joint => observation.y[row],
                    Some(_) => 0.0,
                }
        })
    }

    fn linear(&self, weights: &[f64]) -> Result<LeastSquares, EstimationError> {
        self.solve(&[0, 1].map(|log| (self.rows(log, weights), weighted(&self.known[log], weights))))
    }

    fn solve(&self, parts: &[(DMatrix<f64>, DVector<f64>); 2]) -> Result<LeastSquares, EstimationError> {
        let [(first, y), (second, z)] = parts;
        let rows = first.nrows();
        let mut a = DMatrix::zeros(rows + second.nrows(), first.ncols());
        a.rows_mut(0, rows).copy_from(first);
        a.rows_mut(rows, second.nrows()).copy_from(second);
        let right = DVector::from_iterator(rows + z.len(), y.iter().chain(z.iter()).copied());
        LeastSquares::solve(&a, &right).map_err(|error| match error {
            LeastSquaresError::Dependent { column, independent, least } => {
                let names = self.logs[0].base.names();
                let gain = |joint: usize| format!("the gain of joint {}", joint + 1);
                let parameter = names.get(column).cloned().unwrap_or_else(|| gain(column - names.len()));
                EstimationError::NotExcited { parameter, independent, least }
            }
            other => other.into(),
        })
    }

    /// `ℓ − A x` of a log.
    fn residual(&self, log: usize, x: &DVector<f64>) -> DVector<f64> {
        let mut residual = &self.known[log] - self.rows(log, &vec![1.0; self.joints()]) * x;
        for (row, used) in self.logs[log].used.iter().enumerate() {
            residual[row] = if *used { residual[row] } else { 0.0 };
        }
        residual
    }

    /// RMS of each joint's residual over both logs.
    fn rms(&self, x: &DVector<f64>) -> Vec<f64> {
        let n = self.joints();
        let (mut sums, mut counts) = (vec![0.0; n], vec![0_usize; n]);
        for log in 0..2 {
            for (row, value) in self.residual(log, x).iter().enumerate() {
                sums[row % n] += value * value;
                counts[row % n] += usize::from(self.logs[log].used[row]);
            }
        }
        sums.iter().zip(counts).map(|(sum, count)| (sum / count.max(1) as f64).sqrt()).collect()
    }

    /// The penalty of Hoerl, Kennard and Baldwin.
    fn shrunk(&self, plain: &LeastSquares, weights: &[f64]) -> Result<Shrunk, EstimationError> {
        let rms = self.rms(plain.solution());
        let sum = rms.iter().zip(weights).map(|(rms, weight)| (rms * weight).powi(2)).sum::<f64>();
        Shrunk::of(plain, sum / self.joints() as f64).ok_or(EstimationError::NotDefinite)
    }

    /// `A⁻¹ Bᵀ C B A⁻¹` with B the weighted columns of each log and C by its residual, and what C is known to.
    fn covariance(&self, inverse: &DMatrix<f64>, parts: &[(DMatrix<f64>, DVector<f64>); 2]) -> (DMatrix<f64>, f64) {
        let size = inverse.nrows();
        let (mut middle, mut freedom) = (DMatrix::zeros(size, size), f64::INFINITY);
        for (log, (columns, residual)) in parts.iter().enumerate() {
            let noise = residual_noise(self.logs[log], residual);
            middle += transpose_product(columns, &noise.apply(columns));
            freedom = freedom.min(noise.degrees_of_freedom);
        }
        (product(&product(inverse, &middle), inverse), freedom)
    }

    /// Gauss–Newton on `y = g (w β + ℓ)`, g = 1/κ, from a linear solution.
    fn total(&self, start: &LeastSquares, weights: &[f64]) -> Result<DriveGains, EstimationError> {
        let (n, b) = (self.joints(), self.rank());
        let mut x = start.solution().clone();
        for i in 0..n {
            x[b + i] = 1.0 / x[b + i];
        }
        // The noise of y is that of κ y over κ.
        let weights: Vec<f64> = (0..n).map(|i| weights[i] / x[b + i].abs()).collect();
        let mut inverse = start.inverse_information();
        let mut termination = Termination::Singular { iterations: 0 };
        for iterations in 1..=ITERATIONS {
            let parts = [0, 1].map(|log| {
                let (jacobian, error) = self.linearised(log, &x);
                (scaled(&jacobian, &weights), weighted(&error, &weights))
            });
            let fit = self.solve(&parts)?;
            let step = fit.solution();
            let last_step = (0..n).map(|i| (step[b + i] / x[b + i]).abs()).fold(0.0, f64::max);
            x += step;
            inverse = fit.inverse_information();
            termination = match last_step <= AT_REST {
                _ if last_step.is_nan() => Termination::Singular { iterations },
                true => Termination::Converged { iterations, last_step },
                false => Termination::IterationLimit { iterations, last_step },
            };
            if !matches!(termination, Termination::IterationLimit { .. }) {
                break;
            }
        }
        let squared: Vec<f64> = weights.iter().map(|weight| weight * weight).collect();
        let parts = [0, 1].map(|log| {
            let (jacobian, error) = self.linearised(log, &x);
            (scaled(&jacobian, &squared), error)
        });
        let (covariance, freedom) = self.covariance(&inverse, &parts);
        // From g to κ.
        let std = (b..b + n).map(|j| covariance[(j, j)].max(0.0).sqrt() / (x[j] * x[j])).collect();
        for i in 0..n {
            x[b + i] = 1.0 / x[b + i];
        }
        Ok(self.result(GainMethod::Total, x, termination, Some((std, freedom))))
    }

    /// ∂(g (w β + ℓ))/∂(β, g) of a log, and `y − g (w β + ℓ)`; zero in rows that are no equation.
    fn linearised(&self, log: usize, x: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let (n, b, observation) = (self.joints(), self.rank(), self.logs[log]);
        let torque = &observation.regressor * x.rows(0, b) + &self.known[log];
        let jacobian = DMatrix::from_fn(observation.y.len(), b + n, |row, column| {
            let joint = row % n;
            match column.checked_sub(b) {
                None => x[b + joint] * observation.regressor[(row, column)],
                Some(of) if of == joint => torque[row],
                Some(_) => 0.0,
            }
        });
        let error = DVector::from_fn(observation.y.len(), |row, _| observation.y[row] - x[b + row % n] * torque[row]);
        (jacobian, error)
    }

    /// With the standard deviation of each gain and what it is known to, where noise does not bias them.
    fn result(
        &self,
        method: GainMethod,
        x: DVector<f64>,
        termination: Termination,
        spread: Option<(Vec<f64>, f64)>,
    ) -> DriveGains {
        let (n, b) = (self.joints(), self.rank());
        let gain = |i: usize| {
            let (value, spread) = (x[b + i], spread.as_ref().map(|(std, freedom)| (std[i], *freedom)));
            let ends = |(std, freedom)| {
                let half = student_quantile(0.975, freedom) * std;
                [value - half, value + half]
            };
            DriveGain { value, std: spread.map(|(std, _)| std), ci95: spread.map(ends) }
        };
        DriveGains {
            method,
            gains: (0..n).map(gain).collect(),
            beta: x.rows(0, b).into_owned(),
            degrees_of_freedom: spread.map(|(_, freedom)| freedom),
            termination,
        }
    }
}

/// Each entry times the weight of its joint.
fn weighted(values: &DVector<f64>, weights: &[f64]) -> DVector<f64> {
    DVector::from_fn(values.len(), |row, _| values[row] * weights[row % weights.len()])
}

/// Each row times the weight of its joint.
fn scaled(rows: &DMatrix<f64>, weights: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.nrows(), rows.ncols(), |row, column| rows[(row, column)] * weights[row % weights.len()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_gains_that_are_wrong_or_hidden() {
        let gain = |value: f64, std: f64, ci95: Option<[f64; 2]>| DriveGain { value, std: Some(std), ci95 };
        let mut gains = DriveGains {
            method: GainMethod::Total,
            gains: vec![
                gain(1.23, 0.1, Some([1.03, 1.43])),
                gain(0.7, 0.1, Some([0.5, 0.9])),
                gain(0.9, 0.6, Some([-0.3, 2.1])),
                gain(1.0, f64::INFINITY, Some([0.1, f64::INFINITY])),
                gain(1.0, 0.1, None),
            ],
            beta: DVector::zeros(0),
            degrees_of_freedom: Some(1e9),
            termination: Termination::Direct,
        };
        // The quantile of a normal distribution at 1 − 0.025/5 is 2.576: 2.3 deviations are not enough, 3 are.
        assert_eq!((gains.wrong_joints(), gains.hidden_joints()), (vec![1], vec![2, 3, 4]));
        gains.degrees_of_freedom = None;
        assert!(gains.wrong_joints().is_empty());
    }

    #[test]
    fn analytic_rows_are_weighted_by_joint() {
        let rows = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(scaled(&rows, &[2.0, 10.0]), DMatrix::from_row_slice(3, 2, &[2.0, 4.0, 30.0, 40.0, 10.0, 12.0]));
        let values = rows.column(0).into_owned();
        assert_eq!(weighted(&values, &[2.0, 10.0]), DVector::from_vec(vec![2.0, 30.0, 10.0]));
    }
}
