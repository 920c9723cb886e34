//! Sizes of the groups of functions, by the restricted likelihood of the residual.
//!
//! ```text
//! r ~ N(0, V)        V = a 1 + Σ_k v_k F_k F_kᵀ        a ≥ 1, v_k ≥ 0
//! v_k ← v_k √( ‖F_kᵀ V⁻¹ r‖² / tr F_kᵀ V⁻¹ F_k )        std v_k = √2 / ‖F_kᵀ V⁻¹ F_k‖ (expected information)
//! ```
//! The minorisation of H. Zhou, L. Hu, J. Zhou, K. Lange, "MM algorithms for variance components models", J. Comput. Graph. Stat.
//! 28(2), 2019: no step lowers the likelihood, no size becomes negative. With `V = U Uᵀ` it needs `U⁻¹ F_k` and `U⁻¹ r` alone, since the traces of
//! all parts of `V⁻¹ V` sum to d.
//!
//! What a few functions tell of their own size is little, and what the regressor hides nearly whole tells nothing. So a
//! joint's own group counts where its size is above its standard deviation, a law of all joints has [`SHARED_STD`] of them
//! added, and both are bounded by what is visible of them in the residual. The four numbers below were set on arms,
//! designs and noise other than those of `experiments/07-coverage`, by coverage and width of the intervals.

use nalgebra::{DMatrix, DVector};

use super::features::SHARED;
use crate::linalg::product::transposed_product;
use crate::linalg::{UpperRoot, column_squares, dot, product};

/// Steps at most; a size that still moves then is taken as it stands, which is nearer than any before.
const STEPS: usize = 40;
/// Change at which the iteration ends: of a joint's own sizes over the largest of them, and a tenth of that of a shared law's
/// over itself. Far below the standard deviation of any size.
const CHANGE: f64 = 5e-3;
/// Largest size of a joint's own group over the mean square of what is visible of it beyond noise.
const MOST: f64 = 16.0;
/// Largest size of a law of all joints.
const SHARED_MOST: f64 = 36.0;
/// Standard deviations that the size of a law of all joints has added.
const SHARED_STD: f64 = 3.0;
/// The part of what repeats and looks like noise that counts: errors of the measured motion are of high frequency, where they
/// reach the parameters less than white noise of the same power.
const WHITE_SHARE: f64 = 0.35;

/// A residual in directions of the functions, and the rest, which no function reaches.
pub(super) struct ReducedResidual {
    /// d.
    pub(super) residual: DVector<f64>,
    /// F_k, d × functions each: the joint's own groups, then the shared laws.
    pub(super) groups: Vec<DMatrix<f64>>,
    /// Square of the rest, and its degrees of freedom. Where functions depend on others, rounding decides which of the residual is here: it
    /// moves the start of the search, and its end within its tolerance.
    pub(super) rest_square: f64,
    pub(super) rest_freedom: f64,
    /// Mean square of the residual in each own group's directions.
    pub(super) visible: Vec<f64>,
    /// Square of the residual in the direction of each shared law.
    pub(super) shared_visible: [f64; SHARED],
    /// Square of each shared law as it stands.
    pub(super) power: [f64; SHARED],
}

/// Sizes of one joint, in units of the noise's variance.
pub(super) struct Sizes {
    /// Of each own group.
    pub(super) own: Vec<f64>,
    /// Of what repeats and looks like noise.
    pub(super) white: f64,
}

/// One joint on the way to the maximum.
struct Joint<'a> {
    reduced: &'a ReducedResidual,
    own: Vec<f64>,
    white: f64,
    /// The rows and columns of F_k F_kᵀ that are not zero, for each k.
    squares: Vec<DMatrix<f64>>,
    /// F_k of all k side by side, and r.
    columns: DMatrix<f64>,
    /// U⁻¹ times these, at the last step.
    divided: DMatrix<f64>,
}

impl<'a> Joint<'a> {
    fn new(reduced: &'a ReducedResidual) -> Self {
        let (rest, freedom) = (reduced.rest_square, reduced.rest_freedom);
        let white = if freedom > 0.0 { (rest / freedom).max(1.0) } else { 1.0 };
        let own = reduced.visible.iter().map(|visible| visible.max(1e-6)).collect();
        let square = |group: &DMatrix<f64>| {
            let height = (0..group.nrows()).rev().find(|&row| group.row(row).iter().any(|entry| *entry != 0.0));
            let part = group.rows(0, height.map_or(0, |last| last + 1)).into_owned();
            product(&part, &part.transpose())
        };
        let squares = reduced.groups.iter().map(square).collect();
        let columns = reduced.columns();
        Self { reduced, own, white, squares, divided: columns.clone(), columns }
    }

