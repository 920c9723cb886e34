//! Rank by QR with column exchange.

use nalgebra::DMatrix;

use super::RankTolerance;
use super::condition::normalised_columns;
use super::reflection::{Reflection, norm};

/// Householder QR of A with its columns scaled to unit length and then exchanged so that the longest rest comes first.
///
/// The exchange keeps coefficients small, so the rest itself is the distance from dependence.
///
/// ```
/// use armid::linalg::{RankRevealingQr, RankTolerance};
/// use nalgebra::dmatrix;
/// // The third column is the sum of the others, in any unit.
/// let a = dmatrix![1.0, 2.0, 3e6; 0.0, 1.0, 1e6; 1.0, 1.0, 2e6; 2.0, 0.0, 2e6];
/// assert_eq!(RankRevealingQr::new(&a, RankTolerance::default()).rank(), 2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RankRevealingQr {
    /// Length of the orthogonal rest of each chosen column when it was chosen, largest first; the first is 1.
    pub rests: Vec<f64>,
    /// Indices of A's columns in the order they were chosen; those of zero columns are missing.
    pub order: Vec<usize>,
    tolerance: RankTolerance,
}

impl RankRevealingQr {
    /// Factors A (m × n). `4 m n²` operations.
    #[must_use]
    pub fn new(a: &DMatrix<f64>, tolerance: RankTolerance) -> Self {
        let (scaled, lengths) = normalised_columns(a);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let mut rest: Vec<(usize, Vec<f64>)> = (0..a.ncols())
            .filter(|&j| lengths[j] > tolerance.zero * longest)
            .map(|j| (j, scaled.column(j).iter().copied().collect()))
            .collect();
        let (mut rests, mut order) = (Vec::new(), Vec::new());
        for k in 0..a.nrows().min(rest.len()) {
            // The first of equals, so that the order depends on nothing but the numbers.
            let (mut best, mut length) = (k, -1.0);
            for (position, (_, column)) in rest.iter().enumerate().skip(k) {
                let this = norm(&column[k..]);
                if this > length {
                    (best, length) = (position, this);
                }
            }
            if length <= 0.0 {
                break;
            }
            rest[k..=best].rotate_right(1);
            let (head, tail) = rest.split_at_mut(k + 1);
            let reflection = Reflection::annihilate(&mut head[k].1, k);
            for (_, column) in tail {
                reflection.apply(column);
            }
            rests.push(length);
            order.push(head[k].0);
        }
        Self { rests, order, tolerance }
    }

    /// The number of columns whose rest was longer than the tolerance.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rests.iter().take_while(|&&rest| rest > self.tolerance.independent).count()
    }

    /// The shortest rest that counted and the longest that did not: how clear the decision was.
    #[must_use]
    pub fn gap(&self) -> (f64, f64) {
        let rank = self.rank();
        let above = if rank > 0 { self.rests[rank - 1] } else { f64::INFINITY };
        (above, self.rests.get(rank).copied().unwrap_or(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_rank_of_outer_products_in_mixed_units() {
        for rank in 0..5 {
            let a = DMatrix::from_fn(12, rank, |i, j| libm::sin((i * i + 3 * j * i + j + 1) as f64));
            let b = DMatrix::from_fn(rank, 8, |i, j| libm::cos((2 * i * j + i + j * j) as f64));
            let mut c = &a * &b;
            for (j, mut column) in c.column_iter_mut().enumerate() {
                column *= libm::pow(10.0, (j % 5) as f64 - 2.0);
            }
            assert_eq!(RankRevealingQr::new(&c, RankTolerance::default()).rank(), rank);
        }
    }
}
