//! How the noise of one sample is related to that of its neighbours.
//!
//! ```text
//! R(l) = E[ε_k ε_{k+l}ᵀ]   (n × n)        R(−l) = R(l)ᵀ        l = 0, 1, …
//! ```
//! Filtered noise is correlated in time. Error bars that take it for white are wrong by the factor that the filter
//! took out of the variance, so the lags are measured and go into the covariance of every estimate.
//!
//! Lags beyond some length are noise themselves. The length m follows Politis: the last lag before five in a row
//! whose correlation stays below `2 √(log10 N / N)` on every joint; lags up to m count fully and those up to 2m with
//! a weight that falls linearly to zero. White noise gives m = 0: R(0) alone.
//!
//! Reference: D. N. Politis, "Adaptive bandwidth choice", J. Nonparametric Statistics 15(4-5), 2003.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::covariance_operator::CovarianceOperator;

/// Lag covariances of a stationary noise on n joints.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::signal::NoiseModel;
/// use nalgebra::dmatrix;
/// let white = NoiseModel::white(dmatrix![4.0], false, 100.0);
/// assert_eq!(white.apply(&dmatrix![1.0; 2.0]), dmatrix![4.0; 8.0]);
/// assert_eq!((white.std(), white.length()), (vec![2.0], 0));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
pub struct NoiseModel {
    #[serde(with = "crate::plain::matrix::list")]
    lags: Vec<DMatrix<f64>>,
    weights: Vec<f64>,
    wraps: bool,
    /// Independent samples that R(0) was measured from.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub degrees_of_freedom: f64,
}

crate::plain::checked_when_read!(NoiseModel, |value| value.check().map(|()| value));

impl NoiseModel {
    /// One weight for each lag, and square covariances of one size.
    fn check(&self) -> Result<(), String> {
        let n = self.lags.first().map_or(0, DMatrix::nrows);
        if n == 0 || self.lags.iter().any(|lag| lag.shape() != (n, n)) {
            return Err("lags of a noise model, expected one square matrix or more, of one size".to_owned());
        }
        if self.weights.len() != self.lags.len() {
            return Err(format!("{} weights of {} lags, expected as many", self.weights.len(), self.lags.len()));
        }
        Ok(())
    }

    /// Noise without correlation in time, covariance `covariance` (n × n) known to `degrees_of_freedom`; `wraps` where
    /// the samples are one period.
    pub fn white(covariance: DMatrix<f64>, wraps: bool, degrees_of_freedom: f64) -> Self {
        Self { lags: vec![covariance], weights: vec![1.0], wraps, degrees_of_freedom }
    }

    /// Chooses the number of lags by the rule above. `lag(l)` gives R(l), measured from `count` independent samples;
    /// at most `limit` lags are asked for.
    pub fn adaptive(mut lag: impl FnMut(usize) -> DMatrix<f64>, limit: usize, wraps: bool, count: f64) -> Self {
        let variance = lag(0);
        let n = variance.nrows();
        let bound = 2.0 * (libm::log10(count.max(2.0)) / count.max(2.0)).sqrt();
        let mut lags = vec![variance];
        let (mut last, mut l) = (0, 0);
        while l < limit && l < last + 5 {
            l += 1;
            let here = lag(l);
            let correlated = (0..n).any(|i| here[(i, i)].abs() > bound * lags[0][(i, i)]);
            if correlated {
                last = l;
            }
            lags.push(here);
        }
        for l in lags.len()..=(2 * last).min(limit) {
            lags.push(lag(l));
        }
        lags.truncate(2 * last.max(1) - usize::from(last == 0));
        let weights =
            (0..lags.len()).map(|l| if l <= last { 1.0 } else { (2 * last - l) as f64 / last as f64 }).collect();
        let noise = Self { lags, weights, wraps, degrees_of_freedom: count };
        Self { degrees_of_freedom: count / noise.spread(), ..noise }
    }

    /// What correlation costs in independent samples, of the joint that has most: Bartlett's formula for the variance of R(0).
    fn spread(&self) -> f64 {
        let power = |i: usize| (1..self.lags.len()).map(|l| self.correlation(i, l).powi(2)).sum::<f64>();
        (0..self.dof()).map(|i| 1.0 + 2.0 * power(i)).filter(|spread| spread.is_finite()).fold(1.0, f64::max)
    }

    /// Degrees of freedom of an interval by these lags, whose weighted sum is known less well than R(0) alone:
    ///
    /// ```text
    /// ν = N / (1 + 2 Σ_l w_l²)        N independent samples
    /// ```
    /// as of a spectral estimate near zero frequency.
    ///
    /// Reference: M. B. Priestley, *Spectral Analysis and Time Series*, Academic Press 1981, sec. 6.2.
    pub fn interval_freedom(&self) -> f64 {
        let window: f64 = self.weights[1..].iter().map(|weight| weight * weight).sum();
        self.degrees_of_freedom * self.spread() / (1.0 + 2.0 * window)
    }

