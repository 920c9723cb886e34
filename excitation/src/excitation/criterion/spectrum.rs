//! Functions of the extreme eigenvalues of a symmetric matrix, and their derivatives.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

use super::definition::Score;
use crate::linalg::symmetric_eigen;

/// `½ (ln λ_max − ln λ_min)` and one subgradient; with a sharpness p its bound `1/(2p) (ln Σ λ^p + ln Σ λ^−p)` and the gradient.
pub(super) fn log_condition(m: &DMatrix<f64>, sharpness: Option<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
    spectral(m, sensitivity, |values, weights| {
        let (low, high) = extremes(values);
        let exact = 0.5 * (libm::log(values[high]) - libm::log(values[low]));
        let Some(p) = sharpness else {
            weights[high] = 0.5 / values[high];
            weights[low] -= 0.5 / values[low];
            return Score::exact(exact);
        };
        let powers = Powers::of(values, p);
        for (i, weight) in weights.iter_mut().enumerate() {
            *weight = 0.5 * (powers.high_share(i) - powers.low_share(i)) / values[i];
        }
        Score { value: powers.log_condition(), exact }
    })
}

/// Powers λ^p and λ^−p of all eigenvalues, relative to those of the extremes, so that nothing overflows.
pub(super) struct Powers {
    p: f64,
    /// ln λ_max and −ln λ_min.
    log_high: f64,
    log_low: f64,
    up: Vec<f64>,
    down: Vec<f64>,
    sum_up: f64,
    sum_down: f64,
}

impl Powers {
    pub(super) fn of(values: &[f64], p: f64) -> Self {
        let logs: Vec<f64> = values.iter().map(|&x| libm::log(x)).collect();
        let (low, high) = extremes(values);
        let up: Vec<f64> = logs.iter().map(|x| libm::exp(p * (x - logs[high]))).collect();
        let down: Vec<f64> = logs.iter().map(|x| libm::exp(p * (logs[low] - x))).collect();
        let (sum_up, sum_down) = (up.iter().sum::<f64>(), down.iter().sum::<f64>());
        Self { p, log_high: logs[high], log_low: -logs[low], up, down, sum_up, sum_down }
    }

    /// `1/(2p) (ln Σ λ^p + ln Σ λ^−p)`, at least ln κ.
    pub(super) fn log_condition(&self) -> f64 {
        0.5 * (self.log_high + self.log_low) + 0.5 * (libm::log(self.sum_up) + libm::log(self.sum_down)) / self.p
    }

    /// `1/p ln Σ λ^−p`, at least −ln λ_min.
    pub(super) fn inverse_smallest(&self) -> f64 {
        self.log_low + libm::log(self.sum_down) / self.p
    }

    /// `λ_i^p / Σ λ^p`.
    pub(super) fn high_share(&self, i: usize) -> f64 {
        self.up[i] / self.sum_up
    }

    /// `λ_i^−p / Σ λ^−p`.
    pub(super) fn low_share(&self, i: usize) -> f64 {
        self.down[i] / self.sum_down
    }
}

/// Indices of the smallest and of the largest.
pub(super) fn extremes(values: &[f64]) -> (usize, usize) {
    let (mut low, mut high) = (0, 0);
    for (i, &x) in values.iter().enumerate() {
        if x < values[low] {
            low = i;
        }
        if x > values[high] {
            high = i;
        }
    }
    (low, high)
}

/// A symmetric function of the eigenvalues: `of` returns its value and fills ∂value/∂λ_i; `S = V diag(∂) Vᵀ`.
pub(super) fn spectral(
    m: &DMatrix<f64>,
    sensitivity: Option<&mut DMatrix<f64>>,
    of: impl Fn(&[f64], &mut [f64]) -> Score,
) -> Score {
    let b = m.nrows();
    let mut weights = vec![0.0; b];
    let (values, vectors) = match &sensitivity {
        Some(_) => {
            let eigen = symmetric_eigen(m.clone());
            (eigen.eigenvalues, Some(eigen.eigenvectors))
        }
        None => (m.symmetric_eigenvalues(), None),
    };
    let largest = values.iter().fold(0.0_f64, |x, y| x.max(*y));
    // Below the rounding of the eigenvalues a positive one is as good as none.
    let sound = values.iter().all(|&x| x > 1e-15 * largest);
    let value = if sound { of(values.as_slice(), &mut weights) } else { Score::exact(f64::INFINITY) };
    if let (Some(s), Some(vectors)) = (sensitivity, vectors) {
        s.fill(0.0);
        Arch::new().dispatch(Outer { weights: &weights, vectors: vectors.as_slice(), sum: s.as_mut_slice() });
        s.fill_upper_triangle_with_lower_triangle();
    }
    value
}

/// Adds the lower triangle of `Σ w_i v_i v_iᵀ` for the columns v_i, compiled for the vectors of the processor by their width alone.
struct Outer<'a> {
    weights: &'a [f64],
    vectors: &'a [f64],
    sum: &'a mut [f64],
}

impl WithSimd for Outer<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let b = self.weights.len();
        let largest = self.weights.iter().fold(0.0_f64, |x, y| x.max(y.abs()));
        for (&weight, v) in self.weights.iter().zip(self.vectors.chunks_exact(b)) {
            if weight.abs() <= 1e-18 * largest {
                continue;
            }
            for (c, (&vc, column)) in v.iter().zip(self.sum.chunks_exact_mut(b)).enumerate() {
                let factor = weight * vc;
                for (entry, &vr) in column[c..].iter_mut().zip(&v[c..]) {
                    *entry += factor * vr;
                }
            }
        }
    }
}
