//! The derivative of a periodic function from its samples, and its transpose.
//!
//! ```text
//! f'(t_j) = (2π/T) Σ_k D_jk f(t_k)        D_jk = ½ (−1)^(j−k) cot((j−k) π/N)   N even
//!                                                ½ (−1)^(j−k) / sin((j−k) π/N) N odd
//! ```
//! Exact for trigonometric polynomials of less than N/2 harmonics. D is antisymmetric. Source: L. N. Trefethen, *Spectral
//! Methods in MATLAB*, 2000, ch. 3.

use std::f64::consts::{PI, TAU};

/// For `N` samples of one period.
#[derive(Clone, Debug)]
pub(super) struct PeriodicDerivative {
    /// D_j0 · 2π/T.
    kernel: Vec<f64>,
}

impl PeriodicDerivative {
    pub(super) fn new(samples: usize, period_s: f64) -> Self {
        let entry = |j: usize| {
            let (sign, angle) = (if j.is_multiple_of(2) { 0.5 } else { -0.5 }, j as f64 * PI / samples as f64);
            let (sine, cosine) = libm::sincos(angle);
            let shape = if samples.is_multiple_of(2) { cosine / sine } else { 1.0 / sine };
            sign * shape * TAU / period_s
        };
        Self { kernel: (0..samples).map(|j| if j == 0 { 0.0 } else { entry(j) }).collect() }
    }

    /// The derivatives of n functions, N × n row-major.
    pub(super) fn apply(&self, x: &[f64]) -> Vec<f64> {
        let samples = self.kernel.len();
        let n = x.len() / samples;
        let mut derivative = vec![0.0; x.len()];
        for (j, out) in derivative.chunks_exact_mut(n).enumerate() {
            for (k, x) in x.chunks_exact(n).enumerate() {
                let weight = self.kernel[(j + samples - k) % samples];
                for (out, x) in out.iter_mut().zip(x) {
                    *out += weight * x;
                }
            }
        }
        derivative
    }

    /// The transpose of [`Self::apply`].
    pub(super) fn transposed(&self, x: &[f64]) -> Vec<f64> {
        self.apply(x).into_iter().map(|entry| -entry).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_derivative_of_a_series() {
        for samples in [17, 20] {
            let derivative = PeriodicDerivative::new(samples, 5.0);
            let t = |k: usize| 5.0 * k as f64 / samples as f64;
            let omega = TAU / 5.0;
            let of = |f: &dyn Fn(f64) -> [f64; 2]| (0..samples).flat_map(|k| f(t(k))).collect::<Vec<f64>>();
            let x = of(&|t| [(7.0 * omega * t).sin() + 3.0, (2.0 * omega * t).cos()]);
            let expected = of(&|t| [7.0 * omega * (7.0 * omega * t).cos(), -2.0 * omega * (2.0 * omega * t).sin()]);
            for (found, expected) in derivative.apply(&x).iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            }
            // ⟨y, D x⟩ = ⟨Dᵀ y, x⟩.
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            assert!((dot(&x, &derivative.apply(&expected)) - dot(&derivative.transposed(&x), &expected)).abs() < 1e-10);
        }
    }
}
