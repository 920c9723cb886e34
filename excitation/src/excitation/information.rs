//! From sampled states to their information, and back along exact derivatives.
//!
//! ```text
//! (q, q̇, q̈)_k → W_b → M = (1/rows) W_bᵀ Σ⁻¹ W_b + M_prior
//! S = ∂f/∂M      G = ∂f/∂W_b = (2/rows) Σ⁻¹ W_b S      ∂f/∂(q, q̇, q̈)_k by the regressor's adjoint
//! ```
//! What effects that the model leaves out add to torque, d, enters by its moments `c = (1/rows) W_bᵀ Σ⁻¹ d`.
//! Row i of a sample has entries only for the links that joint i carries and for its own drive, so M is gathered and
//! G made joint by joint on those columns alone.

use nalgebra::DMatrix;

use super::column_lines::{ColumnLines, Square};
use crate::dynamics::States;
use crate::regressor::{JointTorqueRegressor, PartWeights};
use crate::trajectory::Trajectory;

/// The rows of one joint over all samples, on the columns where they can differ from zero.
#[derive(Clone, Debug)]
struct JointRows {
    /// Position of each column among the kept ones.
    columns: Vec<usize>,
    /// The rows, N × w, already divided by the joint's noise.
    rows: ColumnLines,
    /// The slopes of a function by the rows.
    slopes: ColumnLines,
    /// The products of the columns.
    gram: Square,
    /// The slopes of a function by these products.
    by_gram: Square,
    /// 1/σ of the joint.
    weight: f64,
}

/// Samples whose rows are held at once where none is needed afterwards: they fit into the second cache.
const SAMPLES_HELD: usize = 128;

/// The information of a sampled trajectory on the base columns.
#[derive(Clone, Debug)]
pub struct Information {
    regressor: JointTorqueRegressor,
    /// Kept columns of the regressor.
    kept: Vec<usize>,
    joints: Vec<JointRows>,
    samples: usize,
    prior: Option<DMatrix<f64>>,
    /// Room for one joint's rows.
    room: Vec<f64>,
}

impl Information {
    /// The information on the `kept` columns of `regressor`, of trajectories with `samples` samples, with rows divided
    /// by the noise `sigma` of each joint (n; all ones for an unweighted criterion), and `prior` added (b × b, per
    /// torque row).
    pub fn new(
        regressor: JointTorqueRegressor,
        kept: &[usize],
        samples: usize,
        sigma: &[f64],
        prior: Option<DMatrix<f64>>,
    ) -> Self {
        let (n, p) = (regressor.rows(), regressor.cols());
        let pattern = pattern(&regressor);
        let joints = (0..n)
            .map(|i| {
                let columns: Vec<usize> = (0..kept.len()).filter(|&c| pattern[i * p + kept[c]]).collect();
                let rows = ColumnLines::zeros(samples, columns.len());
                let (slopes, gram, by_gram) = (rows.clone(), rows.square(), rows.square());
                JointRows { columns, rows, slopes, gram, by_gram, weight: 1.0 / sigma[i] }
            })
            .collect();
        Self { regressor, kept: kept.to_vec(), joints, samples, prior, room: Vec::new() }
    }

    /// The information matrix of many samples of a trajectory's period, b × b, per torque row, with other arguments as
    /// [`Self::new`]. A few rows at a time are held, and none afterwards.
    pub fn of_period(
        regressor: JointTorqueRegressor,
        kept: &[usize],
        sigma: &[f64],
        trajectory: &dyn Trajectory,
        samples: usize,
    ) -> DMatrix<f64> {
        let mut own = Self::new(regressor, kept, SAMPLES_HELD.min(samples), sigma, None);
        for first in (0..samples).step_by(SAMPLES_HELD) {
            own.put(&trajectory.sample_part(samples, first..samples.min(first + SAMPLES_HELD)));
            own.multiply(first == 0);
        }
        own.sum(samples)
    }

