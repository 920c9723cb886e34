//! Error bars that know the constraint.
//!
//! ```text
//! no prior      [β̂₀ − tσ, β̂₀ + tσ] of the unconstrained fit, without what no body can have, widened to hold β̂
//! a prior       C' = S C Sᵀ + (1 − S) T (1 − S)ᵀ        S = T (T + C_A)⁻¹        T = K (∇²R)⁻¹ Kᵀ
//! ```
//! Without a prior: the truth is consistent, so an interval that holds it does so when cut to what is consistent. Bounds of a single
//! base parameter are used, those that couple parameters are not, so these intervals hold the truth at least as
//! often as they say. Covariance and standard deviations are those of the unconstrained fit: for a consistent truth the mean squared error
//! of a projection in their metric is not larger.
//! Cutting an interval to what is possible keeps its coverage (Mandelkern 2002, for one bounded parameter).
//!
//! With a prior: noise enters by S, and the prior's own error counts as large as it says, so that trust in a wrong prior is
//! what these intervals do not know.
//!
//! Reference: M. Mandelkern, "Setting confidence intervals for bounded parameters", Statistical Science 17(2), 2002.

use nalgebra::DMatrix;

use super::solution::ConsistentFit;
use crate::base::BaseReduction;
use crate::estimation::consistent_set::definite_inverse;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::{Estimate, StandardEstimate, rows_of};
use crate::estimation::finding::Finding;
use crate::estimation::problem::EstimationProblem;
use crate::model::ParameterKind;
use crate::model::term::Sign;
use crate::statistics::chi_squared_quantile;

/// Chi squared below which nothing was held back.
const NOTHING: f64 = 1e-9;

/// The estimate: `plain` of the unconstrained solution, `held` with intervals around the consistent one.
pub(super) fn restate(
    problem: &EstimationProblem<'_>,
    plain: &Estimate,
    held: Estimate,
    fit: &ConsistentFit,
) -> Result<Estimate, EstimationError> {
    let base = &problem.observation.base;
    let covariance = plain.covariance_matrix();
    let mut estimate =
        Estimate { degrees_of_freedom: plain.degrees_of_freedom, interval_basis: plain.interval_basis, ..held };
    match &fit.spread {
        Some(spread) => {
            let whole = definite_inverse(&(spread + &fit.inverse)).ok_or(EstimationError::NotDefinite)?;
            let gain = spread * whole;
            let rest = DMatrix::identity(gain.nrows(), gain.ncols()) - &gain;
            let both = &gain * &covariance * gain.transpose() + &rest * spread * rest.transpose();
            estimate.motor_errors = rows_of(&(&gain * estimate.motor_errors_matrix()));
            estimate = estimate.with_covariance(&both);
        }
        None => {
            estimate = estimate.with_covariance(&covariance);
            for (p, known) in estimate.base.iter_mut().zip(&plain.base) {
                p.ci95 = [known.ci95[0].min(p.value), known.ci95[1].max(p.value)];
            }
        }
    }
    for (_, p) in estimate.base.iter_mut().enumerate().filter(|(j, _)| is_never_negative(base, *j)) {
        p.ci95[0] = p.ci95[0].max(0.0).min(p.value);
    }
    estimate.findings.retain(|f| !matches!(f, Finding::InconsistentLink { .. } | Finding::NegativeDrive { .. }));
    if problem.nominal.is_some() {
        let values = base.parameters.iter();
        let of =
            |&id| StandardEstimate { name: crate::model::ParameterId::to_string(&id), value: fit.parameters.get(id) };
        estimate.standard = Some(values.map(of).collect());
        estimate.consistent = Some(true);
    }
    if problem.nominal.is_some() {
        estimate.findings.extend(fit.beyond_shape.iter().map(|&link| Finding::BeyondShape { link }));
    }
    let moved = &fit.beta - plain.beta();
    if let Some(information) = definite_inverse(&covariance) {
        let chi_squared = moved.dot(&(information * &moved));
        let limit = chi_squared_quantile(0.95, base.rank() as f64);
        let is_told = if fit.spread.is_none() { !fit.is_exact && chi_squared > NOTHING } else { chi_squared > limit };
        if is_told {
            estimate.findings.push(Finding::HeldBack { chi_squared, limit });
        }
    }
    Ok(estimate)
}

/// Whether a base parameter is a sum of quantities that are never negative.
fn is_never_negative(base: &BaseReduction, row: usize) -> bool {
    base.terms(row).iter().all(|&(id, coefficient)| {
        let never = match id.kind {
            ParameterKind::M | ParameterKind::Ixx | ParameterKind::Iyy | ParameterKind::Izz => true,
            ParameterKind::Term(term) => term.entry().sign == Sign::NotNegative,
            _ => false,
        };
        never && coefficient >= 0.0
    })
}
