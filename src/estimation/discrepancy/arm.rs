//! The discrepancy of an arm: of its joints one by one, and of laws that they share.

use nalgebra::DMatrix;

use super::blocks::BlockedEquations;
use super::features::{self, Functions};
use super::joint::JointResidual;
use super::sizes;
use crate::estimation::expected_residual::COLUMNS;
use crate::estimation::{EstimationError, EstimationProblem, Instruments};
use crate::linalg::product;
use crate::signal::NoiseModel;

/// The discrepancy of every joint that shows one.
pub(in crate::estimation) struct Discrepancy {
    blocks: BlockedEquations,
    joints: Vec<JointDiscrepancy>,
}

/// The discrepancy of one joint.
struct JointDiscrepancy {
    /// Joint, from zero.
    joint: usize,
    /// Functions by columns, blocks × functions, each times the root of its size, N·m.
    functions: DMatrix<f64>,
    /// Variance of one equation of what repeats and looks like noise, (N·m)².
    white: f64,
}

impl Discrepancy {
    /// What the residual shows; `None` where it shows nothing beyond the scatter over periods, and where the states of the
    /// equations are not known.
    pub(in crate::estimation) fn found(
        problem: &EstimationProblem<'_>,
        noise: &NoiseModel,
        beta: &[f64],
    ) -> Option<Self> {
        let blocks = BlockedEquations::new(problem.observation, problem.samples?)?;
        let functions: Vec<Functions> = (0..problem.observation.dof)
            .map(|joint| features::of_joint(&blocks, problem.observation, joint, beta))
            .collect();
        let residuals: Vec<(usize, JointResidual)> = functions
            .iter()
            .enumerate()
            .filter_map(|(joint, functions)| Some((joint, JointResidual::new(&blocks, noise, joint, functions)?)))
            .collect();
        let more: Vec<bool> = residuals.iter().map(|(_, residual)| residual.shows_more_than_noise()).collect();
        if !more.contains(&true) {
            return None;
        }
        let reduced: Vec<_> =
            residuals.iter().zip(&more).map(|((_, residual), &more)| residual.reduced(more)).collect();
        let (sizes, shared) = sizes::restricted_likelihood(&reduced);
        let joints = residuals.iter().zip(sizes).map(|((joint, residual), sizes)| {
            let functions = &functions[*joint];
            let own = functions.own.iter().zip(sizes.own.iter().map(|size| size * residual.unit()));
            let columns = own
                .chain(functions.shared.iter().zip(shared))
                .flat_map(|(group, variance)| group.column_iter().map(move |column| column * variance.sqrt()));
            let columns: Vec<_> = columns.collect();
            let white = sizes.white * noise.covariance()[(*joint, *joint)];
            JointDiscrepancy { joint: *joint, functions: DMatrix::from_columns(&columns), white }
        });
        let joints: Vec<JointDiscrepancy> = joints.collect();
        (!joints.is_empty()).then_some(Self { blocks, joints })
    }

    /// `Bᵀ K B`, b × b.
    pub(in crate::estimation) fn products(
        &self,
        problem: &EstimationProblem<'_>,
        instruments: Instruments<'_>,
    ) -> Result<DMatrix<f64>, EstimationError> {
        let observation = problem.observation;
        let (b, n) = (observation.regressor.ncols(), observation.dof);
        let mut spread: Vec<DMatrix<f64>> =
            self.joints.iter().map(|joint| DMatrix::zeros(b, joint.functions.ncols())).collect();
        let mut sum = DMatrix::zeros(b, b);
        let whole = self.joints.iter().any(|joint| joint.white > 0.0);
        let mut rows: Vec<DMatrix<f64>> = Vec::new();
        for first in (0..b).step_by(COLUMNS) {
            let range = first..(first + COLUMNS).min(b);
            let columns = instruments.columns(observation, range.clone())?;
            for (joint, spread) in self.joints.iter().zip(&mut spread) {
                let sums = self.blocks.sums(&columns, joint.joint);
                let part = product(&sums.transpose(), &joint.functions);
                spread.rows_range_mut(range.clone()).copy_from(&part);
            }
            if whole {
                rows.push(columns);
            }
        }
        for spread in &spread {
            sum += product(spread, &spread.transpose());
        }
        for joint in self.joints.iter().filter(|joint| joint.white > 0.0) {
            for (p, left) in rows.iter().enumerate() {
                for (q, right) in rows.iter().enumerate() {
                    for i in 0..left.ncols() {
                        for j in 0..right.ncols() {
                            let dot: f64 = (joint.joint..left.nrows())
                                .step_by(n)
                                .map(|row| left[(row, i)] * right[(row, j)])
                                .sum();
                            sum[(p * COLUMNS + i, q * COLUMNS + j)] += joint.white * dot;
                        }
                    }
                }
            }
        }
        Ok(sum)
    }
}
