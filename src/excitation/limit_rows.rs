//! Limits of position, velocity and acceleration as linear rows, at the true extrema of a trial step.
//!
//! ```text
//! row(θ)ᵀ (x + d) ≤ limit   for all θ        →        row(θ*)ᵀ d ≤ limit − row(θ*)ᵀ x   at each local peak θ* of x + d
//! ```
//! The rows are constant, and each touches the variables of one joint only. Peaks are found on a grid of the joint's
//! own polynomial and polished by Newton steps, so that a limit holds between samples, not only on them.

use std::f64::consts::TAU;

use super::Margins;
use super::basis::{FourierBasis, Quantity};
use super::limits::permitted;
use super::optimiser::{LinearLimits, Row, RowSource};
use crate::model::Robot;

/// Grid points for each harmonic: the peak of the highest one falls at most 1 − cos(π/12) = 3 % on the grid.
const GRID_PER_HARMONIC: usize = 12;

/// The limits of a robot as a source of rows around the current variables.
#[derive(Clone, Debug)]
pub struct LimitRows {
    basis: FourierBasis,
    /// Interval of each quantity of each joint, already inside the limit by the margin.
    intervals: Vec<[(f64, f64); 3]>,
    /// cos lθ and sin lθ on the grid, row-major.
    waves: Vec<f64>,
    grid: usize,
    center: Vec<f64>,
    /// Excess that counts as none, relative to the size of the interval.
    tolerance: f64,
}

impl LimitRows {
    /// The limits of `robot`, of which the parts `margins` may be used; excess up to `tolerance` relative to the limit
    /// counts as none.
    #[must_use]
    pub fn new(robot: &Robot, basis: &FourierBasis, margins: &Margins, tolerance: f64) -> Self {
        let grid = GRID_PER_HARMONIC * basis.harmonics();
        let mut waves = Vec::with_capacity(2 * grid * basis.harmonics());
        for k in 0..grid {
            for l in 1..=basis.harmonics() {
                let (s, c) = libm::sincos(TAU * ((k * l) % grid) as f64 / grid as f64);
                waves.extend([c, s]);
            }
        }
        let intervals = robot
            .joints()
            .iter()
            .map(|joint| Quantity::ALL.map(|quantity| permitted(&joint.limits, quantity, margins.of(quantity))))
            .collect();
        Self { basis: basis.clone(), intervals, waves, grid, center: vec![0.0; basis.variables()], tolerance }
    }

    /// One row, at a phase, for the upper (`sign` = 1) or lower (−1) end of the interval.
    fn row(&self, joint: usize, quantity: Quantity, phase: f64, sign: f64) -> Row {
        let normal = self.basis.row(joint, quantity, phase, sign);
        let start = joint * self.basis.block();
        let (low, high) = self.intervals[joint][quantity as usize];
        let end = if sign > 0.0 { high } else { -low };
        let now: f64 = normal.iter().zip(&self.center[start..]).map(|(a, x)| a * x).sum();
        Row { start, normal, bound: end - now }
    }

    /// Rows at the local peaks of `sign · values` (on the grid) that exceed the interval.
    fn peaks(&self, joint: usize, quantity: Quantity, sign: f64, x: &[f64], values: &[f64], rows: &mut Vec<Row>) {
        let (low, high) = self.intervals[joint][quantity as usize];
        let end = if sign > 0.0 { high } else { -low };
        if !end.is_finite() {
            return;
        }
        let size = if low.is_finite() && high.is_finite() { 0.5 * (high - low) } else { end.abs().max(1.0) };
        let count = values.len();
        for k in 0..count {
            let before = sign * values[(k + count - 1) % count];
            let here = sign * values[k];
            let after = sign * values[(k + 1) % count];
            if here < before || here <= after {
                continue;
            }
            // The vertex of the parabola through three points, with room for its error.
            let (slope, curvature) = (0.5 * (after - before), before - 2.0 * here + after);
            let shift = if curvature < 0.0 { (-slope / curvature).clamp(-1.0, 1.0) } else { 0.0 };
            let estimate = here + 0.5 * slope * shift;
            if estimate + 0.05 * (estimate - before.min(after)) <= end {
                continue;
            }
            let phase = self.polish(quantity, sign, x, TAU * (k as f64 + shift) / count as f64);
            let row = self.row(joint, quantity, phase, sign);
            let value: f64 = row.normal.iter().zip(x).map(|(a, x)| a * x).sum();
            if value - end > self.tolerance * size {
                rows.push(row);
            }
        }
    }

    /// Newton steps to a local peak of `sign · quantity` from a phase near it.
    fn polish(&self, quantity: Quantity, sign: f64, x: &[f64], from: f64) -> f64 {
        let reach = TAU / self.grid as f64;
        let mut phase = from;
        for _ in 0..4 {
            let (s1, c1) = libm::sincos(phase);
            let (mut s, mut c) = (s1, c1);
            let (mut slope, mut curvature) = (0.0, 0.0);
            for (l, pair) in x[..x.len() - 1].chunks_exact(2).enumerate() {
                let order = (l + 1) as f64;
                let (along, across) = (pair[0] * c + pair[1] * s, pair[1] * c - pair[0] * s);
                // Up to the common factors, q ∝ −across/l, q̇ ∝ along, q̈ ∝ l · across.
                let (d1, d2) = match quantity {
                    Quantity::Position => (along, order * across),
                    Quantity::Velocity => (order * across, -order * order * along),
                    Quantity::Acceleration => (-order * order * along, -order * order * order * across),
                };
                slope += d1;
                curvature += d2;
                (s, c) = (s * c1 + c * s1, c * c1 - s * s1);
            }
            if sign * curvature >= 0.0 {
                break;
            }
            let step = (-slope / curvature).clamp(-reach, reach);
            phase += step;
            if step.abs() < 1e-9 {
                break;
            }
        }
        phase
    }
}

impl RowSource for LimitRows {
    fn violated(&mut self, step: &[f64], rows: &mut Vec<Row>) {
        let (block, harmonics, omega) = (self.basis.block(), self.basis.harmonics(), self.basis.omega());
        let mut x = vec![0.0; block];
        let mut values = [vec![0.0; self.grid], vec![0.0; self.grid], vec![0.0; self.grid]];
        let frequency: Vec<f64> = (1..=harmonics).map(|l| omega * l as f64).collect();
        for joint in 0..self.basis.dof() {
            let range = joint * block..(joint + 1) * block;
            for ((x, c), d) in x.iter_mut().zip(&self.center[range.clone()]).zip(&step[range]) {
                *x = c + d;
            }
            let (scale, q0) = self.basis.scaled_mean(joint, &x);
            for (k, waves) in self.waves.chunks_exact(2 * harmonics).enumerate() {
                let (mut q, mut qd, mut qdd) = (0.0, 0.0, 0.0);
                for ((pair, wave), w) in x.chunks_exact(2).zip(waves.chunks_exact(2)).zip(&frequency) {
                    let turned = pair[0] * wave[1] - pair[1] * wave[0];
                    q += turned / w;
                    qd += pair[0] * wave[0] + pair[1] * wave[1];
                    qdd -= turned * w;
                }
                values[0][k] = q0 + scale * q;
                values[1][k] = scale * qd;
                values[2][k] = scale * qdd;
            }
            for (quantity, values) in Quantity::ALL.into_iter().zip(&values) {
                for sign in [1.0, -1.0] {
                    self.peaks(joint, quantity, sign, &x, values, rows);
                }
            }
        }
    }
}

impl LinearLimits for LimitRows {
    fn recenter(&mut self, x: &[f64]) {
        self.center.copy_from_slice(x);
    }
}
