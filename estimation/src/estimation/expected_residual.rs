//! What noise alone would leave as residual, joint by joint.
//!
//! ```text
//! r = (1 − W G) ε,  G = A⁻¹ Bᵀ        cov r = C − W G C − (W G C)ᵀ + W (cov β̂) Wᵀ
//! ```
//! Not simply the noise of that joint: in an ordinary fit the noise of a strong joint moves parameters that act
//! on a quiet joint. Only the diagonal and its neighbours in time are needed, summed over each joint's equations; columns are taken a few
//! at a time, so that nothing of the size of W is made.

use nalgebra::DMatrix;

use super::error::EstimationError;
use super::instruments::COLUMNS;
use super::instruments::Instruments;
use super::observation::Observation;
use super::problem::EstimationProblem;
use crate::linalg::LeastSquares;
use crate::linalg::product::add_product;
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
        let (n, rows) = (observation.dof, observation.y.len());
        let mut sums = NeighbourSums::new(observation);
        let inverse = fit.inverse_information();
        let operator = noise.operator(observation.samples());
        for first in (0..inverse.ncols()).step_by(COLUMNS) {
            let range = first..(first + COLUMNS).min(inverse.ncols());
            let spread = operator.apply(&instruments.columns(observation, range.clone())?);
            let gain = fitted(observation, &inverse.columns_range(range.clone()).into_owned());
            sums.add(&gain, &spread, -1.0);
            sums.add(&spread, &gain, -1.0);
            let part = fitted(observation, &covariance.columns_range(range.clone()).into_owned());
            sums.add(&part, &observation.regressor.columns_range(range).into_owned(), 1.0);
        }
        for row in 0..rows {
            let i = row % n;
            if observation.used[row] {
                let own = noise.covariance()[(i, i)];
                sums.power[i] += own;
                if row + n < rows && observation.used[row + n] {
                    sums.neighbours[i] += own * noise.correlation(i, 1);
                }
            }
        }
        let counts = (0..n).map(|i| observation.used.iter().skip(i).step_by(n).filter(|used| **used).count().max(1));
        let correlation = |(&power, neighbours): (&f64, &f64)| if power > 0.0 { neighbours / power } else { 0.0 };
        Ok(Self {
            rms: sums.power.iter().zip(counts).map(|(p, count)| (p.max(0.0) / count as f64).sqrt()).collect(),
            correlation: sums.power.iter().zip(&sums.neighbours).map(correlation).collect(),
        })
    }
}

/// W x for a few columns x (b × few).
fn fitted(observation: &Observation, x: &DMatrix<f64>) -> DMatrix<f64> {
    let rows = observation.y.len();
    let mut out = DMatrix::zeros(rows, x.ncols());
    add_product(observation.regressor.as_slice(), x.as_slice(), rows, out.as_mut_slice());
    out
}

/// Sums over the equations of each joint of products of an equation's numbers with its own and with those of the next sample.
struct NeighbourSums<'a> {
    observation: &'a Observation,
    power: Vec<f64>,
    neighbours: Vec<f64>,
}

impl<'a> NeighbourSums<'a> {
    fn new(observation: &'a Observation) -> Self {
        let n = observation.dof;
        Self { observation, power: vec![0.0; n], neighbours: vec![0.0; n] }
    }

    /// Adds `sign Σ a_row b_row` and `sign Σ a_row b_next` of two matrices of n·M rows.
    fn add(&mut self, a: &DMatrix<f64>, b: &DMatrix<f64>, sign: f64) {
        let (n, used) = (self.observation.dof, &self.observation.used);
        for (a, b) in a.column_iter().zip(b.column_iter()) {
            let (a, b) = (a.as_slice(), b.as_slice());
            for i in 0..n {
                let (mut own, mut next) = (0.0, 0.0);
                for row in (i..used.len()).step_by(n).filter(|&row| used[row]) {
                    own += a[row] * b[row];
                    if row + n < used.len() && used[row + n] {
                        next += a[row] * b[row + n];
                    }
                }
                self.power[i] += sign * own;
                self.neighbours[i] += sign * next;
            }
        }
    }
}
