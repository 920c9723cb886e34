//! How large does a trigonometric polynomial get anywhere in its period, not only at samples?
//!
//! ```text
//! p(θ) = mean + Σ_{l=1..H} c_l cos lθ + s_l sin lθ,      θ ∈ [0, 2π)
//! ```
//! Position, velocity and acceleration of a Fourier trajectory are such polynomials, so their limits can be held
//! between samples, by the search of `extremum`, with
//!
//! ```text
//! M₃ = Σ l³ √(c_l² + s_l²) ≥ |p'''|
//! ```

use super::extremum::{EXTREMUM_TOLERANCE, Extremum, Smooth};

/// A trigonometric polynomial in the phase θ; index l − 1 of the two vectors belongs to harmonic l.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::TrigonometricPolynomial;
/// let p = TrigonometricPolynomial { mean: 1.0, cosine: vec![3.0], sine: vec![4.0] };
/// assert!((p.maximum().value - 6.0).abs() < 1e-9);
/// assert!((p.minimum().value + 4.0).abs() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TrigonometricPolynomial {
    /// The constant term.
    pub mean: f64,
    /// Coefficients of cos lθ.
    pub cosine: Vec<f64>,
    /// Coefficients of sin lθ; as many.
    pub sine: Vec<f64>,
}

/// Cells of the first level for each harmonic.
pub(super) const CELLS_PER_HARMONIC: usize = 8;

impl TrigonometricPolynomial {
    /// Number of harmonics H.
    pub fn harmonics(&self) -> usize {
        self.cosine.len()
    }

    /// The value at phase `phase`, rad.
    pub fn value(&self, phase: f64) -> f64 {
        self.jet(phase).0
    }

    /// The largest value over the period, to [`EXTREMUM_TOLERANCE`] of the sum of the amplitudes.
    pub fn maximum(&self) -> Extremum {
        let amplitudes = self.amplitudes();
        let total: f64 = amplitudes.iter().sum();
        if total == 0.0 || !total.is_finite() {
            return Extremum { phase: 0.0, value: self.mean + total };
        }
        let third = amplitudes.iter().enumerate().map(|(l, a)| ((l + 1) as f64).powi(3) * a).sum();
        Smooth {
            jet: |phase| self.jet(phase),
            cells: CELLS_PER_HARMONIC * self.harmonics(),
            third,
            tolerance: EXTREMUM_TOLERANCE * total,
        }
        .maximum()
    }

    /// The smallest value over the period, as [`Self::maximum`].
    pub fn minimum(&self) -> Extremum {
        self.negated().maximum().negated()
    }

    pub(super) fn negated(&self) -> Self {
        let negated = |values: &[f64]| values.iter().map(|x| -x).collect();
        Self { mean: -self.mean, cosine: negated(&self.cosine), sine: negated(&self.sine) }
    }

    pub(super) fn amplitudes(&self) -> Vec<f64> {
        self.cosine.iter().zip(&self.sine).map(|(c, s)| libm::hypot(*c, *s)).collect()
    }

    /// Value, first and second derivative at a phase.
    pub(super) fn jet(&self, phase: f64) -> (f64, f64, f64) {
        let (s1, c1) = libm::sincos(phase);
        let (mut s, mut c) = (s1, c1);
        let (mut value, mut slope, mut curvature) = (self.mean, 0.0, 0.0);
        for (l, (cosine, sine)) in self.cosine.iter().zip(&self.sine).enumerate() {
            let order = (l + 1) as f64;
            let term = cosine * c + sine * s;
            value += term;
            slope += order * (sine * c - cosine * s);
            curvature -= order * order * term;
            (s, c) = (s * c1 + c * s1, c * c1 - s * s1);
        }
        (value, slope, curvature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;
    use std::f64::consts::TAU;

    fn random(harmonics: usize, run: u64) -> TrigonometricPolynomial {
        let mut rng = Seed::new(11).stream("trigonometric polynomial", run);
        let mut draw = || rng.random_range(-1.0..1.0);
        TrigonometricPolynomial {
            mean: draw(),
            cosine: (0..harmonics).map(|_| draw()).collect(),
            sine: (0..harmonics).map(|_| draw()).collect(),
        }
    }

    #[test]
    fn analytic_single_harmonic_has_its_amplitude() {
        for l in 1..6 {
            let mut p = TrigonometricPolynomial { mean: 0.3, cosine: vec![0.0; l], sine: vec![0.0; l] };
            p.cosine[l - 1] = 1.2;
            p.sine[l - 1] = -0.5;
            assert!((p.maximum().value - 1.6).abs() < 1e-12 && (p.minimum().value + 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn analytic_nearly_equal_peaks_give_the_higher_one() {
        // cos 2θ has two equal peaks; the slight tilt decides: p(0) = 1 + ε, p(π) = 1 − ε.
        let p = TrigonometricPolynomial { mean: 0.0, cosine: vec![1e-7, 1.0], sine: vec![0.0, 0.0] };
        let top = p.maximum();
        assert!((top.value - (1.0 + 1e-7)).abs() < 1e-12 && libm::cos(top.phase) > 0.99);
    }

    #[test]
    fn analytic_flat_peak_is_bounded_too() {
        // cos⁴(θ/2) has its minimum 0 of fourth order at π: ⅜ + ½ cos θ + ⅛ cos 2θ.
        let p = TrigonometricPolynomial { mean: 0.375, cosine: vec![0.5, 0.125], sine: vec![0.0, 0.0] };
        assert!(p.minimum().value.abs() < 1e-10 && (p.maximum().value - 1.0).abs() < 1e-12);
    }

    #[test]
    fn identity_extremum_bounds_a_million_samples() {
        for run in 0..20 {
            let p = random(1 + run as usize % 8, run);
            let (high, low) = (p.maximum().value, p.minimum().value);
            let count = 50_000;
            let (mut top, mut bottom) = (f64::NEG_INFINITY, f64::INFINITY);
            for k in 0..count {
                let value = p.value(TAU * f64::from(k) / f64::from(count));
                top = top.max(value);
                bottom = bottom.min(value);
            }
            // A grid misses at most ½ M₂ (step/2)² = 3e-7 for eight harmonics of amplitude √2.
            assert!(high >= top - 1e-9 && high - top < 1e-6, "{high} against {top}");
            assert!(low <= bottom + 1e-9 && bottom - low < 1e-6, "{low} against {bottom}");
        }
    }
}
