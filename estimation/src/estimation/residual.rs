//! The noise behind an estimate's error bars: of the scatter over periods, or of the residual of a fit.

use nalgebra::{DMatrix, DVector};

use super::observation::Observation;
use crate::linalg::BlockWhitening;
use crate::signal::{LagProducts, NoiseModel};

/// The noise that scattered over periods; `None` where nothing was repeated or some joint with equations did not scatter at all.
pub fn scatter_noise(observation: &Observation) -> Option<NoiseModel> {
    let mut noise = observation.noise.clone()?;
    let variance = noise.covariance().diagonal();
    for (i, _) in variance.iter().enumerate().filter(|(_, variance)| **variance == 0.0) {
        // Torque that was not measured did not scatter, and is in no equation.
        if !observation.used.iter().skip(i).step_by(observation.dof).any(|used| *used) {
            noise = noise.with_white(i, UNMEASURED * variance.amax());
        }
    }
    Some(noise).filter(|noise| BlockWhitening::new(noise.covariance()).is_ok())
}

/// Variance of torque that was not measured, over the largest that was: none, but one that can be divided by.
const UNMEASURED: f64 = 1e-30;

/// Lag covariances of the residual `r` (n·M), corrected for the b parameters that were fitted:
///
/// ```text
/// R_ij(l) = 1/(√(M_i M_j) (1 − b/E)) Σ_k r_i,k r_j,k+l        E equations, M_i of them of joint i
/// ```
/// over all k that have a partner; in a period the last instant is followed by the first. With this divisor R(0) is
/// never indefinite.
pub fn residual_noise(observation: &Observation, r: &DVector<f64>) -> NoiseModel {
    let (dof, wraps, count) = (observation.dof, observation.periodic, observation.samples());
    let scale = ResidualScale::of(observation);
    let mut products = LagProducts::new(r.as_slice(), dof, wraps);
    let lag = |l: usize| scale.covariance(&products.product(l));
    NoiseModel::adaptive(lag, count / 4, wraps, observation.equations() as f64 / dof as f64 * scale.left)
}

/// What sums of products of residuals are divided by.
pub(super) struct ResidualScale {
    /// `√(M_i M_j)`.
    shared: DMatrix<f64>,
    /// `1 − b/E`: the part of the noise that a fit leaves.
    left: f64,
}

impl ResidualScale {
    pub(super) fn of(observation: &Observation) -> Self {
        let n = observation.dof;
        let counts: Vec<f64> = (0..n)
            .map(|i| observation.used.iter().skip(i).step_by(n).filter(|used| **used).count().max(1) as f64)
            .collect();
        let left = 1.0 - observation.base.rank() as f64 / observation.equations().max(1) as f64;
        Self { shared: DMatrix::from_fn(n, n, |i, j| (counts[i] * counts[j]).sqrt()), left: left.max(f64::EPSILON) }
    }

    /// The covariance with these sums.
    pub(super) fn covariance(&self, products: &DMatrix<f64>) -> DMatrix<f64> {
        products.component_div(&self.shared) / self.left
    }

    /// RMS of each joint with these sums, n.
    pub(super) fn rms(&self, products: &DMatrix<f64>) -> Vec<f64> {
        products.diagonal().iter().zip(self.shared.diagonal().iter()).map(|(sum, count)| (sum / count).sqrt()).collect()
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_sums_of_two_joints() {
        let r = [3.0, 1.0, 4.0, 7.0, 0.0, 2.0];
        let used = [true, true, true, false, false, true];
        let rms = joint_rms(&r, &used, 2);
        assert!((rms[0] - 12.5_f64.sqrt()).abs() < 1e-15 && (rms[1] - 2.5_f64.sqrt()).abs() < 1e-15, "{rms:?}");
        assert_eq!(joint_rms(&r, &[false; 6], 2), [0.0, 0.0]);
        // 3·4 + 4·0 over 9 + 16, and 1·7 + 7·2 over 1 + 49 + 4.
        let correlation = neighbour_correlation(&r, 2);
        assert!((correlation[0] - 12.0 / 25.0).abs() < 1e-15 && (correlation[1] - 21.0 / 54.0).abs() < 1e-15);
        assert_eq!(neighbour_correlation(&[0.0, 1.0, 0.0, 0.0], 2), [0.0, 0.0]);
    }
}
