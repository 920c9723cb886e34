//! Steps 3–5 of `radkhah2007`'s model reduction (section II.B), on a stacked regressor.

use nalgebra::DMatrix;

use super::method::Method;
use super::reduction::BaseReduction;
use crate::linalg::{LeftToRight, RankRevealingQr, RankTolerance, RowFactor, normalised_columns};
use crate::model::ParameterId;

/// The sets that `radkhah2007`'s procedure fills, as column indices of φ_tot, and its coefficients α. φ_tot is that
/// paper's symbol for the stacked regressor W, not the parameters φ.
///
/// ```text
/// 3  r = rank φ_tot                            5  for each remaining column f_i:
/// 4  U = { i : ‖f_i‖ = 0 }                          rank(φ_tot without f_i) < r  →  i ∈ S, i ∈ D_BS, f_i into L
///                                                   else f_i raises rank L       →  i ∈ D_BS, f_i into L
///                                                   else                         →  i ∈ D, f_i out of φ_tot, f_i = L α_i
/// ```
/// Ranks are those of columns scaled to unit length. They are taken from the triangular factor of φ_tot, which has the
/// dependencies of φ_tot and some fifty rows instead of thousands; α_i solves the least squares problem of `radkhah2007`'s
/// normal equations by QR.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::base::Radkhah2007Sets;
/// use nalgebra::dmatrix;
/// let sets = Radkhah2007Sets::from_regressor(&dmatrix![1.0, 0.0, 2.0, 0.0; 1.0, 0.0, 2.0, 1.0; 0.0, 0.0, 0.0, 1.0]);
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
    ///
    /// What the procedure asks column by column is answered for all columns at once. Which ones lower the rank
    /// ([`RankRevealingQr::indispensable`]) does not depend on the columns that were taken out before: those are combinations
    /// of columns that stay. Whether f_i raises the rank of L, and by which α it does not, is what QR from left to right finds. The
    /// tests follow the procedure to the letter.
    pub fn from_regressor(phi_tot: &DMatrix<f64>) -> Self {
        let tolerance = RankTolerance::default();
        // Step 4 first, so that the rest need not look at zero columns again.
        let (_, lengths) = normalised_columns(phi_tot);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let (unidentifiable, remaining): (Vec<usize>, Vec<usize>) =
            (0..phi_tot.ncols()).partition(|&j| lengths[j] <= tolerance.zero * longest);
        let mut factor = RowFactor::new(remaining.len());
        factor.add(phi_tot.nrows(), |row, column| phi_tot[(row, remaining[column])]);
        let reduced = factor.finish();
        // Step 3, and S of step 5.
        let alone = RankRevealingQr::new(&reduced, tolerance).indispensable();
        // The rest of step 5.
        let qr = LeftToRight::new(&reduced, tolerance);
        let dependent = (0..remaining.len()).filter(|j| qr.kept.binary_search(j).is_err()).map(|j| {
            let before = qr.kept.partition_point(|&kept| kept < j);
            (remaining[j], qr.coefficients.column(j).iter().take(before).copied().collect())
        });
        Self {
            dependent: dependent.collect(),
            alone: alone.iter().map(|&j| remaining[j]).collect(),
            base: qr.kept.iter().map(|&j| remaining[j]).collect(),
            unidentifiable,
        }
    }

    /// K as the sets have it: `β_b = φ_b + Σ_i α_bi φ_i`.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Category;
    use crate::chains::{self, ChainRecipe};
    use crate::dynamics::States;
    use crate::model::{Columns, ParameterId, ParameterKind};
    use crate::regressor::JointTorqueRegressor;
    use crate::seed::Seed;

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
        let paper = Radkhah2007Sets::from_regressor(&a);
        assert_eq!(
            (&paper.unidentifiable[..], &paper.alone[..], &paper.base[..]),
            (&[1][..], &[5][..], &[0, 3, 5][..])
        );
        let (paper, qr) = (paper.reduction(&ids), BaseReduction::from_stack(&ids, &a, Method::Qr));
        assert_eq!((&paper.kept, &paper.categories), (&qr.kept, &qr.categories));
        assert!((&paper.k - &qr.k).norm() < 1e-13);
        assert_eq!(paper.count(Category::Combination), 2);
    }

    /// Steps 3–5 to the letter: a rank for every question.
    fn to_the_letter(phi_tot: &DMatrix<f64>) -> Radkhah2007Sets {
        let tolerance = RankTolerance::default();
        let rank = |columns: &[usize]| RankRevealingQr::new(&phi_tot.select_columns(columns), tolerance).rank();
        let unidentifiable = LeftToRight::new(phi_tot, tolerance).zero;
        let mut remaining: Vec<usize> = (0..phi_tot.ncols()).filter(|j| !unidentifiable.contains(j)).collect();
        let r = rank(&remaining);
        let (mut alone, mut base, mut dependent) = (Vec::new(), Vec::new(), Vec::new());
        for i in remaining.clone() {
            let without: Vec<usize> = remaining.iter().copied().filter(|&j| j != i).collect();
            let l: Vec<usize> = base.iter().copied().chain([i]).collect();
            if rank(&without) < r {
                alone.push(i);
                base.push(i);
            } else if rank(&l) > base.len() {
                base.push(i);
            } else {
                remaining.retain(|&j| j != i);
                let qr = LeftToRight::new(&phi_tot.select_columns(&l), tolerance);
                dependent.push((i, qr.coefficients.column(l.len() - 1).iter().copied().collect()));
            }
        }
        Radkhah2007Sets { unidentifiable, alone, base, dependent }
    }

    #[test]
    fn published_procedure_to_the_letter_fills_the_same_sets() {
        for run in 0..12 {
            let dof = 1 + usize::try_from(run % 6).unwrap();
            let mut rng = Seed::new(41).stream("chains", run);
            let recipe = ChainRecipe { coupled: run % 2 == 0, tilted: run % 3 == 0, ..ChainRecipe::new(dof) };
            let (robot, _) = recipe.draw(&mut rng);
            let columns = if run % 2 == 0 { Columns::RIGID } else { Columns::RIGID_ROTOR_FRICTION };
            let mut states = States::new(dof);
            for _ in 0..(3 * columns.parameters(&robot).len()).div_ceil(dof) {
                let (q, qd, qdd) = chains::random_state(&mut rng, dof);
                states.push(&q, &qd, &qdd);
            }
            let phi_tot = JointTorqueRegressor::new(&robot, columns).unwrap().stack(&states);
            let (found, expected) = (Radkhah2007Sets::from_regressor(&phi_tot), to_the_letter(&phi_tot));
            assert_eq!(found.unidentifiable, expected.unidentifiable, "chain {run}");
            assert_eq!((&found.alone, &found.base), (&expected.alone, &expected.base), "chain {run}");
            assert_eq!(found.dependent.len(), expected.dependent.len());
            for ((i, found), (j, expected)) in found.dependent.iter().zip(&expected.dependent) {
                assert_eq!((i, found.len()), (j, expected.len()));
                let size = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                assert!(found.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-9 * size), "chain {run}, {i}");
            }
        }
    }
}
