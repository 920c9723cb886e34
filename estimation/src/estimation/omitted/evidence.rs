//! What a log says of the sizes of omitted laws, and which of them it supports.
//!
//! ```text
//! D̃ = D − W A⁻¹ Bᵀ D        s = D̃ᵀ P r = J θ + noise        J = D̃ᵀ P D̃        cov s = D̃ᵀ P C P D̃ = S
//! information K = J S⁻ J        score h = J S⁻ s
//! ```
//! C has the correlation of the noise in time. Noise from a residual is that which the laws leave. Where it is scatter over periods, what errors of the
//! motion add is in C too, and both are raised to what the laws leave where they are less. In directions that the regressor hides there is no
//! information.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::estimation::error::EstimationError;
use crate::estimation::estimate::IntervalBasis;
use crate::estimation::inference::raised;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::estimation::residual::residual_noise;
use crate::linalg::{definite_inverse, product, transpose_product};
use crate::signal::NoiseModel;
use crate::statistics::f_tail;

/// Chance that a log of an arm with none of the laws supports one.
const FALSE_ALARM: f64 = 0.05;
/// Eigenvalues of J, its diagonal being one, below which a direction is hidden.
const HIDDEN: f64 = 1e-8;

/// K and h.
pub(super) struct Evidence {
    pub(super) information: DMatrix<f64>,
    pub(super) score: DVector<f64>,
    /// Degrees of freedom of the noise.
    freedom: f64,
}

impl Evidence {
    /// Of the columns D, (n·M) × d, beside a weighted fit; `None` where the regressor hides all of them. `motion` is the noise that errors of
    /// the motion add to scatter over periods.
    ///
    /// # Errors
    /// [`EstimationError`] where weights are of another size.
    pub(super) fn new(
        observation: &Observation,
        linear: &LinearFit,
        columns: &DMatrix<f64>,
        motion: Option<&NoiseModel>,
    ) -> Result<Option<Self>, EstimationError> {
        let inside = linear.fit.moved_by(&linear.instruments().transposed_product(observation, columns)?);
        let shown = columns - product(&observation.regressor, &inside);
        // A joint without noise has no weight, and nothing to compare with.
        let Some(weights) = &linear.weights else { return Ok(None) };
        let weighted = weights.clone().precision(&shown, &observation.used)?;
        let whole = columns.map(|x| x * x).row_sum();
        let j = transpose_product(&shown, &weighted);
        // What is left by rounding of a column is nothing.
        let seen = shown.map(|x| x * x).row_sum();
        let scale = DVector::from_fn(j.nrows(), |c, _| {
            if seen[c] > HIDDEN * whole[c] && j[(c, c)] > 0.0 { 1.0 / j[(c, c)].sqrt() } else { 0.0 }
        });
        let scaled = DMatrix::from_fn(j.nrows(), j.ncols(), |a, b| scale[a] * j[(a, b)] * scale[b]);
        let eigen = SymmetricEigen::new(scaled);
        let places: Vec<usize> = (0..scale.len()).filter(|&at| eigen.eigenvalues[at] > HIDDEN).collect();
        if places.is_empty() {
            return Ok(None);
        }
        // Coordinates in which J is one.
        let mut basis = eigen.eigenvectors.select_columns(&places);
        for (mut column, &at) in basis.column_iter_mut().zip(&places) {
            column.component_mul_assign(&scale);
            column /= eigen.eigenvalues[at].sqrt();
        }
        let residual = observation.residual(linear.fit.solution());
        let score = basis.tr_mul(&weighted.tr_mul(&residual));
        let left = &residual - &shown * (&basis * &score);
        let (noise, motion) = if linear.basis == IntervalBasis::Residual {
            (residual_noise(observation, &left), None)
        } else {
            let freedom =
                observation.equations().saturating_sub(linear.fit.solution().len() + places.len()).max(1) as f64;
            let square = linear.misfit(observation)? - score.norm_squared();
            let expected = 1.0 + motion.map_or(0.0, |motion| share(motion, &linear.noise));
            let factor = (square / (freedom * expected)).max(1.0);
            (linear.noise.clone().scaled(factor), motion.map(|motion| motion.clone().scaled(factor)))
        };
        let of = |noise: &NoiseModel| {
            let spread = noise.operator(observation.samples()).apply(&weighted);
            basis.transpose() * transpose_product(&weighted, &spread) * &basis
        };
        let white = of(&NoiseModel::white(noise.covariance().clone(), false, noise.degrees_of_freedom));
        let mut spread = raised(of(&noise), &white);
        if let Some(motion) = &motion {
            // Lags that were cut off may leave directions in which it is less than nothing.
            spread = raised(of(motion) + &spread, &spread);
        }
        let Some(precision) = definite_inverse(spread) else { return Ok(None) };
        // θ in those coordinates has the precision S⁻¹, and J basis brings the coordinates of θ there.
        let to = basis.transpose() * j;
        let information = to.transpose() * &precision * &to;
        let score = to.transpose() * precision * score;
        Ok(Some(Self { information, score, freedom: noise.degrees_of_freedom }))
    }

