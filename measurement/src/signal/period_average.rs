//! The average over periods, and the noise that the scatter over periods shows.
//!
//! ```text
//! x̄[k] = 1/P Σ_p x_p[k]      Σ̂ = 1/(N (P−1)) Σ_p Σ_k e_p[k] e_p[k]ᵀ      e_p = x_p − x̄
//! ```
//! Σ̂ is the covariance of one sample of one period, unbiased where periods are independent, with N (P−1) degrees of
//! freedom where samples are too; the average has Σ/P. An error that repeats with the period (quantisation of a
//! motion that repeats exactly, a wrong torque constant) does not scatter and is not seen here.
//!
//! Reference: Swevers et al. 1997, eqs. 19-22.

use nalgebra::DMatrix;

use super::error::{SignalError, check_finite, refused};
use super::lag_products::LagProducts;

/// Whole periods of a record, back to back: `q` and `effort` are (P·N) × n, row-major.
#[derive(Clone, Copy, Debug)]
pub struct PeriodicRecord<'a> {
    /// Number of joints n.
    pub dof: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Samples in one period, N.
    pub period_samples: usize,
    /// Positions, rad or m.
    pub q: &'a [f64],
    /// Efforts, in the unit that the arm reports.
    pub effort: &'a [f64],
}

impl PeriodicRecord<'_> {
    /// Number of whole periods P.
    pub fn periods(&self) -> usize {
        self.q.len() / (self.dof * self.period_samples).max(1)
    }

    /// Checks shapes and values.
    ///
    /// # Errors
    /// [`SignalError`] where a length does not fit, a value is not finite or there are fewer than 8 samples.
    pub fn check(&self) -> Result<(), SignalError> {
        let period_s = self.period_samples as f64 / self.rate_hz;
        if !(self.rate_hz.is_finite() && self.rate_hz > 0.0) {
            return refused("sampling rate", format!("{} Hz", self.rate_hz), "a finite number above zero");
        }
        if self.dof == 0 || self.period_samples < 8 {
            let found = self.period_samples as f64;
            return Err(SignalError::PeriodSamples { period_s, rate_hz: self.rate_hz, found, least: 8 });
        }
        let block = self.dof * self.period_samples;
        if self.q.is_empty() || !self.q.len().is_multiple_of(block) {
            let (found, of) = (self.q.len(), "joints × samples per period");
            return Err(SignalError::Length { quantity: "positions", found, block, of, least: block });
        }
        if self.effort.len() != self.q.len() {
            let (found, expected) = (self.effort.len(), self.q.len());
            return Err(SignalError::Unequal { quantity: "efforts", found, other: "positions", expected });
        }
        check_finite("position", self.q, self.dof)?;
        check_finite("effort", self.effort, self.dof)
    }
}

/// One period of a signal averaged over all recorded periods, with the noise of one un-averaged sample.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::signal::{PeriodAverage, PeriodicRecord};
/// let q = [0.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0].repeat(3);
/// let effort: Vec<f64> = (0..24).map(|k| if k < 8 { 1.0 } else if k < 16 { -1.0 } else { 0.0 }).collect();
/// let record = PeriodicRecord { dof: 1, rate_hz: 8.0, period_samples: 8, q: &q, effort: &effort };
/// let average = PeriodAverage::new(&record)?;
/// assert_eq!((average.periods, average.q[4], average.effort[0]), (3, 4.0, 0.0));
/// assert_eq!(average.effort_covariance.unwrap()[(0, 0)], 1.0); // (1 + 1 + 0) / (3 − 1)
/// # Ok::<(), armid::signal::SignalError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodAverage {
    /// Number of joints n.
    pub dof: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Period, s.
    pub period_s: f64,
    /// Number of periods P.
    pub periods: usize,
    /// Average positions, N × n row-major, rad or m.
    pub q: Vec<f64>,
    /// Average efforts, N × n row-major, in the record's unit.
    pub effort: Vec<f64>,
    /// Variance of one sample's position, per joint; `None` where there is one period only.
    pub q_variance: Option<Vec<f64>>,
    /// Covariance of one sample's efforts, n × n; `None` where there is one period only.
    pub effort_covariance: Option<DMatrix<f64>>,
    /// Degrees of freedom of both under white noise: N (P − 1).
    pub degrees_of_freedom: usize,
}

impl PeriodAverage {
    /// Averages a record over its periods.
    ///
    /// # Errors
    /// As [`PeriodicRecord::check`].
    pub fn new(record: &PeriodicRecord<'_>) -> Result<Self, SignalError> {
        record.check()?;
        Ok(Self::of_checked(record))
    }

    /// Averages a record that was checked.
    pub(super) fn of_checked(record: &PeriodicRecord<'_>) -> Self {
        let (n, len, periods) = (record.dof, record.period_samples, record.periods());
        let q = average(record.q, n * len);
        let effort = average(record.effort, n * len);
        let degrees_of_freedom = len * (periods - 1);
        let scatters = degrees_of_freedom > 0;
        Self {
            q_variance: scatters.then(|| variances(record.q, &q, n, degrees_of_freedom as f64)),
            effort_covariance: scatters.then(|| covariance(record.effort, &effort, n) / degrees_of_freedom as f64),
            dof: n,
            rate_hz: record.rate_hz,
            period_s: len as f64 / record.rate_hz,
            periods,
            q,
            effort,
            degrees_of_freedom,
        }
    }

