//! The shape functions of one joint: what its coefficients are multiplied with.
//!
//! ```text
//! series    q = Σ_l a_l s_l + b_l c_l + q0            s_l = sin ωlt/(ωl) [− T A(u)]     c_l = −cos ωlt/(ωl) [− ωl T² B(u)]
//! spline    q = Σ_k c_k N(K u − k)                    u = t/T
//! ```
//! In brackets what the quintic adds that lets the series start and stop at rest.

use std::f64::consts::TAU;

use super::b_spline::coefficient;
use super::fourier_quintic::{CURVATURE, SLOPE};
use super::linear_family::{MotionScale, ShapeFunctions};
use super::piecewise::{derivative, horner};

/// Grid points for each harmonic: the peak of the highest one falls at most 1 − cos(π/12) = 3 % on the grid.
const GRID_PER_HARMONIC: usize = 12;

/// Grid points for each interval between knots, the knots among them.
const GRID_PER_KNOT: usize = 6;

/// The quintic contributes like a low harmonic of its own.
const QUINTIC_HARMONICS: usize = 2;

/// The shape functions of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// `(a_1, b_1, …, a_H, b_H, q0)`.
    Series { period_s: f64, harmonics: usize, at_rest: bool },
    /// One value for each knot.
    Spline { period_s: f64, degree: usize, knots: usize },
}

impl ShapeFunctions for Shape {
    fn count(&self) -> usize {
        match self {
            Self::Series { harmonics, .. } => 2 * *harmonics + 1,
            Self::Spline { knots, .. } => *knots,
        }
    }

    fn grid(&self) -> usize {
        match self {
            Self::Series { harmonics, at_rest: false, .. } => GRID_PER_HARMONIC * *harmonics,
            Self::Series { harmonics, at_rest: true, .. } => GRID_PER_HARMONIC * (*harmonics + QUINTIC_HARMONICS),
            Self::Spline { knots, .. } => GRID_PER_KNOT * *knots,
        }
    }

    fn fill(&self, phase: f64, order: usize, out: &mut [f64]) {
        match *self {
            Self::Series { period_s, harmonics, at_rest } => {
                series(period_s, harmonics, phase, order, out);
                if at_rest {
                    take_ends_away(period_s, harmonics, phase, order, out);
                }
            }
            Self::Spline { period_s, degree, knots } => spline(period_s, degree, knots, phase, order, out),
        }
    }

    fn constant(&self) -> Vec<f64> {
        match self {
            Self::Series { .. } => [vec![0.0; self.count() - 1], vec![1.0]].concat(),
            Self::Spline { knots, .. } => vec![1.0; *knots],
        }
    }

    fn scales(&self, scale: &MotionScale) -> Vec<f64> {
        match self {
            // Amplitudes of speed, and a position.
            Self::Series { .. } => [vec![scale.speed; self.count() - 1], vec![scale.range]].concat(),
            Self::Spline { .. } => vec![scale.speed / scale.omega; self.count()],
        }
    }
}

fn series(period_s: f64, harmonics: usize, phase: f64, order: usize, out: &mut [f64]) {
    let omega = TAU / period_s;
    let (s1, c1) = libm::sincos(phase);
    let (mut s, mut c) = (s1, c1);
    for l in 0..harmonics {
        let w = omega * (l + 1) as f64;
        let size = (0..order).fold(1.0 / w, |product, _| product * w);
        // The derivatives of sine and cosine.
        let (sine, cosine) = match order % 4 {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        };
        out[2 * l] = size * sine;
        out[2 * l + 1] = -size * cosine;
        (s, c) = (s * c1 + c * s1, c * c1 - s * s1);
    }
    out[2 * harmonics] = if order == 0 { 1.0 } else { 0.0 };
}

fn take_ends_away(period_s: f64, harmonics: usize, phase: f64, order: usize, out: &mut [f64]) {
    let u = phase.rem_euclid(TAU) / TAU;
    let value = |polynomial: &[f64]| {
        let turned = (0..order).fold(polynomial.to_vec(), |p, _| derivative(&p).iter().map(|c| c / period_s).collect());
        horner(&turned, u)
    };
    let slope = period_s * value(&SLOPE);
    let curvature = period_s * period_s * value(&CURVATURE);
    for l in 0..harmonics {
        out[2 * l] -= slope;
        out[2 * l + 1] -= TAU / period_s * (l + 1) as f64 * curvature;
    }
}

fn spline(period_s: f64, degree: usize, knots: usize, phase: f64, order: usize, out: &mut [f64]) {
    out.fill(0.0);
    let x = phase.rem_euclid(TAU) / TAU * knots as f64;
    // A phase meant for a knot may lie a rounding before it.
    let interval = (x + 1e-12).floor();
    let s = (x - interval).max(0.0);
    let interval = interval as usize % knots;
    let rate = (0..order).fold(1.0, |product, _| product * knots as f64 / period_s);
    for j in 0..=degree {
        let value = (0..=degree.saturating_sub(order))
            .rev()
            .fold(0.0, |sum, power| sum * s + coefficient(degree, j, order, power));
        out[(interval + knots - j) % knots] += rate * value;
    }
}

#[cfg(test)]
mod tests {
    use crate::seed::Seed;
    use crate::trajectory::{Family, TrajectoryFamily};
    use rand::RngExt;

    #[test]
    fn identity_shapes_equal_the_curves_of_every_family_and_order() {
        for family in Family::ALL {
            let shape = family.shape(7.0, 4);
            let mut rng = Seed::new(31).stream(family.name(), 0);
            let values: Vec<f64> = (0..shape.count()).map(|_| rng.random_range(-1.0..1.0)).collect();
            let trajectory = family.trajectory(7.0, vec![(String::new(), values.clone())]);
            assert_eq!(family.coefficients(&trajectory, 0, 4), Ok(values.clone()));
            let mut row = vec![0.0; shape.count()];
            for order in 0..=4 {
                let curve = trajectory.derivative(0, order);
                for k in 0..40 {
                    let phase = 0.155 * f64::from(k) + 0.01;
                    shape.fill(phase, order, &mut row);
                    let found: f64 = row.iter().zip(&values).map(|(a, x)| a * x).sum();
                    let expected = curve.value(phase);
                    // Snap reaches (9/7)⁴ · 100.
                    assert!((found - expected).abs() < 1e-9, "{} {order}: {found} {expected}", family.name());
                }
            }
            shape.fill(1.0, 0, &mut row);
            let still: f64 = row.iter().zip(shape.constant()).map(|(a, x)| a * x).sum();
            assert!((still - 1.0).abs() < 1e-15);
        }
    }
}
