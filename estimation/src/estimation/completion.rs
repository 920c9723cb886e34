//! A full set of standard parameters that agrees with estimated base parameters.
//!
//! ```text
//! φ = φ_nom + Kᵀ (K Kᵀ)⁻¹ (β̂ − K φ_nom)        K φ = β̂
//! ```
//! The smallest change of the nominal set, in SI units, that makes its base parameters the estimated ones; what
//! torque does not show stays nominal. It predicts torque as β̂ does. Nothing forces it to be physically consistent:
//! the findings say where it is not.

use crate::model::term::Sign;
use nalgebra::DVector;

use super::error::EstimationError;
use super::finding::Finding;
use crate::base::BaseReduction;
use crate::linalg::{LeastSquares, product};
use crate::model::StandardParameters;
use crate::spatial::InertiaError;

/// A full set of standard parameters, and where it is physically inconsistent.
#[derive(Clone, Debug, PartialEq)]
pub struct Completion {
    /// The set.
    pub parameters: StandardParameters,
    /// Links and drives that are not physically consistent; none where all are.
    pub findings: Vec<Finding>,
}

/// Whether a nominal set is of the arm of a base.
pub(super) fn check_links(base: &BaseReduction, nominal: &StandardParameters) -> Result<(), EstimationError> {
    let expected = base.parameters.iter().map(|id| id.index + 1).max().unwrap_or(0);
    let found = nominal.links.len();
    if found == expected && nominal.drives.len() == expected {
        return Ok(());
    }
    Err(EstimationError::Count { quantity: "links of the nominal set", found, expected })
}

/// Completes base parameters β̂ (b) with a nominal set.
///
/// # Errors
/// [`EstimationError::Count`] where β̂ has not one value per base parameter or the nominal set is of another arm.
pub fn complete(
    base: &BaseReduction,
    beta: &DVector<f64>,
    nominal: &StandardParameters,
) -> Result<Completion, EstimationError> {
    EstimationError::unless_equal("base parameters", beta.len(), base.rank())?;
    check_links(base, nominal)?;
    let p = base.parameters.len();
    let phi = DVector::from_iterator(p, base.parameters.iter().map(|&id| nominal.get(id)));
    let missing = beta - base.beta(&phi);
    // Kᵀ (K Kᵀ)⁻¹ d = Kᵀ times the solution of K Kᵀ x = d; K holds an identity, so K Kᵀ is well away from singular.
    let k_t = base.k.transpose();
    let x = LeastSquares::solve(&product(&base.k, &k_t), &missing)?;
    let mut change = vec![0.0; p];
    for (j, column) in base.k.row_iter().enumerate() {
        for (c, &coefficient) in column.iter().enumerate() {
            change[c] += coefficient * x.solution()[j];
        }
    }
    let mut parameters = nominal.clone();
    for (c, &id) in base.parameters.iter().enumerate() {
        parameters.set(id, phi[c] + change[c]);
    }
    let mut findings = Vec::new();
    for (link, inertia) in parameters.links.iter().enumerate() {
        if let Err(InertiaError::NotPositiveDefinite { eigenvalue }) = inertia.check() {
            findings.push(Finding::InconsistentLink { link: link + 1, eigenvalue });
        }
    }
    for &id in &base.parameters {
        let value = parameters.get(id);
        let never_negative = id.kind.term().is_some_and(|term| term.entry().sign == Sign::NotNegative);
        if never_negative && value < 0.0 {
            findings.push(Finding::NegativeDrive { parameter: id.to_string(), value });
        }
    }
    Ok(Completion { parameters, findings })
}