    /// Which of the groups are supported, and the probability, over all groups, of noise as large: the clearest first, the others beside it.
    pub(super) fn supported(&self, groups: &[Range<usize>]) -> Vec<(usize, f64)> {
        let mut found: Vec<(usize, f64)> = Vec::new();
        loop {
            let beside: Vec<usize> = found.iter().flat_map(|&(group, _)| groups[group].clone()).collect();
            let open = (0..groups.len()).filter(|group| found.iter().all(|(of, _)| of != group));
            let tested = open.map(|group| (group, groups.len() as f64 * self.chance(&groups[group], &beside)));
            match tested.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((group, p)) if p < FALSE_ALARM => found.push((group, p)),
                Some(_) | None => return found,
            }
        }
    }

    /// Probability that noise gives as much of a group beside others, by F.
    fn chance(&self, group: &Range<usize>, beside: &[usize]) -> f64 {
        let own: Vec<usize> = group.clone().collect();
        let part = |rows: &[usize], columns: &[usize]| self.information.select_rows(rows).select_columns(columns);
        let cross = part(&own, beside);
        let gain = &cross * inverse(&part(beside, beside));
        let information = part(&own, &own) - &gain * cross.transpose();
        let score = self.score.select_rows(&own) - gain * self.score.select_rows(beside);
        let whole = part(&own, &own).diagonal();
        let shown: Vec<usize> = (0..own.len()).filter(|&c| information[(c, c)] > HIDDEN * whole[c]).collect();
        if shown.is_empty() {
            return 1.0;
        }
        let (information, score) = (information.select_rows(&shown).select_columns(&shown), score.select_rows(&shown));
        let rank = shown.len() as f64;
        f_tail(score.dot(&(inverse(&information) * &score)).max(0.0) / rank, rank, self.freedom)
    }
}

/// Variance of one noise as a share of another's, in the mean over joints.
fn share(of: &NoiseModel, noise: &NoiseModel) -> f64 {
    let n = noise.dof();
    (0..n).map(|i| of.covariance()[(i, i)] / noise.covariance()[(i, i)].max(f64::MIN_POSITIVE)).sum::<f64>() / n as f64
}

/// Inverse of a symmetric matrix in the directions that are not hidden.
fn inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.is_empty() {
        return matrix.clone();
    }
    let scale = matrix.diagonal().map(|x| if x > 0.0 { 1.0 / x.sqrt() } else { 0.0 });
    let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |a, b| scale[a] * matrix[(a, b)] * scale[b]);
    let eigen = SymmetricEigen::new(scaled);
    let inverse = eigen.eigenvalues.map(|x| if x > HIDDEN { 1.0 / x } else { 0.0 });
    let mut part = eigen.eigenvectors;
    for (mut row, scale) in part.row_iter_mut().zip(scale.iter()) {
        row *= *scale;
    }
    &part * DMatrix::from_diagonal(&inverse) * part.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_law_that_is_there_is_supported_and_not_the_one_that_resembles_it() {
        // Two laws of two drives, correlated by 0.8; the first has sizes of 5 and 4 standard deviations.
        let information = DMatrix::from_row_slice(
            4,
            4,
            &[1.0, 0.0, 0.8, 0.0, 0.0, 1.0, 0.0, 0.8, 0.8, 0.0, 1.0, 0.0, 0.0, 0.8, 0.0, 1.0],
        );
        let score = &information * DVector::from_vec(vec![5.0, 4.0, 0.0, 0.0]);
        let evidence = Evidence { information, score, freedom: f64::INFINITY };
        let groups = [0..2, 2..4];
        // F = (25 + 16)/2 of 2 degrees of freedom: exp(−41/2), twice. The other is explained by it.
        let found = evidence.supported(&groups);
        assert_eq!((found.len(), found[0].0), (1, 0));
        assert!((found[0].1 / (2.0 * libm::exp(-20.5)) - 1.0).abs() < 1e-6, "{found:?}");
        let chance = evidence.chance(&groups[1], &[0, 1]);
        assert!((chance - 1.0).abs() < 1e-9, "{chance}");
    }
}
