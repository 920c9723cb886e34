//! Lag covariances of the scatter over periods, as means over blocks of samples carry it.
//!
//! ```text
//! R(l) = 1/(N (P−1)) Σ_p Σ_k m_p[k] m_p[k + l D]ᵀ     m_p[k] = 1/D Σ_d e_p[k + d]     e_p = f(x_p − x̄)
//! ```
//! for blocks of D samples and a filter f. A mean begins at each of the N samples of a period, whose last is followed by the first. So there
//! are D times as many products as equations have. The average over periods has R/P. Nothing is assumed of the noise but that it is
//! stationary.

use nalgebra::DMatrix;

use super::lag_products::LagProducts;
use super::period_average::deviations;

/// Means of the deviations of single periods from their average.
#[derive(Clone, Debug)]
pub(super) struct Scatter {
    /// m of each period.
    periods: Vec<LagProducts>,
    /// D.
    block: usize,
    /// N (P − 1).
    count: f64,
}

impl Scatter {
    /// From whole periods `x` ((P·N) × n row-major) and their average `mean` (N × n), with a filter of one period's deviations, as
    /// means over `block` samples; `None` where P < 2.
    pub(super) fn new(
        x: &[f64],
        mean: &[f64],
        dof: usize,
        block: usize,
        filter: impl Fn(Vec<f64>) -> Vec<f64>,
    ) -> Option<Self> {
        let scattered = (x.len() / mean.len()).checked_sub(1).filter(|scattered| *scattered > 0)?;
        let of_period = |period| {
            let filtered = filter(deviations(period, mean));
            LagProducts::new(&circular_means(&filtered, dof, block), dof, true)
        };
        let periods = x.chunks_exact(mean.len()).map(of_period).collect();
        Some(Self { periods, block, count: (scattered * mean.len() / dof) as f64 })
    }

    /// R(l), n × n.
    pub(super) fn lag(&self, l: usize) -> DMatrix<f64> {
        self.periods.iter().map(|period| period.summed(l * self.block)).sum::<DMatrix<f64>>() / self.count
    }
}

/// Means over `block` rows from each row on, of a table n wide whose last row is followed by the first.
fn circular_means(rows: &[f64], n: usize, block: usize) -> Vec<f64> {
    let mut sums = vec![0.0; n];
    for row in rows.chunks_exact(n).take(block) {
        sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
    }
    let mut means = Vec::with_capacity(rows.len());
    let behind = rows[block * n..].chunks_exact(n).chain(rows.chunks_exact(n));
    for (first, behind) in rows.chunks_exact(n).zip(behind) {
        means.extend(sums.iter().map(|sum| sum / block as f64));
        for (sum, (behind, first)) in sums.iter_mut().zip(behind.iter().zip(first)) {
            *sum += behind - first;
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use crate::signal::{FourierTransform, PeriodAverage, PeriodicRecord};
    use nalgebra::Complex;
    use rand_distr::{Distribution, StandardNormal};

    const N: usize = 3;
    const LEN: usize = 24;
    const PERIODS: usize = 4;

    fn noise() -> (Vec<f64>, PeriodAverage) {
        let mut rng = Seed::new(3).stream("scatter", 0);
        let x: Vec<f64> = (0..N * LEN * PERIODS).map(|_| StandardNormal.sample(&mut rng)).collect();
        let record = PeriodicRecord { dof: N, rate_hz: 1.0, period_samples: LEN, q: &x, effort: &x };
        let average = PeriodAverage::new(&record).unwrap();
        (x, average)
    }

    #[test]
    fn identity_lags_are_those_of_the_cross_spectrum() {
        let (x, average) = noise();
        let transform = FourierTransform::new(LEN);
        let tau = std::f64::consts::TAU;
        for block in [1, 3] {
            let scatter = Scatter::new(&x, &average.q, N, block, |rows| rows).unwrap();
            for l in 0..5 {
                // R(l) = 1/(N² (P−1)) Σ_p Σ_h g² conj(E_i) E_j exp(2πi h l D / N), with the gain g of means: Dirichlet's kernel.
                let mut expected = DMatrix::zeros(N, N);
                for period in x.chunks_exact(N * LEN) {
                    let off = deviations(period, &average.q);
                    let lines: Vec<_> = (0..N)
                        .map(|i| transform.forward_real(&off.iter().skip(i).step_by(N).copied().collect::<Vec<_>>()))
                        .collect();
                    for h in 0..LEN {
                        let x = 0.5 * tau * h as f64 / LEN as f64;
                        let dirichlet = || libm::sin(block as f64 * x) / (block as f64 * libm::sin(x));
                        let power = if h == 0 { 1.0 } else { dirichlet() * dirichlet() };
                        let (s, c) = libm::sincos(tau * (h * l * block) as f64 / LEN as f64);
                        let turn = Complex::new(c, s) * power;
                        expected += DMatrix::from_fn(N, N, |i, j| (lines[i][h].conj() * lines[j][h] * turn).re);
                    }
                }
                expected /= (LEN * LEN * (PERIODS - 1)) as f64;
                assert!((scatter.lag(l) - expected).norm() < 1e-13, "lag {l} of blocks of {block}");
            }
        }
    }

    #[test]
    fn identity_white_scatter_is_the_covariance_of_samples_and_a_filter_acts_on_each_period() {
        let (x, average) = noise();
        let scatter = Scatter::new(&x, &average.q, N, 1, |rows| rows).unwrap();
        assert!((scatter.lag(0) - average.effort_covariance.unwrap()).norm() < 1e-14);
        // A filter that takes away the mean of a period removes the covariance of these means, and nothing else.
        let mean = |rows: &[f64], i: usize| rows.iter().skip(i).step_by(N).sum::<f64>() / LEN as f64;
        let without_mean = |rows: Vec<f64>| {
            let means: Vec<f64> = (0..N).map(|i| mean(&rows, i)).collect();
            rows.iter().enumerate().map(|(at, value)| value - means[at % N]).collect()
        };
        let filtered = Scatter::new(&x, &average.q, N, 1, without_mean).unwrap();
        let mut of_means = DMatrix::zeros(N, N);
        for period in x.chunks_exact(N * LEN) {
            let off = deviations(period, &average.q);
            of_means += DMatrix::from_fn(N, N, |i, j| mean(&off, i) * mean(&off, j) / (PERIODS - 1) as f64);
        }
        assert!((scatter.lag(0) - filtered.lag(0) - of_means).norm() < 1e-13);
        assert!(Scatter::new(&x[..N * LEN], &average.q, N, 1, |rows| rows).is_none());
    }
}
