//! Many lags at once, by the convolution theorem.
//!
//! ```text
//! (C w)_k,i = Σ_j Σ_d g_ij(d) w_{k+d,j}        g_ij(d) = R_ij(d), and R_ji(−d) for d < 0
//! ```
//! The series are continued by L samples on both sides, by the period or by zeros, so that the circular convolution of
//! the transform touches none of the N that count.

use nalgebra::{Complex, DMatrix};

use super::fourier_transform::{FourierTransform, smooth_length};

/// Lag covariances as spectra, for series of one length.
pub(super) struct NoiseSpectrum {
    transform: FourierTransform,
    wraps: bool,
    lead: usize,
    /// G_ij, row-major n × n, each a spectrum.
    kernels: Vec<Vec<Complex<f64>>>,
}

impl NoiseSpectrum {
    /// For series of `count` samples, more than there are lags.
    pub(super) fn new(lags: &[DMatrix<f64>], wraps: bool, count: usize) -> Self {
        let (n, lead) = (lags[0].nrows(), lags.len() - 1);
        let transform = FourierTransform::new(smooth_length(count + 2 * lead));
        let len = transform.len();
        let kernel = |at: usize| {
            let (i, j) = (at / n, at % n);
            let mut kernel = vec![0.0; len];
            for (l, r) in lags.iter().enumerate() {
                kernel[(len - l) % len] = r[(i, j)];
                if l > 0 {
                    kernel[l] = r[(j, i)];
                }
            }
            kernel
        };
        let mut kernels = Vec::with_capacity(n * n);
        for at in (0..n * n).step_by(2) {
            if at + 1 < n * n {
                let (first, second) = transform.forward_pair(&kernel(at), &kernel(at + 1));
                kernels.extend([first, second]);
            } else {
                kernels.push(transform.forward_real(&kernel(at)));
            }
        }
        Self { transform, wraps, lead, kernels }
    }

    /// Writes C w, one series per joint. Real and imaginary part are two series of their own, since C is real.
    pub(super) fn apply(&self, from: &[Vec<Complex<f64>>], to: &mut [Vec<Complex<f64>>]) {
        let (n, len) = (from.len(), self.transform.len());
        let spectra: Vec<Vec<Complex<f64>>> =
            from.iter().map(|series| self.transform.forward(&self.continued(series))).collect();
        for (i, to) in to.iter_mut().enumerate() {
            let mut sum = vec![Complex::new(0.0, 0.0); len];
            for (j, spectrum) in spectra.iter().enumerate() {
                for ((sum, &g), &w) in sum.iter_mut().zip(&self.kernels[i * n + j]).zip(spectrum) {
                    // Conjugated, so that the forward transform runs backwards.
                    *sum += (g * w).conj();
                }
            }
            let back = self.transform.forward(&sum);
            for (to, value) in to.iter_mut().zip(&back[self.lead..]) {
                *to = value.conj() / len as f64;
            }
        }
    }

    fn continued(&self, series: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let (count, lead) = (series.len(), self.lead);
        let mut x = vec![Complex::new(0.0, 0.0); self.transform.len()];
        x[lead..lead + count].copy_from_slice(series);
        if self.wraps {
            x[..lead].copy_from_slice(&series[count - lead..]);
            x[lead + count..2 * lead + count].copy_from_slice(&series[..lead]);
        }
        x
    }
}
