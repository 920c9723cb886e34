//! The spectrum of the scatter over periods, from which the lag covariances of filtered noise follow.
//!
//! ```text
//! S[h] = 1/(P−1) Σ_p conj(E_p[h]) E_p[h]ᵀ     E_p the transform of e_p = x_p − x̄
//! R(l) = 1/N² Σ_h g[h]² S[h] exp(2πi h l / M)     h over all N lines
//! ```
//! is the lag covariance of one period after a filter of real gain g, at every N/M-th sample: what the averaged and
//! filtered signal carries, times P. Nothing is assumed of the noise but that it is stationary.

use nalgebra::{Complex, DMatrix};

use super::fourier_transform::FourierTransform;

/// Cross spectra of the deviations of single periods from their average.
#[derive(Clone, Debug)]
pub(super) struct ScatterSpectrum {
    dof: usize,
    /// Lower triangles (column by column) of S, one after another for the lines 0 to N/2.
    lines: Vec<Complex<f64>>,
}

impl ScatterSpectrum {
    /// From whole periods `x` ((P·N) × n row-major) and their average `mean` (N × n); `None` where P < 2.
    pub(super) fn new(transform: &FourierTransform, x: &[f64], mean: &[f64], dof: usize) -> Option<Self> {
        let samples = transform.len();
        let periods = x.len() / mean.len();
        if periods < 2 {
            return None;
        }
        let (half, triangle) = (samples / 2 + 1, dof * (dof + 1) / 2);
        let mut lines = vec![Complex::new(0.0, 0.0); half * triangle];
        for period in x.chunks_exact(mean.len()) {
            let series: Vec<Vec<f64>> =
                (0..dof).map(|i| (0..samples).map(|k| period[k * dof + i] - mean[k * dof + i]).collect()).collect();
            let mut spectra = Vec::with_capacity(dof);
            for pair in series.chunks(2) {
                match pair {
                    [a, b] => {
                        let (a, b) = transform.forward_pair(a, b);
                        spectra.extend([a, b]);
                    }
                    rest => spectra.extend(rest.iter().map(|a| transform.forward_real(a))),
                }
            }
            for (h, line) in lines.chunks_exact_mut(triangle).enumerate() {
                let mut at = 0;
                for j in 0..dof {
                    for i in j..dof {
                        line[at] += spectra[i][h].conj() * spectra[j][h];
                        at += 1;
                    }
                }
            }
        }
        let scale = 1.0 / ((periods - 1) as f64 * (samples as f64).powi(2));
        for (h, line) in lines.chunks_exact_mut(triangle).enumerate() {
            // Lines above N/2 mirror those below; 0 and N/2 stand alone.
            let mirrored = if h == 0 || 2 * h == samples { 1.0 } else { 2.0 };
            for entry in line {
                *entry *= scale * mirrored;
            }
        }
        Some(Self { dof, lines })
    }

    /// Returns this scatter after a filter of real gain `gain(h)` on line h.
    pub(super) fn filtered(mut self, gain: impl Fn(usize) -> f64) -> Self {
        let triangle = self.dof * (self.dof + 1) / 2;
        let mut last = 0;
        for (h, line) in self.lines.chunks_exact_mut(triangle).enumerate() {
            let power = gain(h).powi(2);
            // Lines far in the stop band are left out of every sum: their power is below a millionth of a millionth.
            if power > 1e-12 {
                last = h + 1;
            }
            for entry in line {
                *entry *= power;
            }
        }
        self.lines.truncate(last.max(1) * triangle);
        self
    }

    /// R(l), n × n, at a spacing of N/`count` samples.
    pub(super) fn lag(&self, l: usize, count: usize) -> DMatrix<f64> {
        let n = self.dof;
        let mut r = DMatrix::zeros(n, n);
        for (h, line) in self.lines.chunks_exact(n * (n + 1) / 2).enumerate() {
            let (s, c) = libm::sincos(std::f64::consts::TAU * ((h * l) % count) as f64 / count as f64);
            let mut at = 0;
            for j in 0..n {
                for i in j..n {
                    // R(l)_ij pairs joint i now with joint j later; R(l)_ji swaps them, which conjugates S.
                    let (even, odd) = (c * line[at].re, s * line[at].im);
                    r[(i, j)] += even - odd;
                    if i != j {
                        r[(j, i)] += even + odd;
                    }
                    at += 1;
                }
            }
        }
        r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use crate::signal::{PeriodAverage, PeriodicRecord};
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn identity_lags_are_the_circular_products_of_the_scatter() {
        let (n, len, periods) = (3, 24, 4);
        let mut rng = Seed::new(3).stream("scatter", 0);
        let x: Vec<f64> = (0..n * len * periods).map(|_| StandardNormal.sample(&mut rng)).collect();
        let record = PeriodicRecord { dof: n, rate_hz: 1.0, period_samples: len, q: &x, effort: &x };
        let average = PeriodAverage::new(&record).unwrap();
        let scatter = ScatterSpectrum::new(&FourierTransform::new(len), &x, &average.q, n).unwrap();
        assert!((scatter.lag(0, len) - average.effort_covariance.unwrap()).norm() < 1e-14);
        for spacing in [1, 3] {
            for l in 0..5 {
                let mut expected = DMatrix::zeros(n, n);
                for period in x.chunks_exact(n * len) {
                    let e = |k: usize, i: usize| period[k * n + i] - average.q[k * n + i];
                    for k in 0..len {
                        for i in 0..n {
                            for j in 0..n {
                                expected[(i, j)] += e(k, i) * e((k + l * spacing) % len, j);
                            }
                        }
                    }
                }
                expected /= (len * (periods - 1)) as f64;
                assert!((scatter.lag(l, len / spacing) - expected).norm() < 1e-13, "lag {l} of spacing {spacing}");
            }
        }
        // A filter that keeps every line but the mean removes the covariance of the means of periods, and nothing else.
        let mut of_means = DMatrix::zeros(n, n);
        for period in x.chunks_exact(n * len) {
            let mean = |i: usize| (0..len).map(|k| period[k * n + i] - average.q[k * n + i]).sum::<f64>() / len as f64;
            of_means += DMatrix::from_fn(n, n, |i, j| mean(i) * mean(j) / (periods - 1) as f64);
        }
        let without_mean = scatter.clone().filtered(|h| f64::from(u8::from(h > 0)));
        assert!((scatter.lag(0, len) - without_mean.lag(0, len) - of_means).norm() < 1e-13);
    }
}