    /// A step of its own sizes; adds `‖F_kᵀ V⁻¹ r‖²` and `tr F_kᵀ V⁻¹ F_k` of the shared laws to `sums`. The largest relative
    /// change, `None` where V has no Cholesky factor.
    fn step(&mut self, shared: &[f64; SHARED], sums: &mut [[f64; 2]; SHARED]) -> Option<f64> {
        let reduced = self.reduced;
        let d = reduced.residual.len();
        let parts: Vec<_> = self.squares.iter().zip(self.own.iter().chain(shared).copied()).collect();
        let root = UpperRoot::of_sum(d, self.white, &parts)?;
        self.divided.copy_from(&self.columns);
        root.divide(&mut self.divided);
        let seen_and_traces = self.seen_and_traces();
        let sizes = self.own.iter().chain(shared);
        let of_functions: f64 = sizes.zip(&seen_and_traces).map(|(size, [_, trace])| size * trace).sum();
        let trace = ((d as f64 - of_functions) / self.white).max(0.0);
        let largest = self.own.iter().fold(0.0_f64, |a, &b| a.max(b));
        let mut change: f64 = 0.0;
        for (size, &of) in self.own.iter_mut().zip(&seen_and_traces) {
            let next = stepped(*size, of);
            change = change.max((next - *size).abs() / largest);
            *size = next;
        }
        for ([seen, trace], sums) in seen_and_traces[self.own.len()..].iter().zip(sums) {
            *sums = [sums[0] + seen, sums[1] + trace];
        }
        let mut z = self.divided.column(self.divided.ncols() - 1).into_owned();
        root.divide_transposed(z.as_mut_slice());
        let seen = z.norm_squared() + reduced.rest_square / (self.white * self.white);
        let next = stepped(self.white, [seen, trace + reduced.rest_freedom / self.white]).max(1.0);
        change = change.max((next - self.white).abs() / self.white);
        self.white = next;
        Some(change)
    }

    /// The functions of each group, divided.
    fn divided_groups(&self) -> impl Iterator<Item = &[f64]> {
        let mut rest = self.divided.as_slice();
        self.reduced.groups.iter().map(move |group| {
            let (own, others) = rest.split_at(group.len());
            rest = others;
            own
        })
    }

    /// `‖F_kᵀ V⁻¹ r‖²` and `tr F_kᵀ V⁻¹ F_k` of every group.
    fn seen_and_traces(&self) -> Vec<[f64; 2]> {
        let d = self.reduced.residual.len();
        let residual = &self.divided.as_slice()[self.divided.len() - d..];
        let of = |group: &[f64]| {
            let seen = transposed_product(group, residual, d);
            let traces = transposed_product(group, group, group.len());
            [dot(seen.as_slice(), seen.as_slice()), traces.iter().sum()]
        };
        self.divided_groups().map(of).collect()
    }

    /// `½ ‖F_kᵀ V⁻¹ F_k‖²` of every group.
    fn information(&self) -> Vec<f64> {
        let groups = self.divided_groups().zip(&self.reduced.groups);
        groups
            .map(|(divided, of)| {
                0.5 * column_squares(&DMatrix::from_column_slice(of.nrows(), of.ncols(), divided)).norm_squared()
            })
            .collect()
    }
}

impl ReducedResidual {
    /// All functions and the residual behind them.
    fn columns(&self) -> DMatrix<f64> {
        let columns = self.groups.iter().flat_map(DMatrix::column_iter);
        DMatrix::from_columns(&columns.chain([self.residual.column(0)]).collect::<Vec<_>>())
    }
}

fn stepped(size: f64, [seen, trace]: [f64; 2]) -> f64 {
    if trace > 0.0 { size * (seen / trace).sqrt() } else { 0.0 }
}

