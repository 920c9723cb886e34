//! The discrepancy of an arm: of its joints one by one, and of laws that they share.

use nalgebra::DMatrix;

use super::blocks::BlockedEquations;
use super::features::{self, Functions};
use super::joint::{Chances, JointResidual};
use super::misfit::{self, JointMisfit};
use super::sizes;
use crate::estimation::error::EstimationError;
use crate::estimation::finding::Finding;
use crate::estimation::instruments::COLUMNS;
use crate::estimation::instruments::Instruments;
use crate::estimation::observation::Observation;
use crate::linalg::{product, transpose_product};
use crate::signal::{NoiseModel, Samples};
use crate::statistics::root_mean_square;

/// The discrepancy of all joints, where one of them shows any.
#[derive(Clone, Debug)]
pub(in crate::estimation) struct Discrepancy {
    blocks: BlockedEquations,
    joints: Vec<JointDiscrepancy>,
    /// Variance of one equation of what repeats and looks like noise, n × n, diagonal, (N·m)².
    white: DMatrix<f64>,
    /// Joints whose own fit leaves more than chance explains, at 5 % over all joints.
    pub(in crate::estimation) findings: Vec<Finding>,
}

/// The discrepancy of one joint, as far as functions go.
#[derive(Clone, Debug)]
struct JointDiscrepancy {
    /// Joint, from zero.
    joint: usize,
    /// Functions by columns, blocks × functions, each times the root of its size, N·m.
    functions: DMatrix<f64>,
}

impl Discrepancy {
    /// What the residual shows; `None` where it shows nothing beyond the scatter over periods, and where the samples are not those
    /// of the observation. β (b) says what each joint carries, and columns of `laws`, (n·M) × few, are explained. What the errors of the
    /// motion explain is no finding; the intervals take all that repeats for a discrepancy.
    pub(in crate::estimation) fn find(
        observation: &Observation,
        samples: &Samples,
        (noise, motion): (&NoiseModel, Option<&NoiseModel>),
        beta: &[f64],
        laws: Option<&DMatrix<f64>>,
    ) -> Option<Self> {
        let blocks = BlockedEquations::new(observation, samples, laws)?;
        let functions: Vec<Functions> = features::of_joints(&blocks, observation, beta);
        let beside = |noise: &NoiseModel| -> Vec<(usize, JointResidual)> {
            let joints = functions.iter().enumerate();
            joints.filter_map(|(i, of)| Some((i, JointResidual::new(&blocks, noise, i, of)?))).collect()
        };
        let residuals = beside(noise);
        let chances: Vec<Chances> = residuals.iter().map(|(_, residual)| residual.chances()).collect();
        let more: Vec<bool> = chances.iter().map(|chances| chances.show_more_than_noise()).collect();
        if !more.contains(&true) {
            return None;
        }
        let named = |residuals: &[(usize, JointResidual)], chances: &[Chances]| {
            let joints = residuals.iter().zip(chances);
            let misfits = joints.map(|(&(joint, ref residual), chances)| JointMisfit {
                joint,
                residual,
                p: chances.adjusted(),
                speed: &blocks.qd.as_slice()[joint * blocks.count..(joint + 1) * blocks.count],
                load: &functions[joint].load,
                torque_rms: root_mean_square(blocks.torque(joint).as_slice()),
                unit: &observation.units[joint],
            });
            misfit::findings(&misfits.collect::<Vec<_>>())
        };
        let findings = motion.map_or_else(
            || named(&residuals, &chances),
            |motion| {
                let residuals = beside(&noise.plus(motion));
                let chances: Vec<Chances> = residuals.iter().map(|(_, residual)| residual.chances()).collect();
                named(&residuals, &chances)
            },
        );
        let reduced: Vec<_> =
            residuals.iter().zip(&more).map(|((_, residual), &more)| residual.reduced(more)).collect();
        let (sizes, shared) = sizes::restricted_likelihood(&reduced);
        let mut white = DMatrix::zeros(observation.dof, observation.dof);
        let joints = residuals.iter().zip(sizes).map(|(&(joint, ref residual), sizes)| {
            white[(joint, joint)] = sizes.white * noise.covariance()[(joint, joint)];
            let functions = &functions[joint];
            let own = functions.own.iter().zip(sizes.own.iter().map(|size| size * residual.unit));
            let columns: Vec<_> = own
                .chain(functions.shared.iter().zip(shared))
                .filter(|(_, variance)| *variance > 0.0)
                .flat_map(|(group, variance)| group.column_iter().map(move |column| column * variance.sqrt()))
                .collect();
            let none = || DMatrix::zeros(blocks.count, 0);
            let functions = if columns.is_empty() { none() } else { DMatrix::from_columns(&columns) };
            JointDiscrepancy { joint, functions }
        });
        let joints = joints.collect();
        Some(Self { blocks, joints, white, findings })
    }

    /// What of it repeats and looks like noise, as a noise that is white in time.
    pub(in crate::estimation) fn white(&self) -> NoiseModel {
        NoiseModel::white(self.white.clone(), self.blocks.periodic, f64::INFINITY)
    }

    /// `Bᵀ K B` of its functions, b × b.
    pub(in crate::estimation) fn products(
        &self,
        observation: &Observation,
        instruments: Instruments<'_>,
    ) -> Result<DMatrix<f64>, EstimationError> {
        let b = observation.regressor.ncols();
        let mut spread: Vec<DMatrix<f64>> =
            self.joints.iter().map(|joint| DMatrix::zeros(b, joint.functions.ncols())).collect();
        for first in (0..b).step_by(COLUMNS) {
            let range = first..(first + COLUMNS).min(b);
            let columns = instruments.columns(observation, range.clone())?;
            for (joint, spread) in self.joints.iter().zip(&mut spread) {
                let sums = self.blocks.sums(&columns, joint.joint);
                let part = transpose_product(&sums, &joint.functions);
                spread.rows_range_mut(range.clone()).copy_from(&part);
            }
        }
        Ok(spread.iter().fold(DMatrix::zeros(b, b), |sum, spread| sum + product(spread, &spread.transpose())))
    }
}
