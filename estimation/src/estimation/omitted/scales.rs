//! E[θ θᵀ | y], the size of each law in the arm being unknown.
//!
//! ```text
//! θ_g ~ N(0, σ_g² 1)        σ_g = 0 with even odds, else half-normal of scale 1        θ | y, σ ~ N(V h, V)        V = (K + Σ⁻¹)⁻¹
//! p(y | σ) ∝ |1 + Σ^½ K Σ^½|^-½ exp ½ hᵀ V h        E[θ θᵀ | y] ≈ V + V h hᵀ V at E[σ_g² | y]
//! ```
//! σ_g² is the mean over a grid, law after law with those of the others, until they rest. A law is in an arm or not, which nobody knows before the
//! log: even odds (H. Jeffreys, *Theory of Probability*, 1961, chapter V). Where it is, its scale is that of its realistic level (A. Gelman, *Bayesian
//! Analysis* 1(3), 2006, for priors of scales). So no size is ever zero, and one that many drives show bounds that of a drive that shows none.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector};

use super::evidence::Evidence;

/// Scales that are tried, from the least on, and how many lie in a factor of ten: up to 26 realistic levels.
const GRID: usize = 54;
const LEAST: f64 = 1e-3;
const PER_DECADE: f64 = 12.0;
/// Rounds over all laws.
const ROUNDS: usize = 6;

/// E[θ | y], d, and E[θ θᵀ | y], d × d; `None` where K is not finite.
pub(super) fn moments(evidence: &Evidence, groups: &[Range<usize>]) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let grid: Vec<f64> = (0..GRID).map(|k| LEAST * libm::pow(10.0, k as f64 / PER_DECADE)).collect();
    // The grid is even in the logarithm: density times scale.
    let density: Vec<f64> = grid.iter().map(|s| s * libm::exp(-0.5 * s * s)).collect();
    let total: f64 = density.iter().sum();
    let mut squares = vec![0.1; groups.len()];
    for _ in 0..ROUNDS {
        for group in 0..groups.len() {
            let mut at = squares.clone();
            at[group] = 0.0;
            let mut weights = vec![(0.0, likelihood(evidence, groups, &at)?)];
            for (scale, density) in grid.iter().zip(&density) {
                at[group] = scale * scale;
                let prior = libm::log((density / total).max(f64::MIN_POSITIVE));
                weights.push((scale * scale, prior + likelihood(evidence, groups, &at)?));
            }
            let most = weights.iter().fold(f64::NEG_INFINITY, |most, (_, weight)| most.max(*weight));
            let (mut sum, mut mean) = (0.0, 0.0);
            for (square, weight) in weights {
                let weight = libm::exp(weight - most);
                sum += weight;
                mean += weight * square;
            }
            squares[group] = mean / sum;
        }
    }
    let (factor, roots) = factored(evidence, groups, &squares)?;
    let mut v = factor.inverse();
    for (a, mut column) in v.column_iter_mut().enumerate() {
        for (entry, root) in column.iter_mut().zip(roots.iter()) {
            *entry *= root * roots[a];
        }
    }
    let mean = &v * &evidence.score;
    v += &mean * mean.transpose();
    Some((mean, v))
}

/// The factor of `1 + Σ^½ K Σ^½`, and the diagonal of Σ^½.
fn factored(
    evidence: &Evidence,
    groups: &[Range<usize>],
    squares: &[f64],
) -> Option<(Cholesky<f64, nalgebra::Dyn>, DVector<f64>)> {
    let d = evidence.score.len();
    let mut roots = DVector::zeros(d);
    for (group, square) in groups.iter().zip(squares) {
        roots.rows_mut(group.start, group.len()).fill(square.sqrt());
    }
    let one = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
    let matrix = DMatrix::from_fn(d, d, |a, b| one(a, b) + roots[a] * evidence.information[(a, b)] * roots[b]);
    Some((Cholesky::new(matrix)?, roots))
}

/// ln p(y | σ), but for a constant.
fn likelihood(evidence: &Evidence, groups: &[Range<usize>], squares: &[f64]) -> Option<f64> {
    let (factor, roots) = factored(evidence, groups, squares)?;
    let score = evidence.score.component_mul(&roots);
    let lower = factor.l_dirty();
    let half = lower.solve_lower_triangular(&score)?;
    let determinant: f64 = (0..score.len()).map(|at| libm::log(lower[(at, at)])).sum();
    Some(0.5 * half.norm_squared() - determinant)
}
