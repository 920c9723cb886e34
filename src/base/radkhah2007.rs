//! Steps 3–5 of `radkhah2007`'s model reduction (section II.B), on a stacked regressor.

use nalgebra::DMatrix;

use super::{BaseReduction, Method};
use crate::linalg::{LeftToRight, RankRevealingQr, RankTolerance, triangular_factor};
use crate::model::ParameterId;

/// The sets that `radkhah2007`'s procedure fills, as column indices of φ_tot, and its coefficients α.
///
/// ```text
/// 3  r = rank φ_tot                            5  for each remaining column f_i:
/// 4  U = { i : ‖f_i‖ = 0 }                          rank(φ_tot without f_i) < r  →  i ∈ S, i ∈ D_BS, f_i into L
///                                                   else f_i raises rank L       →  i ∈ D_BS, f_i into L
///                                                   else                         →  i ∈ D, f_i out of φ_tot, f_i = L α_i
/// ```
/// Ranks are those of columns scaled to unit length, by QR with column exchange. They are taken from the triangular
/// factor of φ_tot, which has the dependencies of φ_tot and some fifty rows instead of thousands; α_i solves the least
/// squares problem of `radkhah2007`'s normal equations by QR.
///
/// ```
/// use armid::base::Radkhah2007Sets;
/// use nalgebra::dmatrix;
/// let sets = Radkhah2007Sets::of(&dmatrix![1.0, 0.0, 2.0, 0.0; 1.0, 0.0, 2.0, 1.0; 0.0, 0.0, 0.0, 1.0]);
/// assert_eq!((sets.unidentifiable, sets.alone, sets.base), (vec![1], vec![3], vec![0, 3]));
/// assert!(sets.dependent[0].0 == 2 && (sets.dependent[0].1[0] - 2.0).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Radkhah2007Sets {
    /// U: columns that are zero.
    pub unidentifiable: Vec<usize>,
    /// S: columns without which the rank falls.
    pub alone: Vec<usize>,
    /// D_BS: columns of the base, S among them, in the order in which they went into L.
    pub base: Vec<usize>,
    /// D: dependent columns, each with its α over the columns that L held when it was met (the first of `base`).
    pub dependent: Vec<(usize, Vec<f64>)>,
}

impl Radkhah2007Sets {
    /// Runs steps 3–5 on φ_tot (rows × columns).
    #[must_use]
    pub fn of(phi_tot: &DMatrix<f64>) -> Self {
        let tolerance = RankTolerance::default();
        let rank = |columns: &DMatrix<f64>| RankRevealingQr::new(columns, tolerance).rank();
        // Step 4 first, so that the rest need not look at zero columns again.
        let unidentifiable = LeftToRight::new(phi_tot, tolerance).zero;
        let mut remaining: Vec<usize> = (0..phi_tot.ncols()).filter(|j| !unidentifiable.contains(j)).collect();
        let reduced = triangular_factor(&phi_tot.select_columns(&remaining));
        let column_of = |j: usize| remaining_position(&unidentifiable, j);
        let select =
            |columns: &[usize]| reduced.select_columns(&columns.iter().map(|&j| column_of(j)).collect::<Vec<_>>());
        // Step 3.
        let r = rank(&reduced);
        // Step 5.
        let (mut alone, mut base, mut dependent) = (Vec::new(), Vec::new(), Vec::new());
        for i in remaining.clone() {
            let without: Vec<usize> = remaining.iter().copied().filter(|&j| j != i).collect();
            if rank(&select(&without)) < r {
                alone.push(i);
                base.push(i);
                continue;
            }
            let mut l = base.clone();
            l.push(i);
            if rank(&select(&l)) > base.len() {
                base.push(i);
            } else {
                remaining.retain(|&j| j != i);
                dependent.push((i, last_in_terms_of_others(&select(&l), tolerance)));
            }
        }
        Self { unidentifiable, alone, base, dependent }
    }

    /// K as the sets have it: `β_b = θ_b + Σ_i α_bi θ_i`.
    #[must_use]
    pub fn reduction(&self, parameters: &[ParameterId]) -> BaseReduction {
        let mut k = DMatrix::zeros(self.base.len(), parameters.len());
        for (row, &b) in self.base.iter().enumerate() {
            k[(row, b)] = 1.0;
        }
        for (i, alpha) in &self.dependent {
            for (row, &value) in alpha.iter().enumerate() {
                k[(row, *i)] = value;
            }
        }
        BaseReduction::from_echelon(parameters, self.base.clone(), k, Method::Radkhah2007)
    }
}

/// Position of column j among those that are not zero; `zero` ascends.
fn remaining_position(zero: &[usize], j: usize) -> usize {
    j - zero.partition_point(|&z| z < j)
}

/// α with `last column = (columns before it) α`; the columns before are independent.
fn last_in_terms_of_others(l: &DMatrix<f64>, tolerance: RankTolerance) -> Vec<f64> {
    let qr = LeftToRight::new(l, tolerance);
    qr.coefficients.column(l.ncols() - 1).iter().copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Category;
    use crate::model::{ParameterId, ParameterKind};

    #[test]
    fn identity_the_sets_and_one_qr_agree() {
        // Columns: 0 free, 1 zero, 2 = −0.25·0, 3 in 4, 4 = 2·0 − 1e-3·3, 5 alone.
        let mut a = DMatrix::from_fn(40, 6, |i, j| libm::sin((i * i + 3 * j * i + j + 1) as f64));
        a.column_mut(1).fill(0.0);
        let c2 = a.column(0) * -0.25;
        a.set_column(2, &c2);
        let c4 = a.column(0) * 2.0 - a.column(3) * 1e-3;
        a.set_column(4, &c4);
        let ids = [0, 1, 2, 3, 4, 5].map(|k| ParameterId { kind: ParameterKind::LINK[k], index: 0 });
        let paper = Radkhah2007Sets::of(&a);
        assert_eq!(
            (&paper.unidentifiable[..], &paper.alone[..], &paper.base[..]),
            (&[1][..], &[5][..], &[0, 3, 5][..])
        );
        let (paper, qr) = (paper.reduction(&ids), BaseReduction::from_stack(&ids, &a, Method::Qr));
        assert_eq!((&paper.kept, &paper.categories), (&qr.kept, &qr.categories));
        assert!((&paper.k - &qr.k).norm() < 1e-13);
        assert_eq!(paper.count(Category::Combination), 2);
    }
}
