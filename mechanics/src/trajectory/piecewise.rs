//! A periodic curve made of polynomials, and its exact extrema.
//!
//! A polynomial rises or falls between the roots of its derivative, so the roots of each derivative part the line for
//! the one before it: from the last derivative upwards every root lies alone in an interval, where bisection finds it
//! to the last bit. Nothing is sampled.

use std::f64::consts::TAU;

use super::extremum::Extremum;

/// Polynomials one after the other over the phase θ ∈ [0, 2π).
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::PiecewisePolynomial;
/// // s (1 − s) on each half of the period, the second half upside down.
/// let arch = vec![0.0, 1.0, -1.0];
/// let trough = arch.iter().map(|c| -c).collect();
/// let curve = PiecewisePolynomial::uniform(vec![arch, trough]);
/// assert_eq!(curve.extremum(1.0).value, 0.25);
/// assert_eq!(curve.extremum(-1.0).value, -0.25);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewisePolynomial {
    /// Phases where the pieces begin, ascending from 0, and 2π after the last; one more than pieces.
    pub knots: Vec<f64>,
    /// Coefficients of each piece in ascending powers of s ∈ [0, 1], the part of the piece that has passed.
    pub pieces: Vec<Vec<f64>>,
}

impl PiecewisePolynomial {
    /// Pieces of equal length.
    pub fn uniform(pieces: Vec<Vec<f64>>) -> Self {
        let count = pieces.len();
        Self { knots: (0..=count).map(|k| TAU * k as f64 / count as f64).collect(), pieces }
    }

    /// The value at phase `phase`, rad.
    pub fn value(&self, phase: f64) -> f64 {
        let phase = phase.rem_euclid(TAU);
        let piece = self.knots.partition_point(|&knot| knot <= phase).clamp(1, self.pieces.len()) - 1;
        let (begin, end) = (self.knots[piece], self.knots[piece + 1]);
        horner(&self.pieces[piece], (phase - begin) / (end - begin))
    }

    /// The largest value over the period; with a sign of −1 the smallest.
    pub fn extremum(&self, sign: f64) -> Extremum {
        let mut best = Extremum { phase: 0.0, value: f64::NAN };
        for (piece, ends) in self.pieces.iter().zip(self.knots.windows(2)) {
            let turns = roots_between_ends(&derivative(piece));
            for s in [0.0, 1.0].into_iter().chain(turns) {
                let value = horner(piece, s);
                if best.value.is_nan() || sign * value > sign * best.value {
                    let phase = ends[0] + s * (ends[1] - ends[0]);
                    best = Extremum { phase: if phase < TAU { phase } else { 0.0 }, value };
                }
            }
        }
        best
    }
}

pub(super) fn horner(coefficients: &[f64], s: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

pub(super) fn derivative(coefficients: &[f64]) -> Vec<f64> {
    coefficients.iter().enumerate().skip(1).map(|(power, c)| power as f64 * c).collect()
}

/// Roots inside (0, 1) at which the polynomial changes its sign, ascending.
fn roots_between_ends(coefficients: &[f64]) -> Vec<f64> {
    if coefficients.len() < 2 {
        return Vec::new();
    }
    let mut edges = vec![0.0];
    edges.extend(roots_between_ends(&derivative(coefficients)));
    edges.push(1.0);
    edges
        .windows(2)
        .filter_map(|pair| {
            let (mut low, mut high) = (pair[0], pair[1]);
            let rising = horner(coefficients, high) > 0.0;
            if rising == (horner(coefficients, low) > 0.0) {
                return None;
            }
            // A double has no more than 54 halvings between 0 and 1 before its neighbours meet.
            for _ in 0..54 {
                let middle = 0.5 * (low + high);
                if (horner(coefficients, middle) > 0.0) == rising {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            Some(0.5 * (low + high))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;

    #[test]
    fn analytic_roots_of_products_are_their_factors() {
        // (s − 0.1)(s − 0.35)(s − 0.350001)(s − 0.9): two roots a millionth apart.
        let mut product = vec![1.0];
        for root in [0.1, 0.35, 0.350_001, 0.9] {
            let mut next = vec![0.0; product.len() + 1];
            for (power, c) in product.iter().enumerate() {
                next[power + 1] += c;
                next[power] -= root * c;
            }
            product = next;
        }
        let found = roots_between_ends(&product);
        assert_eq!(found.len(), 4, "{found:?}");
        for (found, expected) in found.iter().zip([0.1, 0.35, 0.350_001, 0.9]) {
            // Rounding of 1e-16 over the slope 1e-7 at the close pair.
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }

    #[test]
    fn identity_extremum_bounds_dense_samples() {
        for run in 0..20 {
            let mut rng = Seed::new(12).stream("piecewise", run);
            let pieces = (0..7).map(|_| (0..6).map(|_| rng.random_range(-1.0..1.0)).collect()).collect();
            let curve = PiecewisePolynomial::uniform(pieces);
            let (high, low) = (curve.extremum(1.0).value, curve.extremum(-1.0).value);
            let values = (0..70_000).map(|k| curve.value(TAU * f64::from(k) / 70_000.0));
            let (bottom, top) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            // Between two of 10 000 samples a piece of slope at most 15 misses an end by 1.5e-3, a peak by 1e-6.
            assert!(high >= top && high - top < 1.6e-3 && low <= bottom && bottom - low < 1.6e-3);
            assert_eq!(curve.value(curve.knots[3]), curve.pieces[3][0]);
        }
    }
}
