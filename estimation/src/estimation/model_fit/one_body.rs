//! One body, by combinations of its ten parameters that are known.
//!
//! ```text
//! min_θ  ½ (K θ − β̂)ᵀ A (K θ − β̂) + w D(θ)
//! ```

use nalgebra::{DMatrix, DVector};

use super::bodies::Body;
use super::equations::NormalEquations;
use super::minimum::{Divergence, Minimum};
use super::weight::down_to;
use crate::estimation::error::EstimationError;
use crate::estimation::termination::Termination;
use crate::linalg::product;
use crate::spatial::Inertia;

/// The weight of the guess: a hundredth of a nat.
const WEIGHT: f64 = 1e-2;

/// Least and largest mass over that of the guess.
const MASSES: (f64, f64) = (1e-3, 1e3);

/// The body near a guess that agrees best with combinations K (b × 10) of its ten, estimated as β̂ (b) with information A (b × b).
///
/// # Errors
/// [`EstimationError::NotDefinite`] where the guess is no body.
pub(in crate::estimation) fn fit_body(
    k: &DMatrix<f64>,
    beta: &DVector<f64>,
    information: &DMatrix<f64>,
    guess: &Inertia,
) -> Result<(Inertia, Termination), EstimationError> {
    let body = Body::around(0, guess, MASSES).ok_or(EstimationError::NotDefinite)?;
    let jacobian = body.jacobian();
    let columns = product(k, &DMatrix::from_column_slice(10, 10, jacobian.as_slice()));
    let seen = product(information, &columns);
    let equations = NormalEquations {
        information: product(&columns.transpose(), &seen),
        moment: seen.tr_mul(beta),
        square: beta.dot(&(information * beta)),
    };
    let prior = Divergence { bodies: vec![body], coefficients: Vec::new() };
    let Minimum { x, termination } = prior.descend(&equations, down_to(WEIGHT));
    let ten = jacobian * x.fixed_rows::<10>(0);
    Ok((Inertia::from_array(&ten.into()), termination))
}