    /// The information matrix of sampled states, b × b, per torque row.
    ///
    /// # Panics
    /// If there are not as many samples as the rows have room for.
    pub fn gather(&mut self, states: &States) -> DMatrix<f64> {
        assert_eq!(states.len(), self.samples, "samples of the motion");
        self.put(states);
        self.multiply(true);
        self.sum(self.samples)
    }

    /// The products of the columns of the rows at hand, in the place of those before or added to them.
    fn multiply(&mut self, are_first: bool) {
        for JointRows { rows, gram, .. } in &mut self.joints {
            rows.gram(are_first, gram, &mut self.room);
        }
    }

    /// Writes the rows of these states; those beyond them become zero.
    fn put(&mut self, states: &States) {
        let joints = &mut self.joints;
        self.regressor.stack_in_parts(states, &self.kept, 1, |part| {
            for (i, joint) in joints.iter_mut().enumerate() {
                for (line, &c) in joint.rows.part_mut(part.first).iter_mut().zip(&joint.columns) {
                    *line = part.line(i, c).map(|entry| joint.weight * entry);
                }
            }
        });
        joints.iter_mut().for_each(|joint| joint.rows.clear_from(states.len()));
    }

    /// The matrix of `count` samples by the products of each joint's columns.
    fn sum(&self, count: usize) -> DMatrix<f64> {
        let (n, b) = (self.regressor.rows(), self.kept.len());
        let mut m = self.prior.clone().unwrap_or_else(|| DMatrix::zeros(b, b));
        let per_row = 1.0 / (n * count) as f64;
        for JointRows { columns, gram, .. } in &self.joints {
            for (r, &row) in columns.iter().enumerate() {
                let sums = &mut m.as_mut_slice()[row * b..(row + 1) * b];
                for (&column, product) in columns[r..].iter().zip(&gram.row(r)[r..]) {
                    sums[column] += per_row * product;
                }
            }
        }
        m.fill_upper_triangle_with_lower_triangle();
        m
    }

    /// The moments `c = (1/rows) W_bᵀ Σ⁻¹ d` of discrepancies d of the torque of the last states, b × E; d is (n N) × E,
    /// sample after sample.
    pub fn moments(&self, d: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, count) = (self.regressor.rows(), self.samples);
        let per_row = 1.0 / (n * count) as f64;
        let mut moments = DMatrix::zeros(self.kept.len(), d.ncols());
        for e in 0..d.ncols() {
            for (i, joint) in self.joints.iter().enumerate() {
                for k in 0..count {
                    let weighted = per_row * joint.weight * d[(k * n + i, e)];
                    for (row, &c) in joint.rows.row(k).zip(&joint.columns) {
                        moments[(c, e)] += weighted * row;
                    }
                }
            }
        }
        moments
    }

    /// The gradient of the moments' function with respect to the discrepancies, (n N) × E, from `S_c = ∂f/∂c` (b × E).
    pub fn pull_back_moments(&self, s_c: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, count) = (self.regressor.rows(), self.samples);
        let per_row = 1.0 / (n * count) as f64;
        let mut u = DMatrix::zeros(n * count, s_c.ncols());
        for e in 0..s_c.ncols() {
            for (i, joint) in self.joints.iter().enumerate() {
                for k in 0..count {
                    let products = joint.rows.row(k).zip(&joint.columns).map(|(row, &c)| row * s_c[(c, e)]);
                    u[(k * n + i, e)] = per_row * joint.weight * products.sum::<f64>();
                }
            }
        }
        u
    }

    /// The gradient with respect to the last states, which must be handed in again, from `S = ∂f/∂M` (b × b, symmetric), and
    /// from `(d, S_c)` if f depends on moments too. What it depends on through d itself is not in it.
    pub fn pull_back(
        &mut self,
        states: &States,
        s: &DMatrix<f64>,
        moments: Option<(&DMatrix<f64>, &DMatrix<f64>)>,
        sensitivity: &mut States,
    ) {
        let (n, count) = (self.regressor.rows(), self.samples);
        let factor = 2.0 / (n * count) as f64;
        let b = self.kept.len();
        for (i, JointRows { columns, rows, slopes, by_gram, weight, .. }) in self.joints.iter_mut().enumerate() {
            for (r, &row) in columns.iter().enumerate() {
                let s = &s.as_slice()[row * b..(row + 1) * b];
                for (entry, &column) in by_gram.row_mut(r).iter_mut().zip(&*columns) {
                    *entry = factor * *weight * s[column];
                }
            }
            rows.times(by_gram, slopes);
            let Some((d, s_c)) = moments else { continue };
            for k in 0..count {
                for e in 0..d.ncols() {
                    let weighted = 0.5 * factor * *weight * *weight * d[(k * n + i, e)];
                    for (slope, &c) in slopes.row_mut(k).zip(&*columns) {
                        *slope += weighted * s_c[(c, e)];
                    }
                }
            }
        }
        sensitivity.q.fill(0.0);
        sensitivity.qd.fill(0.0);
        sensitivity.qdd.fill(0.0);
        let (joints, kept) = (&self.joints, &self.kept);
        let weights = |part: &mut PartWeights| {
            for (i, joint) in joints.iter().enumerate() {
                for (line, &c) in joint.slopes.part(part.first).iter().zip(&joint.columns) {
                    *part.line_mut(i, kept[c]) = *line;
                }
            }
        };
        self.regressor.adjoint_of_samples(states.arrays(), weights, sensitivity.arrays_mut());
    }
}

