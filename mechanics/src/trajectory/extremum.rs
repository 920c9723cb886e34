//! The largest value of a smooth curve over one period, bounded between samples.
//!
//! Branch and bound: on a cell of half width h about θ₀
//!
//! ```text
//! p(θ) ≤ max_{|δ| ≤ h} p(θ₀) + p'(θ₀) δ + ½ p''(θ₀) δ² + ⅙ M₃ h³,      M₃ ≥ |p'''|
//! ```
//! and cells that cannot hold the maximum are dropped; what is left is halved until the bound meets the value.

use std::f64::consts::{PI, TAU};

/// Where an extremum lies and how large it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// Phase in `[0, 2π)`, rad.
    pub phase: f64,
    /// Value there.
    pub value: f64,
}

impl Extremum {
    pub(super) fn negated(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

/// How far, relative to the sum of the amplitudes, the found extremum may lie from the true one.
pub const EXTREMUM_TOLERANCE: f64 = 1e-10;

/// A curve as the search sees it.
pub(super) struct Smooth<F> {
    /// Value, first and second derivative at a phase.
    pub(super) jet: F,
    /// Cells of the first level; their edges include the phase 0.
    pub(super) cells: usize,
    /// Bound M₃ of the third derivative.
    pub(super) third: f64,
    /// Excess over the best value found that may be missed.
    pub(super) tolerance: f64,
}

impl<F: Fn(f64) -> (f64, f64, f64)> Smooth<F> {
    /// The largest value, to the tolerance.
    pub(super) fn maximum(&self) -> Extremum {
        let cells = self.cells;
        let mut half = PI / cells as f64;
        let mut best = Extremum { phase: 0.0, value: f64::NEG_INFINITY };
        let mut open: Vec<f64> = (0..cells).map(|k| (2 * k + 1) as f64 * half).collect();
        let mut bounded = Vec::new();
        // Each level shrinks the remainder eightfold, and what slope and curvature add to a cell's value at least twofold:
        // below the tolerance no cell stays open, so that the search has one end only, where the bound meets the value.
        while !open.is_empty() {
            let remainder = self.third * half * half * half / 6.0;
            bounded.clear();
            for &phase in &open {
                let (value, slope, curvature) = (self.jet)(phase);
                let bound = quadratic_maximum(value, slope, curvature, half) + remainder;
                bounded.push((phase, bound));
                if value > best.value {
                    best = Extremum { phase, value };
                }
            }
            best = self.polish(best, half);
            open.clear();
            half *= 0.5;
            for &(phase, bound) in &bounded {
                if bound > best.value + self.tolerance {
                    open.push(phase - half);
                    open.push(phase + half);
                }
            }
        }
        best
    }

    /// Newton steps on p' = 0 from a point, kept only while they climb. How far they come is not relied on: they make
    /// cells close earlier.
    fn polish(&self, from: Extremum, reach: f64) -> Extremum {
        let mut best = from;
        for _ in 0..8 {
            let (_, slope, curvature) = (self.jet)(best.phase);
            if curvature >= 0.0 {
                break;
            }
            let step = (-slope / curvature).clamp(-reach, reach);
            let phase = (best.phase + step).rem_euclid(TAU);
            let value = (self.jet)(phase).0;
            if value <= best.value {
                break;
            }
            best = Extremum { phase, value };
        }
        best
    }
}

/// Largest value of `value + slope δ + ½ curvature δ²` for |δ| ≤ h.
fn quadratic_maximum(value: f64, slope: f64, curvature: f64, h: f64) -> f64 {
    let edge = value + slope.abs() * h + 0.5 * curvature * h * h;
    if curvature < 0.0 && slope.abs() < -curvature * h { value - 0.5 * slope * slope / curvature } else { edge }
}
