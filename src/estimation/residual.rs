//! Noise seen in the residual of a fit, where nothing was repeated.

use nalgebra::{DMatrix, DVector};

use crate::signal::NoiseModel;

/// Lag covariances of the residual `r` (n·M), corrected for the `parameters` that were fitted:
///
/// ```text
/// R(l) = 1/(M (1 − b/(nM))) Σ_k r_k r_{k+l}ᵀ
/// ```
/// over all k that have a partner; with `wraps` the last instant is followed by the first.
pub(super) fn residual_noise(r: &DVector<f64>, dof: usize, parameters: usize, wraps: bool) -> NoiseModel {
    let count = r.len() / dof;
    let left = 1.0 - parameters as f64 / r.len() as f64;
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
        sum / (count as f64 * left.max(f64::EPSILON))
    };
    NoiseModel::adaptive(lag, count / 4, wraps, count as f64 * left)
}

/// RMS of each joint's entries of `r` (n·M), n.
pub(super) fn joint_rms(r: &[f64], dof: usize) -> Vec<f64> {
    let count = (r.len() / dof).max(1) as f64;
    (0..dof).map(|i| (r.iter().skip(i).step_by(dof).map(|r| r * r).sum::<f64>() / count).sqrt()).collect()
}

/// Correlation of each joint's residual with the one before, n.
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
