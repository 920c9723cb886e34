//! What noise alone would leave as residual, joint by joint.
//!
//! ```text
//! r = (1 − W G) ε,  G = A⁻¹ Bᵀ        cov r = C − W G C − (W G C)ᵀ + W (cov β̂) Wᵀ
//! ```
//! Not simply the noise of that joint: in an ordinary fit the noise of a strong joint moves parameters that act
//! on a quiet joint. Only the diagonal and its neighbours in time are needed, summed over each joint's equations. Columns are taken a few
//! at a time, so that nothing of the size of W is made but the entries of W that are not zero.

use std::ops::Range;

use nalgebra::DMatrix;

use super::entries::{joint_entries, put_joint_entries};
use super::error::EstimationError;
use super::instruments::COLUMNS;
use super::instruments::Instruments;
use super::observation::Observation;
use super::problem::EstimationProblem;
use crate::linalg::LeastSquares;
use crate::linalg::product::{product, transposed_product};
use crate::signal::NoiseModel;

/// RMS and neighbour correlation of the residual that noise alone would leave, n each.
pub(super) struct ExpectedResidual {
    pub(super) rms: Vec<f64>,
    pub(super) correlation: Vec<f64>,
}

impl ExpectedResidual {
    /// For an estimate with `covariance` (b × b) under `noise`.
    pub(super) fn new(
        problem: &EstimationProblem<'_>,
        fit: &LeastSquares,
        instruments: Instruments<'_>,
        noise: &NoiseModel,
        covariance: &DMatrix<f64>,
    ) -> Result<Self, EstimationError> {
        let observation = problem.observation;
        let n = observation.dof;
        let mut joints: Vec<JointSums> = (0..n).map(|i| JointSums::new(observation, i)).collect();
        let inverse = fit.inverse_information();
        let operator = noise.operator(observation.samples());
        for first in (0..inverse.ncols()).step_by(COLUMNS) {
            let range = first..(first + COLUMNS).min(inverse.ncols());
            let columns = instruments.columns(observation, range.clone())?;
            let spread = operator.apply_to_columns(&columns, observation.regressor.nrows());
            for (i, sums) in joints.iter_mut().enumerate() {
                let places: Vec<usize> = (0..range.len()).collect();
                let spread = with_end(observation, i, &spread, &places);
                let gain = sums.fitted(&inverse, range.clone());
                sums.add(gain.as_slice(), spread.as_slice(), -1.0);
                sums.add(spread.as_slice(), gain.as_slice(), -1.0);
                sums.add_covariance(covariance, range.clone());
            }
        }
        for (i, sums) in joints.iter_mut().enumerate() {
            let used: Vec<bool> = observation.used.iter().skip(i).step_by(n).copied().collect();
            let pairs = used.windows(2).filter(|pair| pair[0] && pair[1]).count();
            let (own, count) = (noise.covariance()[(i, i)], used.iter().filter(|used| **used).count());
            sums.count = count.max(1);
            sums.power += own * count as f64;
            sums.neighbours += own * noise.correlation(i, 1) * pairs as f64;
        }
        let correlation = |of: &JointSums| if of.power > 0.0 { of.neighbours / of.power } else { 0.0 };
        Ok(Self {
            rms: joints.iter().map(|of| (of.power.max(0.0) / of.count as f64).sqrt()).collect(),
            correlation: joints.iter().map(correlation).collect(),
        })
    }
}

/// Entries of a joint in some columns, zero where they are no equation, and a zero behind the last of each.
fn with_end(observation: &Observation, joint: usize, w: &DMatrix<f64>, columns: &[usize]) -> DMatrix<f64> {
    let (n, samples) = (observation.dof, observation.samples());
    let unused: Vec<usize> = (0..samples).filter(|k| !observation.used[k * n + joint]).collect();
    let mut rows = DMatrix::zeros(samples + 1, columns.len());
    for (mut column, &j) in rows.column_iter_mut().zip(columns) {
        let column = column.as_mut_slice();
        put_joint_entries(w, n, joint, j, column);
        unused.iter().for_each(|&k| column[k] = 0.0);
    }
    rows
}

/// The equations of one joint, and sums over them of products of an equation's numbers with its own and with those of the next.
struct JointSums {
    /// Columns that act on the joint, ascending.
    columns: Vec<usize>,
    /// Their entries, (M + 1) × as many: the zero behind the last is its neighbour.
    rows: DMatrix<f64>,
    count: usize,
    power: f64,
    neighbours: f64,
}

impl JointSums {
    fn new(observation: &Observation, joint: usize) -> Self {
        let entries = |j: usize| joint_entries(&observation.regressor, observation.dof, joint, j);
        let columns: Vec<usize> =
            (0..observation.regressor.ncols()).filter(|&j| entries(j).any(|entry| entry != 0.0)).collect();
        let rows = with_end(observation, joint, &observation.regressor, &columns);
        Self { columns, rows, count: 1, power: 0.0, neighbours: 0.0 }
    }

    /// `W_i X` for a few columns of X, b × b.
    fn fitted(&self, x: &DMatrix<f64>, range: Range<usize>) -> DMatrix<f64> {
        product(&self.rows, &x.columns_range(range).select_rows(&self.columns))
    }

    /// Adds `W_i (cov β̂) W_iᵀ`, as far as a few of its columns go.
    fn add_covariance(&mut self, covariance: &DMatrix<f64>, range: Range<usize>) {
        let own = self.columns.partition_point(|&j| j < range.start)..self.columns.partition_point(|&j| j < range.end);
        let part = covariance.select_columns(&self.columns[own.clone()]);
        let (part, rows) = (self.fitted(&part, 0..own.len()), self.rows.columns_range(own).into_owned());
        self.add(part.as_slice(), rows.as_slice(), 1.0);
    }

    /// Adds `sign Σ a_k b_k` and `sign Σ a_k b_k+1` over columns that end with a zero.
    fn add(&mut self, a: &[f64], b: &[f64], sign: f64) {
        let Some(before_last) = a.len().checked_sub(1) else { return };
        let sum = |a: &[f64], b: &[f64]| transposed_product(a, b, a.len())[(0, 0)];
        self.power += sign * sum(a, b);
        self.neighbours += sign * sum(&a[..before_last], &b[1..]);
    }
}
