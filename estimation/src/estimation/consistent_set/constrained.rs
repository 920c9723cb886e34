//! The consistent set that explains the equations of a fit best, alone or beside a prior.

use nalgebra::{DMatrix, DVector};

use super::newton::{DataTerm, StepEquations};
use super::path::{PathEnd, follow};
use super::prior::Prior;
use super::region::Region;
use super::shape_bounds::ShapeBounds;
use crate::base::BaseReduction;
use crate::estimation::error::EstimationError;
use crate::estimation::termination::Termination;
use crate::model::StandardParameters;

/// The optimum.
#[derive(Clone, Debug)]
pub(in crate::estimation) struct ConstrainedFit {
    /// The set, p.
    pub(in crate::estimation) phi: DVector<f64>,
    /// Whether K φ = β̂: the unconstrained minimum is consistent, and nothing else was asked.
    pub(in crate::estimation) is_exact: bool,
    /// What the prior leaves free of K φ: `K (∇²R)⁻¹ Kᵀ` (b × b) at the optimum; `None` without a prior.
    pub(in crate::estimation) spread: Option<DMatrix<f64>>,
    /// Links, from one, whose guess lies outside their shape, which then bounds nothing.
    pub(in crate::estimation) beyond_shape: Vec<usize>,
    /// How the search ended.
    pub(in crate::estimation) termination: Termination,
}

/// Solves for unconstrained parameters β̂ (b) with information A and its inverse, near `guess`.
///
/// # Errors
/// [`EstimationError::Count`] where the guess is of another arm or the ten of a link do not stand together,
/// [`EstimationError::NotDefinite`] where the equations have no definite information.
pub(in crate::estimation) fn constrained_fit(
    base: &BaseReduction,
    (guess, shapes): (&StandardParameters, &ShapeBounds),
    (beta, information, inverse): (&DVector<f64>, DMatrix<f64>, &DMatrix<f64>),
    prior: Prior,
) -> Result<ConstrainedFit, EstimationError> {
    let std = inverse.diagonal().map(|v| v.max(0.0).sqrt());
    let region = Region::of(base, guess, beta, &std, shapes)?;
    let data = DataTerm::of(&base.k, beta, information, inverse)?;
    let PathEnd { phi, lambda, termination, .. } = follow(&region, &data, prior);
    let spread = match prior {
        Prior::None => None,
        Prior::Entropic | Prior::Pullback | Prior::Euclidean => {
            let alone = StepEquations::of(&phi, &region, &data, prior, prior.alone());
            Some(alone.ok_or(EstimationError::NotDefinite)?.spread())
        }
    };
    Ok(ConstrainedFit { phi, is_exact: lambda.is_infinite(), spread, beyond_shape: region.beyond_shape, termination })
}

/// Inverse of a positive definite matrix, in units in which its diagonal is one.
pub(in crate::estimation) fn definite_inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let p = matrix.nrows();
    let unit = matrix.diagonal().map(f64::sqrt);
    let of = |i: usize, j: usize| 0.5 * (matrix[(i, j)] + matrix[(j, i)]) / (unit[i] * unit[j]);
    let inverse = DMatrix::from_fn(p, p, of).cholesky()?.inverse();
    Some(DMatrix::from_fn(p, p, |i, j| inverse[(i, j)] / (unit[i] * unit[j])))
}
