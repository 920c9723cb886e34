//! Equations averaged over blocks of time, few enough to be looked at joint by joint.
//!
//! ```text
//! ȳ = mean of D consecutive equations, D = ⌈M / 360⌉
//! ```
//! What a model lacks is smooth against the sampling of a recording; what is faster than a block is left to the scatter.

use nalgebra::{DMatrix, DVector};

use crate::estimation::observation::Observation;
use crate::signal::{NoiseModel, Samples};

/// At most this many blocks.
const MOST_BLOCKS: usize = 360;

/// Means of equations and states over blocks.
#[derive(Clone, Debug)]
pub(super) struct BlockedEquations {
    /// Equations in a block.
    pub(super) length: usize,
    /// Number of blocks.
    pub(super) count: usize,
    /// Whether the last block is followed by the first.
    pub(super) periodic: bool,
    dof: usize,
    samples: usize,
    /// Regressor, (n · count) × b.
    regressor: DMatrix<f64>,
    torque: DVector<f64>,
    /// Torque of laws that explain what they can, (n · count) × few.
    laws: DMatrix<f64>,
    /// Root of the share of a block's equations that are used, n · count; zero where fewer than half are.
    weight: Vec<f64>,
    /// Position, speed and acceleration, count × n each.
    pub(super) q: DMatrix<f64>,
    pub(super) qd: DMatrix<f64>,
    pub(super) qdd: DMatrix<f64>,
}

impl BlockedEquations {
    /// `None` where the samples are not those of the observation.
    pub(super) fn new(observation: &Observation, samples: &Samples, laws: Option<&DMatrix<f64>>) -> Option<Self> {
        let (n, m) = (observation.dof, observation.samples());
        if samples.dof() != n || samples.blocks() != m || m == 0 {
            return None;
        }
        let length = m.div_ceil(MOST_BLOCKS);
        let count = m / length;
        let mut weight = vec![0.0; n * count];
        for (row, weight) in weight.iter_mut().enumerate() {
            let (block, i) = (row / n, row % n);
            let used = (0..length).filter(|k| observation.used[(block * length + k) * n + i]).count();
            *weight = if 2 * used >= length { (used as f64 / length as f64).sqrt() } else { 0.0 };
        }
        let means = |columns: &[f64]| {
            let columns = columns.chunks_exact(n * m);
            let count_of = columns.len();
            let means = columns.flat_map(|column| block_means(column, &observation.used, &weight, [n, length]));
            DMatrix::from_vec(n * count, count_of, means.collect())
        };
        let raw = samples.block * length;
        let state = |values: &[f64]| {
            DMatrix::from_fn(count, n, |block, i| {
                let sum: f64 = (0..raw).map(|k| values[(block * raw + k) * n + i]).sum();
                sum / raw as f64
            })
        };
        Some(Self {
            length,
            count,
            periodic: observation.periodic && count * length == m,
            dof: n,
            samples: m,
            regressor: means(observation.regressor.as_slice()),
            torque: means(observation.y.as_slice()).column(0).into_owned(),
            laws: means(laws.map_or(&[], DMatrix::as_slice)),
            weight,
            q: state(&samples.states.q),
            qd: state(&samples.states.qd),
            qdd: state(&samples.states.qdd),
        })
    }

    /// W of one joint, count × b.
    pub(super) fn regressor(&self, joint: usize) -> DMatrix<f64> {
        DMatrix::from_fn(self.count, self.regressor.ncols(), |block, j| self.regressor[(block * self.dof + joint, j)])
    }

    /// W of one joint and the torque of laws, count × (b + few): what no discrepancy is looked for in.
    pub(super) fn explained(&self, joint: usize) -> DMatrix<f64> {
        let b = self.regressor.ncols();
        let entry = |row: usize, j: usize| if j < b { self.regressor[(row, j)] } else { self.laws[(row, j - b)] };
        DMatrix::from_fn(self.count, b + self.laws.ncols(), |block, j| entry(block * self.dof + joint, j))
    }

    /// y of one joint, count.
    pub(super) fn torque(&self, joint: usize) -> DVector<f64> {
        DVector::from_fn(self.count, |block, _| self.torque[block * self.dof + joint])
    }

    /// Weights of one joint's blocks, count.
    pub(super) fn weight(&self, joint: usize) -> Vec<f64> {
        self.weight.iter().skip(joint).step_by(self.dof).copied().collect()
    }

    /// Sums of a joint's rows over blocks, count × columns, of columns of n·M numbers each.
    pub(super) fn sums(&self, columns: &[f64], joint: usize) -> DMatrix<f64> {
        let columns = columns.chunks_exact(self.dof * self.samples);
        let mut sums = DMatrix::zeros(self.count, columns.len());
        for (mut sums, column) in sums.column_iter_mut().zip(columns) {
            let (sums, mut samples) = (sums.as_mut_slice(), column.chunks_exact(self.dof));
            for (block, sum) in sums.iter_mut().enumerate() {
                let length = if block + 1 == self.count { self.samples } else { self.length };
                *sum = samples.by_ref().take(length).map(|sample| sample[joint]).sum();
            }
        }
        sums
    }

    /// Lag covariances of a joint's block means, from lag zero: `1/D² Σ_ab R(l D + b − a)`.
    pub(super) fn lags(&self, noise: &NoiseModel, joint: usize) -> Vec<f64> {
        let d = self.length;
        let variance = noise.covariance()[(joint, joint)];
        let last = (noise.length() / d + 1).min(self.count / 2);
        (0..=last)
            .map(|l| {
                let of = |a: usize, b: usize| noise.correlation(joint, (l * d + b).abs_diff(a));
                let sum: f64 = (0..d).flat_map(|a| (0..d).map(move |b| (a, b))).map(|(a, b)| of(a, b)).sum();
                variance * sum / (d * d) as f64
            })
            .collect()
    }
}

/// Means of a column of n·M entries over the used ones of each block of `length` samples, n for each block; zero where the weight is.
fn block_means(column: &[f64], used: &[bool], weight: &[f64], [n, length]: [usize; 2]) -> Vec<f64> {
    let mut means = vec![0.0; weight.len()];
    let blocks = column.chunks_exact(n * length).zip(used.chunks_exact(n * length));
    for ((block, (entries, used)), weight) in means.chunks_exact_mut(n).zip(blocks).zip(weight.chunks_exact(n)) {
        for (entries, used) in entries.chunks_exact(n).zip(used.chunks_exact(n)) {
            let of_sample = entries.iter().zip(used).map(|(entry, used)| if *used { *entry } else { 0.0 });
            block.iter_mut().zip(of_sample).for_each(|(sum, entry)| *sum += entry);
        }
        for (mean, weight) in block.iter_mut().zip(weight) {
            // Rows that are no equation are zero.
            let used = weight * weight * length as f64;
            *mean = if used > 0.0 { *mean / used } else { 0.0 };
        }
    }
    means
}
