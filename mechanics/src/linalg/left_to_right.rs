//! Which columns of a matrix are independent of those to their left.

use nalgebra::DMatrix;

use super::condition::normalised_columns;
use super::dot::dot;
use super::reflection::{Reflection, norm};
use super::tolerance::RankTolerance;

/// QR that walks the columns of A from left to right and keeps a column if and only if it is independent of those kept
/// before it; the others are combinations of the kept ones.
///
/// ```text
/// A = A[:, kept] · C        C is b × n, the identity on the kept columns, zero on zero columns
/// ```
/// C is the reduced row echelon form of A. Columns are scaled to unit length first; each decision is by the distance of
/// a column from dependence on the kept ones ([`RankTolerance`]).
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::{LeftToRight, RankTolerance};
/// use nalgebra::dmatrix;
/// let a = dmatrix![1.0, 2.0, 0.0, 1.0; 1.0, 2.0, 0.0, 0.0; 0.0, 0.0, 0.0, 1.0];
/// let qr = LeftToRight::new(&a, RankTolerance::default());
/// assert_eq!((&qr.kept[..], &qr.zero[..]), (&[0, 3][..], &[2][..]));
/// assert!((qr.coefficients[(0, 1)] - 2.0).abs() < 1e-14);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LeftToRight {
    /// Indices of the kept columns, ascending; b of them.
    pub kept: Vec<usize>,
    /// Indices of the columns that are zero.
    pub zero: Vec<usize>,
    /// C (b × n): each column of A as a combination of the kept ones.
    pub coefficients: DMatrix<f64>,
}

impl LeftToRight {
    /// Factors A (m × n). `2 m n b + n b²` operations.
    pub fn new(a: &DMatrix<f64>, tolerance: RankTolerance) -> Self {
        let (scaled, lengths) = normalised_columns(a);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let mut kept: Vec<usize> = Vec::new();
        let mut zero = Vec::new();
        let mut reflections: Vec<Reflection> = Vec::new();
        // Upper triangle, column by column: heads[k] holds the first k + 1 entries of the k-th kept column.
        let mut heads: Vec<Vec<f64>> = Vec::new();
        let mut combinations: Vec<(usize, Vec<f64>)> = Vec::new();
        for j in 0..a.ncols() {
            if lengths[j] <= tolerance.zero * longest {
                zero.push(j);
                continue;
            }
            let mut column: Vec<f64> = scaled.column(j).iter().copied().collect();
            for reflection in &reflections {
                reflection.apply(&mut column);
            }
            let k = kept.len();
            let combination = back_substitute(&heads, column[..k].to_vec());
            let rest = norm(&column[k..]);
            let distance = rest / (1.0 + dot(&combination, &combination)).sqrt();
            if distance > tolerance.independent {
                reflections.push(Reflection::annihilate(&mut column, k));
                column.truncate(k + 1);
                heads.push(column);
                kept.push(j);
            } else {
                combinations.push((j, combination));
            }
        }
        let mut coefficients = DMatrix::zeros(kept.len(), a.ncols());
        for (k, &j) in kept.iter().enumerate() {
            coefficients[(k, j)] = 1.0;
        }
        for (j, combination) in combinations {
            for (k, &value) in combination.iter().enumerate() {
                coefficients[(k, j)] = value * lengths[j] / lengths[kept[k]];
            }
        }
        Self { kept, zero, coefficients }
    }
}

/// Solves the triangular system whose columns are `heads` for a right side that is not longer than they are many.
pub(super) fn back_substitute(heads: &[Vec<f64>], mut x: Vec<f64>) -> Vec<f64> {
    for (i, head) in heads[..x.len()].iter().enumerate().rev() {
        x[i] /= head[i];
        let xi = x[i];
        for (value, entry) in x[..i].iter_mut().zip(head) {
            *value -= entry * xi;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::RankRevealingQr;

    /// 20 × 6 with columns 2 and 4 dependent on those before them, and column 1 zero.
    fn sample() -> DMatrix<f64> {
        let mut a = DMatrix::from_fn(20, 6, |i, j| libm::sin((i * i + 3 * j * i + j + 1) as f64));
        a.column_mut(1).fill(0.0);
        let c2 = a.column(0) * -0.25;
        a.set_column(2, &c2);
        let c4 = a.column(0) * 2.0 - a.column(3) * 1e-3;
        a.set_column(4, &c4);
        a
    }

    #[test]
    fn analytic_coefficients_and_reconstruction() {
        let a = sample();
        let qr = LeftToRight::new(&a, RankTolerance::default());
        assert_eq!(qr.kept, [0, 3, 5]);
        assert_eq!(qr.zero, [1]);
        for (k, j, expected) in [(0, 2, -0.25), (0, 4, 2.0), (1, 4, -1e-3), (2, 4, 0.0), (0, 0, 1.0)] {
            assert!((qr.coefficients[(k, j)] - expected).abs() < 1e-14);
        }
        let rebuilt = a.select_columns(&qr.kept) * &qr.coefficients;
        assert!((rebuilt - &a).norm() < 1e-14 * a.norm());
    }

    #[test]
    fn identity_units_of_columns_decide_nothing() {
        let a = sample();
        let mut b = a.clone();
        for (j, mut column) in b.column_iter_mut().enumerate() {
            column *= [1e4, 1.0, 1e-3, 1e-4, 10.0, 1e3][j];
        }
        let (qa, qb) = (LeftToRight::new(&a, RankTolerance::default()), LeftToRight::new(&b, RankTolerance::default()));
        assert_eq!((qa.kept, qa.zero), (qb.kept, qb.zero));
    }

    #[test]
    fn identity_same_rank_as_the_pivoted_factorisation() {
        let a = sample();
        assert_eq!(RankRevealingQr::new(&a, RankTolerance::default()).rank(), 3);
        // More columns than rows: rank is bounded by the rows.
        let wide = a.rows(0, 2).into_owned();
        assert_eq!(LeftToRight::new(&wide, RankTolerance::default()).kept.len(), 2);
        assert_eq!(LeftToRight::new(&DMatrix::zeros(4, 3), RankTolerance::default()).kept.len(), 0);
    }

    #[test]
    fn analytic_a_difference_of_nearly_equal_columns_is_judged_by_its_distance() {
        // a2 = (a1 − a0) · 1e6 to rounding: with coefficients of a million, 1e-16 of either is 1e-10 of a2.
        let a0 = DMatrix::from_fn(60, 1, |i, _| libm::sin((i * i + 1) as f64));
        let d = DMatrix::from_fn(60, 1, |i, _| libm::cos((i * i * i) as f64));
        let mut a = DMatrix::zeros(60, 4);
        a.set_column(0, &a0.column(0));
        a.set_column(1, &(&a0 + &d * 1e-6).column(0));
        a.set_column(2, &d.column(0));
        let qr = LeftToRight::new(&a, RankTolerance::default());
        assert_eq!(qr.kept, [0, 1]);
        assert!((qr.coefficients[(1, 2)] * 1e-6 - 1.0).abs() < 1e-8);
        // A change of 1e-4 of it is seen all the same.
        a.set_column(3, &(&d + DMatrix::from_fn(60, 1, |i, _| libm::sin((3 * i) as f64)) * 1e-4).column(0));
        assert_eq!(LeftToRight::new(&a, RankTolerance::default()).kept, [0, 1, 3]);
    }
}
