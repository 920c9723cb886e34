//! The noise behind an estimate's error bars: of the scatter over periods, or of the residual of a fit.

use nalgebra::{DMatrix, DVector};

use super::Observation;
use crate::linalg::BlockWhitening;
use crate::signal::NoiseModel;

/// The noise that scattered over periods; `None` where nothing was repeated or some joint did not scatter at all.
#[must_use]
pub fn scatter_noise(observation: &Observation) -> Option<NoiseModel> {
    observation.noise.clone().filter(|noise| BlockWhitening::new(noise.covariance()).is_ok())
}

/// Lag covariances of the residual `r` (n·M), corrected for the b parameters that were fitted:
///
/// ```text
/// R_ij(l) = 1/(√(M_i M_j) (1 − b/E)) Σ_k r_i,k r_j,k+l        E equations, M_i of them of joint i
/// ```
/// over all k that have a partner; in a period the last instant is followed by the first. With this divisor R(0) is
/// never indefinite.
#[must_use]
pub fn residual_noise(observation: &Observation, r: &DVector<f64>) -> NoiseModel {
    let (dof, wraps, count) = (observation.dof, observation.periodic, observation.samples());
    let used = |k: usize, i: usize| observation.used[k * dof + i];
    let left = (1.0 - observation.base.rank() as f64 / observation.equations().max(1) as f64).max(f64::EPSILON);
    let counts: Vec<f64> = (0..dof).map(|i| (0..count).filter(|&k| used(k, i)).count().max(1) as f64).collect();
    let shared = DMatrix::from_fn(dof, dof, |i, j| (counts[i] * counts[j]).sqrt());
    let lag = |l: usize| {
        let mut sum = DMatrix::zeros(dof, dof);
        for k in 0..(if wraps { count } else { count - l }) {
            let other = (k + l) % count;
            for i in 0..dof {
                for j in 0..dof {
                    sum[(i, j)] += r[k * dof + i] * r[other * dof + j];
                }
            }
        }
        sum.component_div(&shared) / left
    };
    NoiseModel::adaptive(lag, count / 4, wraps, observation.equations() as f64 / dof as f64 * left)
}

/// RMS of each joint's entries of `r` (n·M) where they are used, n.
pub(super) fn joint_rms(r: &[f64], used: &[bool], dof: usize) -> Vec<f64> {
    (0..dof)
        .map(|i| {
            let (mut sum, mut count) = (0.0, 0);
            for (r, _) in r.iter().zip(used).skip(i).step_by(dof).filter(|(_, used)| **used) {
                sum += r * r;
                count += 1;
            }
            (sum / f64::from(count.max(1))).sqrt()
        })
        .collect()
}

/// Correlation of each joint's residual with the one before, n; residuals that are not used are zero.
pub(super) fn neighbour_correlation(r: &[f64], dof: usize) -> Vec<f64> {
    (0..dof)
        .map(|i| {
            let series: Vec<f64> = r.iter().skip(i).step_by(dof).copied().collect();
            let power: f64 = series.iter().map(|r| r * r).sum();
            let product: f64 = series.windows(2).map(|pair| pair[0] * pair[1]).sum();
            if power > 0.0 { product / power } else { 0.0 }
        })
        .collect()
}
