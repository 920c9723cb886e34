//! One joint's motion over one period as a curve whose extrema are known between samples.

use super::extremum::{EXTREMUM_TOLERANCE, Extremum, Smooth};
use super::piecewise::{PiecewisePolynomial, derivative, horner};
use super::trigonometric::{CELLS_PER_HARMONIC, TrigonometricPolynomial};

/// A joint's position or one of its derivatives over the phase θ = ωt ∈ [0, 2π).
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// A finite Fourier series.
    Trigonometric(TrigonometricPolynomial),
    /// A finite Fourier series plus a polynomial in u = θ/2π, ascending powers.
    Mixed(TrigonometricPolynomial, Vec<f64>),
    /// Polynomials one after the other.
    Piecewise(PiecewisePolynomial),
}

impl Curve {
    /// The value at phase `phase`, rad.
    pub fn value(&self, phase: f64) -> f64 {
        match self {
            Self::Trigonometric(wave) => wave.value(phase),
            Self::Mixed(wave, polynomial) => wave.value(phase) + horner(polynomial, turn(phase)),
            Self::Piecewise(pieces) => pieces.value(phase),
        }
    }

    /// The largest value over the period: exact to rounding for polynomials, else to
    /// [`EXTREMUM_TOLERANCE`] of the sum of the amplitudes.
    pub fn maximum(&self) -> Extremum {
        match self {
            Self::Trigonometric(wave) => wave.maximum(),
            Self::Mixed(wave, polynomial) => mixed_maximum(wave, polynomial),
            Self::Piecewise(pieces) => pieces.extremum(1.0),
        }
    }

    /// The smallest value over the period, as [`Self::maximum`].
    pub fn minimum(&self) -> Extremum {
        match self {
            Self::Trigonometric(wave) => wave.minimum(),
            Self::Mixed(wave, polynomial) => {
                let polynomial: Vec<f64> = polynomial.iter().map(|c| -c).collect();
                mixed_maximum(&wave.negated(), &polynomial).negated()
            }
            Self::Piecewise(pieces) => pieces.extremum(-1.0),
        }
    }

    /// The largest magnitude over the period.
    pub fn peak(&self) -> f64 {
        self.maximum().value.max(-self.minimum().value)
    }
}

/// Part of the period that has passed at a phase.
fn turn(phase: f64) -> f64 {
    phase.rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU
}

fn mixed_maximum(wave: &TrigonometricPolynomial, polynomial: &[f64]) -> Extremum {
    let per_turn = 1.0 / std::f64::consts::TAU;
    let first = derivative(polynomial);
    let second = derivative(&first);
    let third = derivative(&second);
    let size = |values: &[f64]| values.iter().map(|x| x.abs()).sum::<f64>();
    let amplitudes = wave.amplitudes();
    let wave_third: f64 = amplitudes.iter().enumerate().map(|(l, a)| ((l + 1) as f64).powi(3) * a).sum();
    let total = size(&amplitudes) + size(polynomial);
    if total == 0.0 || !total.is_finite() {
        return Extremum { phase: 0.0, value: wave.mean + total };
    }
    Smooth {
        jet: |phase| {
            let (value, slope, curvature) = wave.jet(phase);
            let u = turn(phase);
            (
                value + horner(polynomial, u),
                slope + per_turn * horner(&first, u),
                curvature + per_turn * per_turn * horner(&second, u),
            )
        },
        cells: CELLS_PER_HARMONIC * wave.harmonics().max(2),
        third: wave_third + per_turn * per_turn * per_turn * size(&third),
        tolerance: EXTREMUM_TOLERANCE * total,
    }
    .maximum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;
    use std::f64::consts::TAU;

    #[test]
    fn identity_mixed_extremum_bounds_dense_samples() {
        for run in 0..10 {
            let mut rng = Seed::new(13).stream("mixed", run);
            let mut draw = |count: usize| (0..count).map(|_| rng.random_range(-1.0..1.0)).collect::<Vec<f64>>();
            let wave = TrigonometricPolynomial { mean: draw(1)[0], cosine: draw(4), sine: draw(4) };
            let curve = Curve::Mixed(wave, draw(6));
            let (high, low) = (curve.maximum(), curve.minimum());
            assert_eq!(curve.value(high.phase), high.value);
            let values = (0..50_000).map(|k| curve.value(TAU * f64::from(k) / 50_000.0));
            let (bottom, top) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            // A peak between two samples hides ½ M₂ (step/2)² = 4e-7, the jump at the end a slope of 30 times a step.
            assert!(high.value >= top - 1e-9 && high.value - top < 4e-3, "{} {top}", high.value);
            assert!(low.value <= bottom + 1e-9 && bottom - low.value < 4e-3, "{} {bottom}", low.value);
        }
    }
}