/// Where a regressor can differ from zero, n × p: where it does at a state in general position.
pub(super) fn pattern(regressor: &JointTorqueRegressor) -> Vec<bool> {
    let (n, p) = (regressor.rows(), regressor.cols());
    let mut pattern = vec![false; n * p];
    let mut y = vec![0.0; n * p];
    for run in 0..4 {
        let draw = |offset: f64| -> Vec<f64> {
            (0..n).map(|j| libm::sin(1.0 + 1.7 * run as f64 + offset + 2.3 * j as f64)).collect()
        };
        regressor.evaluate(&draw(0.0), &draw(0.7), &draw(1.9), &mut y);
        for (known, y) in pattern.iter_mut().zip(&y) {
            *known |= *y != 0.0;
        }
    }
    pattern
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::{CriterionKind, DesignLimits, DesignProblem, radkhah2007_start};
    use crate::model::Columns;
    use crate::seed::Seed;

    fn problem(columns: Columns, kind: CriterionKind) -> DesignProblem {
        let mut problem = DesignProblem::new(chains::crs_a460(), columns, kind, DesignLimits::motion()).unwrap();
        problem.objective.samples = 40;
        problem.set_noise(vec![0.3, 0.5, 0.2, 0.1, 0.1, 0.05]).unwrap();
        problem
    }

    #[test]
    fn identity_information_equals_the_weighted_stack() {
        let problem = problem(Columns::RIGID_ROTOR_FRICTION, CriterionKind::DOptimal);
        let sigma = problem.objective().noise.as_ref().unwrap().to_vec();
        let start = radkhah2007_start(problem.robot(), 10.0, 5, Seed::new(1), 3).unwrap();
        let regressor = JointTorqueRegressor::new(problem.robot(), problem.objective().columns).unwrap();
        let mut information = Information::new(regressor.clone(), &problem.base().kept, 40, &sigma, None);
        let m = information.gather(&start.sample(40));
        // Of more samples than are held at once, which end within a part.
        let mut whole = Information::new(regressor.clone(), &problem.base().kept, 300, &sigma, None);
        let in_parts = Information::of_period(regressor.clone(), &problem.base().kept, &sigma, &start, 300);
        assert_eq!(in_parts, whole.gather(&start.sample(300)));
        let mut w = problem.base().select_columns(&regressor.stack(&start.sample(40)));
        for (r, mut row) in w.row_iter_mut().enumerate() {
            row /= sigma[r % 6];
        }
        let expected = w.tr_mul(&w) / w.nrows() as f64;
        assert!((m - &expected).norm() < 1e-13 * expected.norm());
    }
}
