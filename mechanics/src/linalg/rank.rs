//! Rank by QR with column pivoting.

use nalgebra::DMatrix;

use super::condition::normalised_columns;
use super::left_to_right::back_substitute;
use super::reflection::{Reflection, norm};
use super::tolerance::RankTolerance;

/// Householder QR with column pivoting of A, its columns scaled to unit length: the column with the longest residual
/// comes next.
///
/// Pivoting keeps coefficients small, so the residual itself is the distance from dependence.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::{RankRevealingQr, RankTolerance};
/// use nalgebra::dmatrix;
/// // The third column is the sum of the others, in any unit.
/// let a = dmatrix![1.0, 2.0, 3e6; 0.0, 1.0, 1e6; 1.0, 1.0, 2e6; 2.0, 0.0, 2e6];
/// assert_eq!(RankRevealingQr::new(&a, RankTolerance::default()).rank(), 2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RankRevealingQr {
    /// Length of the residual of each chosen column, orthogonal to those before, when it was chosen, largest first; the
    /// first is 1.
    pub rests: Vec<f64>,
    tolerance: RankTolerance,
    /// Indices in A of the columns of the triangular factor, chosen ones first; those of zero columns are missing.
    order: Vec<usize>,
    factor: Vec<Vec<f64>>,
}

impl RankRevealingQr {
    /// Factors A (m × n). `4 m n²` operations.
    pub fn new(a: &DMatrix<f64>, tolerance: RankTolerance) -> Self {
        let (scaled, lengths) = normalised_columns(a);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let mut rest: Vec<(usize, Vec<f64>)> = (0..a.ncols())
            .filter(|&j| lengths[j] > tolerance.zero * longest)
            .map(|j| (j, scaled.column(j).iter().copied().collect()))
            .collect();
        let mut rests = Vec::new();
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
        }
        let (order, factor) = rest.into_iter().unzip();
        Self { rests, tolerance, order, factor }
    }

    /// The number of columns whose residual was longer than the tolerance.
    pub fn rank(&self) -> usize {
        self.rests.iter().take_while(|&&rest| rest > self.tolerance.independent).count()
    }

    /// The columns of A, ascending, without which its rank would be lower: those that no other column needs.
    ///
    /// ```text
    /// A = B C on the r chosen columns B = Q R₁₁        C = R₁₁⁻¹ R₁₂        ‖a_j − (B without b_i)‖ = |C_ij| / ‖(R₁₁⁻¹)_i‖
    /// ```
    /// Without b_i the rank stays where that residual of some other column, of unit length, is above the tolerance. All
    /// columns are judged by this one factorisation, `O(r² n)`, where a rank for each would take `O(m n³)`.
    pub fn indispensable(&self) -> Vec<usize> {
        let r = self.rank();
        // Lengths of the rows of R₁₁⁻¹, and the largest entry of each row of C.
        let (mut lengths, mut most) = (vec![0.0_f64; r], vec![0.0_f64; r]);
        for j in 0..r {
            let unit = back_substitute(&self.factor, (0..r).map(|i| f64::from(i == j)).collect());
            for (length, x) in lengths.iter_mut().zip(unit) {
                *length += x * x;
            }
        }
        for column in &self.factor[r..] {
            for (most, x) in most.iter_mut().zip(back_substitute(&self.factor, column[..r].to_vec())) {
                *most = most.max(x.abs());
            }
        }
        let alone = |i: &usize| most[*i] / lengths[*i].sqrt() <= self.tolerance.independent;
        let mut columns: Vec<usize> = (0..r).filter(alone).map(|i| self.order[i]).collect();
        columns.sort_unstable();
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_indispensable_columns_are_those_without_which_the_rank_falls() {
        let tolerance = RankTolerance::default();
        let mut a = DMatrix::from_fn(30, 9, |i, j| libm::sin((i * i + 3 * j * i + j + 1) as f64));
        let (two, three) = (a.column(0) * 2.0 - a.column(4) * 1e-4, a.column(4) + a.column(6));
        a.set_column(2, &two);
        a.set_column(7, &three);
        a.column_mut(3).fill(0.0);
        a.column_mut(5).scale_mut(1e6);
        let whole = RankRevealingQr::new(&a, tolerance);
        let fall: Vec<usize> = (0..9)
            .filter(|&j| RankRevealingQr::new(&a.clone().remove_column(j), tolerance).rank() < whole.rank())
            .collect();
        assert_eq!(whole.indispensable(), fall);
        assert_eq!(fall, [1, 5, 8]);
        assert!(RankRevealingQr::new(&DMatrix::zeros(3, 2), tolerance).indispensable().is_empty());
    }

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