    /// Noise of one period whose lag covariances R(l) are known: all up to `limit`, or up to the last before five in a row that are below a
    /// hundredth of each joint's variance.
    pub fn known(mut lag: impl FnMut(usize) -> DMatrix<f64>, limit: usize) -> Self {
        let mut lags = vec![lag(0)];
        let variance = lags[0].diagonal();
        let (mut last, mut l) = (0, 0);
        while l < limit && l < last + 5 {
            l += 1;
            let here = lag(l);
            if here.diagonal().iter().zip(variance.iter()).any(|(here, variance)| here.abs() > 0.01 * variance) {
                last = l;
            }
            lags.push(here);
        }
        lags.truncate(last + 1);
        Self { weights: vec![1.0; lags.len()], lags, wraps: true, degrees_of_freedom: f64::INFINITY }
    }

    /// Returns these lags with Bartlett's weights `1 − l/(L+1)`: biased towards white noise, but a covariance for certain.
    #[must_use]
    pub fn tapered(&self) -> Self {
        let end = self.lags.len() as f64;
        let weights = (0..self.lags.len()).map(|l| 1.0 - l as f64 / end).collect();
        Self { weights, ..self.clone() }
    }

    /// Returns this noise and another one of the same joints, independent of it, whose covariances are known for certain.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let of = |noise: &Self, l: usize| noise.lags.get(l).map(|lag| lag * noise.weights[l]);
        let lags = (0..self.lags.len().max(other.lags.len())).filter_map(|l| match (of(self, l), of(other, l)) {
            (Some(own), Some(other)) => Some(own + other),
            (own, other) => own.or(other),
        });
        let lags: Vec<_> = lags.collect();
        Self { weights: vec![1.0; lags.len()], lags, ..*self }
    }

    /// The noise of several records one after the other, none of them periodic: the mean, each by its number of samples; `None` of none.
    pub fn mean(each: &[(&Self, usize)]) -> Option<Self> {
        let all: usize = each.iter().map(|(_, count)| count).sum();
        let part = |&(noise, count): &(&Self, usize)| noise.clone().scaled(count as f64 / all as f64);
        let mut mean = each.iter().map(part).reduce(|sum, part| sum.plus(&part))?;
        mean.degrees_of_freedom = each.iter().map(|(noise, _)| noise.degrees_of_freedom).sum();
        mean.wraps = false;
        Some(mean)
    }

    /// Returns this noise with all covariances multiplied by `factor`, as by averaging over `1/factor` periods.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        for r in &mut self.lags {
            *r *= factor;
        }
        self
    }

    /// Returns this noise with white noise of this variance at joint `i`, which shares it with no other.
    #[must_use]
    pub fn with_white(mut self, i: usize, variance: f64) -> Self {
        for (l, r) in self.lags.iter_mut().enumerate() {
            r.row_mut(i).fill(0.0);
            r.column_mut(i).fill(0.0);
            r[(i, i)] = if l == 0 { variance } else { 0.0 };
        }
        self
    }

    /// Number of joints n.
    pub fn dof(&self) -> usize {
        self.lags[0].nrows()
    }

    /// Covariance of one sample, R(0), n × n.
    pub fn covariance(&self) -> &DMatrix<f64> {
        &self.lags[0]
    }

    /// Standard deviation of one sample, per joint.
    pub fn std(&self) -> Vec<f64> {
        self.lags[0].diagonal().iter().map(|v| v.max(0.0).sqrt()).collect()
    }

    /// Number of lags other than zero.
    pub fn length(&self) -> usize {
        self.lags.len() - 1
    }

    /// Correlation of joint `i` with itself `l` samples later; zero beyond the last lag.
    pub fn correlation(&self, i: usize, l: usize) -> f64 {
        let variance = self.lags[0][(i, i)];
        if variance > 0.0 { self.lags.get(l).map_or(0.0, |r| r[(i, i)] / variance) } else { 0.0 }
    }

    /// `C W` for the covariance C of all samples stacked, with blocks `C(k, k+l) = R(l)`; W is (n·N) × b,
    /// sample-major.
    ///
    /// # Panics
    /// If the rows of W are no multiple of n.
    pub fn apply(&self, w: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, rows) = (self.dof(), w.nrows());
        assert!(rows.is_multiple_of(n), "{rows} rows are no multiple of {n} joints");
        self.operator(rows / n).apply(w)
    }

    /// C for `count` samples, to be applied more than once.
    pub fn operator(&self, count: usize) -> CovarianceOperator {
        let lags = self.lags.iter().zip(&self.weights).map(|(r, &weight)| r * weight).collect();
        CovarianceOperator::new(lags, self.wraps, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_noise_ends_where_it_is_small_and_sums_lag_by_lag() {
        let of = |l: usize| DMatrix::from_element(1, 1, libm::pow(0.5, l as f64));
        let known = NoiseModel::known(of, 40);
        // 2⁻⁶ is above a hundredth, 2⁻⁷ is not.
        assert_eq!((known.length(), known.correlation(0, 6)), (6, libm::pow(0.5, 6.0)));
        assert_eq!(NoiseModel::known(of, 3).length(), 3);
        let other =
            NoiseModel { lags: vec![of(0), of(0)], weights: vec![1.0, 0.5], wraps: true, degrees_of_freedom: 9.0 };
        let sum = other.plus(&known);
        assert_eq!((sum.length(), sum.degrees_of_freedom, sum.covariance()[(0, 0)]), (6, 9.0, 2.0));
        assert_eq!((sum.correlation(0, 1), sum.correlation(0, 2)), (0.5, 0.125));
    }

    #[test]
    fn analytic_records_one_after_the_other_have_their_mean_noise() {
        let of = |variance: f64| NoiseModel::white(DMatrix::from_element(1, 1, variance), true, 10.0);
        let mean = NoiseModel::mean(&[(&of(1.0), 30), (&of(5.0), 10)]).unwrap();
        assert_eq!(mean, NoiseModel::white(DMatrix::from_element(1, 1, 2.0), false, 20.0));
        assert_eq!(NoiseModel::mean(&[]), None);
    }

    #[test]
    fn lags_are_square_and_of_one_size() {
        let of = |lags: Vec<DMatrix<f64>>| {
            let weights = vec![1.0; lags.len()];
            NoiseModel { lags, weights, wraps: false, degrees_of_freedom: 9.0 }.check()
        };
        assert!(of(vec![DMatrix::identity(2, 2); 3]).is_ok());
        assert!(of(Vec::new()).is_err() && of(vec![DMatrix::zeros(0, 0)]).is_err());
        assert!(of(vec![DMatrix::identity(2, 2), DMatrix::identity(3, 3)]).is_err());
        assert!(of(vec![DMatrix::zeros(2, 3)]).is_err());
    }

    #[test]
    fn identity_apply_is_the_product_with_the_whole_matrix() {
        let (n, count) = (2, 7);
        let lags = [
            DMatrix::from_row_slice(2, 2, &[3.0, 0.5, 0.5, 2.0]),
            DMatrix::from_row_slice(2, 2, &[1.0, 0.2, -0.3, 0.7]),
            DMatrix::from_row_slice(2, 2, &[0.4, -0.1, 0.05, 0.2]),
        ];
        let w = DMatrix::from_fn(n * count, 3, |i, j| libm::sin((3 * i + 5 * j) as f64));
        for wraps in [false, true] {
            let noise = NoiseModel { lags: lags.to_vec(), weights: vec![1.0; 3], wraps, degrees_of_freedom: 1.0 };
            assert_eq!(noise.dof(), n);
            let mut whole = DMatrix::zeros(n * count, n * count);
            for k in 0..count {
                for (l, r) in lags.iter().enumerate() {
                    if k + l < count || wraps {
                        let (a, b) = (k * n, (k + l) % count * n);
                        let mut block = whole.view_mut((a, b), (n, n));
                        block += r;
                        if l > 0 {
                            let mut block = whole.view_mut((b, a), (n, n));
                            block += r.transpose();
                        }
                    }
                }
            }
            assert!((noise.apply(&w) - whole * &w).norm() < 1e-13);
        }
    }

    #[test]
    fn analytic_opposed_neighbours_can_cancel_and_tapered_ones_cannot() {
        // The sum over a constant column is R(0) + 2 R(1) a sample: negative for a correlation below −1/2, which no
        // noise has and measured lags may show.
        let noise = NoiseModel {
            lags: vec![1.0, -0.6].into_iter().map(|r| DMatrix::from_element(1, 1, r)).collect(),
            weights: vec![1.0; 2],
            wraps: true,
            degrees_of_freedom: 9.0,
        };
        let ones = DMatrix::from_element(50, 1, 1.0);
        assert!((noise.apply(&ones).sum() / 50.0 + 0.2).abs() < 1e-14);
        assert!((noise.tapered().apply(&ones).sum() / 50.0 - 0.4).abs() < 1e-14);
    }

    #[test]
    fn analytic_white_and_moving_average_lengths() {
        let scalar = |value: f64| DMatrix::from_element(1, 1, value);
        let white = NoiseModel::adaptive(|l| scalar(if l == 0 { 2.0 } else { 0.01 }), 100, true, 1000.0);
        assert_eq!((white.length(), white.degrees_of_freedom), (0, 1000.0));
        // Correlations 1, 0.5, 0.25 and then nothing: m = 2, so lag 3 comes with half its weight and lag 4 with none.
        let moving =
            NoiseModel::adaptive(|l| scalar([4.0, 2.0, 1.0].get(l).copied().unwrap_or(0.04)), 100, true, 1000.0);
        assert_eq!(moving.length(), 3);
        assert_eq!(moving.weights, [1.0, 1.0, 1.0, 0.5]);
        assert_eq!(moving.tapered().weights, [1.0, 0.75, 0.5, 0.25]);
        assert!((moving.correlation(0, 2) - 0.25).abs() < 1e-15 && moving.correlation(0, 9) == 0.0);
        // Bartlett: 1 + 2 (0.5² + 0.25² + 0.01²).
        assert!((moving.degrees_of_freedom - 1000.0 / 1.6252).abs() < 1e-9);
        assert_eq!(moving.scaled(0.25).covariance(), &scalar(1.0));
    }
}