    /// Samples in the period, N.
    pub fn len(&self) -> usize {
        self.q.len() / self.dof
    }

    /// Whether there are no samples; never true of a checked average.
    pub fn is_empty(&self) -> bool {
        self.q.is_empty()
    }
}

/// Mean over blocks of `block` values that follow each other.
fn average(x: &[f64], block: usize) -> Vec<f64> {
    let mut mean = vec![0.0; block];
    for period in x.chunks_exact(block) {
        for (mean, x) in mean.iter_mut().zip(period) {
            *mean += x;
        }
    }
    let count = (x.len() / block) as f64;
    for mean in &mut mean {
        *mean /= count;
    }
    mean
}

/// Deviations of one period from the mean, row by row.
pub(super) fn deviations(period: &[f64], mean: &[f64]) -> Vec<f64> {
    period.iter().zip(mean).map(|(x, mean)| x - mean).collect()
}

/// The diagonal of [`covariance`] over `count`.
fn variances(x: &[f64], mean: &[f64], n: usize, count: f64) -> Vec<f64> {
    let mut sums = vec![0.0; n];
    for period in x.chunks_exact(mean.len()) {
        let squares = LagProducts::new(&deviations(period, mean), n, true).squares();
        sums.iter_mut().zip(squares).for_each(|(sum, square)| *sum += square);
    }
    sums.iter().map(|sum| sum / count).collect()
}

/// Σ e eᵀ over all rows of `x` (row-major, n wide), `e = x − mean` with `mean` repeated.
fn covariance(x: &[f64], mean: &[f64], n: usize) -> DMatrix<f64> {
    let periods = x.chunks_exact(mean.len());
    periods.map(|period| LagProducts::new(&deviations(period, mean), n, true).summed(0)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand_distr::{Distribution, StandardNormal};

    /// White noise with covariance L Lᵀ on two joints, around a periodic signal.
    fn record(periods: usize, len: usize, run: u64) -> (Vec<f64>, Vec<f64>) {
        let mut rng = Seed::new(11).stream("period average", run);
        let mut q = Vec::new();
        let mut effort = Vec::new();
        for _ in 0..periods {
            for k in 0..len {
                let phase = std::f64::consts::TAU * k as f64 / len as f64;
                let [a, b, c, d]: [f64; 4] = std::array::from_fn(|_| StandardNormal.sample(&mut rng));
                q.extend([libm::sin(phase) + 0.1 * c, libm::cos(phase) + 0.2 * d]);
                effort.extend([5.0 * libm::cos(phase) + 2.0 * a, 1.0 + 0.6 * 2.0 * a + 0.8 * b]);
            }
        }
        (q, effort)
    }

    #[test]
    fn analytic_scatter_is_unbiased() {
        // 200 records of 3 periods: mean of the estimates against Σ = L Lᵀ = [4 2.4; 2.4 2.08].
        let (runs, periods, len) = (200, 3, 20);
        let mut mean = DMatrix::zeros(2, 2);
        let mut variance = [0.0; 2];
        for run in 0..runs {
            let (q, effort) = record(periods, len, run);
            let average = PeriodAverage::new(&PeriodicRecord {
                dof: 2,
                rate_hz: 10.0,
                period_samples: len,
                q: &q,
                effort: &effort,
            })
            .unwrap();
            assert_eq!(average.degrees_of_freedom, 40);
            mean += average.effort_covariance.unwrap() / runs as f64;
            for (sum, v) in variance.iter_mut().zip(average.q_variance.unwrap()) {
                *sum += v / runs as f64;
            }
        }
        // Standard deviation of the mean of a variance: s² √(2/(200·40)) = 1.6 %; five of them.
        for (found, expected) in
            [(mean[(0, 0)], 4.0), (mean[(0, 1)], 2.4), (mean[(1, 1)], 2.08), (variance[0], 0.01), (variance[1], 0.04)]
        {
            assert!((found / expected - 1.0).abs() < 0.08, "{found} against {expected}");
        }
    }

    #[test]
    fn identity_average_of_a_repeated_period_is_the_period() {
        let period: Vec<f64> = (0..24).map(|k| libm::sin(f64::from(k))).collect();
        let q = period.repeat(4);
        let average =
            PeriodAverage::new(&PeriodicRecord { dof: 2, rate_hz: 1.0, period_samples: 12, q: &q, effort: &q })
                .unwrap();
        assert_eq!(average.q, period);
        assert_eq!(average.effort_covariance.as_ref(), Some(&DMatrix::zeros(2, 2)));
        assert_eq!((average.len(), average.period_s), (12, 12.0));
        let one = PeriodicRecord { dof: 2, rate_hz: 1.0, period_samples: 12, q: &period, effort: &period };
        assert!(PeriodAverage::new(&one).unwrap().effort_covariance.is_none());
    }

    #[test]
    fn wrong_records_are_refused() {
        let q = vec![0.0; 33];
        let record = PeriodicRecord { dof: 2, rate_hz: 1.0, period_samples: 16, q: &q, effort: &q };
        assert!(matches!(PeriodAverage::new(&record), Err(SignalError::Length { quantity: "positions", .. })));
        let mut q = vec![0.0; 32];
        q[7] = f64::NAN;
        let record = PeriodicRecord { dof: 2, rate_hz: 1.0, period_samples: 16, q: &q, effort: &[0.0; 32] };
        assert!(matches!(PeriodAverage::new(&record), Err(SignalError::NotFinite { joint: 2, sample: 3, .. })));
    }
}