/// The sizes of largest restricted likelihood of all joints together, bounded as above: of each joint, and of the shared laws.
pub(super) fn restricted_likelihood(joints: &[ReducedResidual]) -> (Vec<Sizes>, [f64; SHARED]) {
    let mut states: Vec<Joint<'_>> = joints.iter().map(Joint::new).collect();
    // What is visible of a law over what there is of it bounds its size.
    let most: [f64; SHARED] = std::array::from_fn(|k| {
        let (seen, power) = joints.iter().fold((0.0, 0.0), |(seen, power), joint| {
            (seen + (joint.shared_visible[k] - 1.0).max(0.0), power + joint.power[k])
        });
        if power > 0.0 { seen / power } else { 0.0 }
    });
    let mut shared = most.map(|most| most.max(f64::MIN_POSITIVE));
    for _ in 0..STEPS {
        let mut sums = [[0.0; 2]; SHARED];
        let mut change: f64 = 0.0;
        for state in &mut states {
            let Some(moved) = state.step(&shared, &mut sums) else { continue };
            change = change.max(moved);
        }
        for (size, sums) in shared.iter_mut().zip(sums) {
            let next = stepped(*size, sums);
            if *size > 0.0 {
                change = change.max((next - *size).abs() / *size * 0.1);
            }
            *size = next;
        }
        if change <= CHANGE {
            break;
        }
    }
    let mut shared_information = [0.0; SHARED];
    let sizes = states
        .iter()
        .map(|state| {
            let information = state.information();
            for (sum, &of_joint) in shared_information.iter_mut().zip(&information[state.own.len()..]) {
                *sum += of_joint;
            }
            let own = state.own.iter().zip(&information).zip(&state.reduced.visible);
            let own = own.map(|((&size, &information), &visible)| {
                let std = if information > 0.0 { 1.0 / information.sqrt() } else { 0.0 };
                if size > std { size.min(MOST * visible) } else { 0.0 }
            });
            Sizes { own: own.collect(), white: WHITE_SHARE * (state.white - 1.0) }
        })
        .collect();
    for ((size, information), most) in shared.iter_mut().zip(shared_information).zip(most) {
        let std = if information > 0.0 { 1.0 / information.sqrt() } else { 0.0 };
        *size = (*size + SHARED_STD * std).min(SHARED_MOST * most);
    }
    (sizes, shared)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One joint with `k` directions in which the residual is `r` and functions have the square `g`, and white noise beside.
    fn joint(k: usize, r: f64, g: f64, visible: f64) -> ReducedResidual {
        let none = DMatrix::zeros(k, k);
        ReducedResidual {
            residual: DVector::from_element(k, r),
            groups: vec![DMatrix::from_diagonal_element(k, k, g.sqrt()), none.clone(), none.clone(), none],
            rest_square: 1e6,
            rest_freedom: 1e6,
            visible: vec![visible],
            shared_visible: [0.0; SHARED],
            power: [0.0; SHARED],
        }
    }

    #[test]
    fn analytic_size_of_one_group() {
        // r² = a + v g in each of k directions, and a = 1 by the rest: v = (r² − 1)/g.
        let (sizes, _) = restricted_likelihood(&[joint(40, 5.0, 4.0, 1.0)]);
        assert!((sizes[0].own[0] / 6.0 - 1.0).abs() < 0.05, "{}", sizes[0].own[0]);
        assert!(sizes[0].white < 1e-3);
        // No more than noise has no size; what is hardly visible is bounded.
        assert_eq!(restricted_likelihood(&[joint(40, 1.0, 4.0, 1.0)]).0[0].own, [0.0]);
        assert_eq!(restricted_likelihood(&[joint(40, 5.0, 4.0, 0.1)]).0[0].own, [MOST * 0.1]);
    }

    #[test]
    fn analytic_size_of_a_law_that_joints_share() {
        // One direction in each of 50 joints, r² = 1 + v g: the size is that of all of them.
        let joints: Vec<ReducedResidual> = (0..50)
            .map(|_| ReducedResidual {
                residual: DVector::from_element(1, 5.0),
                groups: vec![
                    DMatrix::from_element(1, 1, 2.0),
                    DMatrix::from_element(1, 1, 0.0),
                    DMatrix::from_element(1, 1, 0.0),
                ],
                rest_square: 1e6,
                rest_freedom: 1e6,
                visible: Vec::new(),
                shared_visible: [25.0, 0.0, 0.0],
                power: [4.0; SHARED],
            })
            .collect();
        let (_, shared) = restricted_likelihood(&joints);
        // Its standard deviation is √2 (v + 1/g) / √50.
        let expected = 6.0 + SHARED_STD * (2.0_f64 / 50.0).sqrt() * 6.25;
        assert!((shared[0] / expected - 1.0).abs() < 0.05, "{} {expected}", shared[0]);
        assert_eq!(shared[1], 0.0);
    }
}
