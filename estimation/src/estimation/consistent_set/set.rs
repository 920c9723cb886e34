//! The search for the nearest consistent set.

use super::newton::DataTerm;
use super::path::{follow, nearer};
use super::prior::Prior;
use super::region::Region;
use super::shape_bounds::ShapeBounds;
use crate::base::BaseReduction;
use crate::estimation::{Estimate, EstimationError, Termination};
use crate::model::StandardParameters;
use crate::statistics::chi_squared_quantile;

/// Probability of the joint region of all base parameters.
const CONFIDENCE: f64 = 0.95;

/// A consistent set of standard parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ConsistentSet {
    /// The set.
    pub parameters: StandardParameters,
    /// `(K φ − β̂)ᵀ C⁻¹ (K φ − β̂)`.
    pub chi_squared: f64,
    /// The value that the estimate's own χ² exceeds with a probability of 5 %: beyond it the set contradicts the data.
    pub chi_squared_limit: f64,
    /// How the search ended; its iterations are those of all weights.
    pub termination: Termination,
}

impl ConsistentSet {
    /// Whether the set lies in the joint 95 % region of the estimate.
    #[must_use]
    pub fn is_within(&self) -> bool {
        self.chi_squared <= self.chi_squared_limit
    }
}

/// The consistent set of parameters that agrees best with an estimate, and of several the one nearest to a guess. Where none has the
/// estimated base parameters, those whose χ² is within 1 % of the least agree alike.
///
/// # Errors
/// [`EstimationError::OtherBase`] where the estimate is not one of this base, [`EstimationError::Count`] where the guess is of
/// another arm, [`EstimationError::NotDefinite`] where the covariance of the estimate is not positive definite.
pub(in crate::estimation) fn consistent_set(
    base: &BaseReduction,
    estimate: &Estimate,
    guess: &StandardParameters,
) -> Result<ConsistentSet, EstimationError> {
    if estimate.names() != base.names() {
        return Err(EstimationError::OtherBase { found: estimate.names(), expected: base.names() });
    }
    let Some(information) = estimate.information() else { return Err(EstimationError::NotDefinite) };
    let (beta, std, covariance) = (estimate.beta(), estimate.std(), estimate.covariance_matrix());
    let region = Region::of(base, guess, (&beta, &std), &ShapeBounds::default())?;
    let data = DataTerm::of(&base.k, &beta, information, &covariance)?;
    let end = follow(&region, &data, Prior::None);
    let (phi, lambda, termination) =
        nearer(&region, &data, &end).unwrap_or_else(|| (end.phi.clone(), end.lambda, end.termination));
    let mut parameters = guess.clone();
    for (c, &id) in base.parameters.iter().enumerate() {
        parameters.set(id, phi[c]);
    }
    Ok(ConsistentSet {
        parameters,
        chi_squared: if lambda.is_infinite() { 0.0 } else { data.chi_squared(&phi) },
        chi_squared_limit: chi_squared_quantile(CONFIDENCE, base.rank() as f64),
        termination,
    })
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "an exact set has a chi squared of zero")]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::chains::{crs_a460, crs_a460_nominal};
    use crate::estimation::consistent_set::constrained_fit;
    use crate::estimation::consistent_set::fixtures::estimate_of;
    use crate::model::Columns;
    use crate::model::term::{COULOMB, ROTOR, VISCOUS};
    use crate::seed::Seed;
    use crate::spatial::Inertia;
    use nalgebra::{DMatrix, DVector};

    fn estimate(base: &BaseReduction, beta: &DVector<f64>, std: &DVector<f64>) -> Estimate {
        estimate_of(base, beta, &DMatrix::from_diagonal(&std.component_mul(std)))
    }

    fn setting() -> (BaseReduction, StandardParameters, DVector<f64>, DVector<f64>) {
        let robot = crs_a460();
        let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
        let guess = crs_a460_nominal();
        let beta = base.beta(&guess.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
        let std = beta.map(|value| 0.02 * value.abs() + 1e-3);
        (base, guess, beta, std)
    }

    fn is_consistent(set: &StandardParameters) -> bool {
        set.links.iter().all(|link| link.check().is_ok())
            && set.drives.iter().all(|d| d[ROTOR] > 0.0 && d[VISCOUS] > 0.0 && d[COULOMB] > 0.0)
    }

    #[test]
    fn identity_the_guess_itself_where_it_has_the_base_parameters() {
        let (base, guess, beta, std) = setting();
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        assert!(set.chi_squared == 0.0 && set.termination.was_successful(), "{:?}", set.termination);
        for (found, expected) in set.parameters.links.iter().zip(&guess.links) {
            for (found, expected) in found.to_array().iter().zip(expected.to_array()) {
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
        }
    }

    #[test]
    fn identity_a_consistent_set_with_the_base_parameters_of_another_arm() {
        // The base parameters of an arm whose links all weigh twice as much and stand on the other side.
        let (base, guess, _, std) = setting();
        let robot = crs_a460();
        let mut other = guess.clone();
        for link in &mut other.links {
            *link = Inertia::from_array(&link.to_array().map(|x| 2.0 * x));
        }
        let beta = base.beta(&other.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        assert!(set.chi_squared == 0.0 && is_consistent(&set.parameters));
        assert!(matches!(set.termination, Termination::Optimal { gap: 0.0, .. }), "{:?}", set.termination);
        let found = base.beta(&set.parameters.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
        assert!((&found - &beta).amax() < 1e-9 * beta.amax(), "{}", (found - beta).amax());
        // Nearer to the guess than the other arm is, by the distance itself.
        let region = Region::of(&base, &guess, (&beta, &std), &ShapeBounds::default()).unwrap();
        let value = |set: &StandardParameters| region.divergence(&set.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
        assert!(value(&set.parameters) < value(&other));
    }

    #[test]
    fn identity_little_more_than_the_least_chi_squared_is_nearer_to_the_guess() {
        // Noise of three standard deviations to either side: no consistent set has these base parameters.
        let (base, guess, exact, std) = setting();
        let beta = DVector::from_fn(exact.len(), |i, _| exact[i] + [3.0, -3.0][i % 2] * std[i]);
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        assert!(set.chi_squared > 0.0 && set.termination.was_successful() && is_consistent(&set.parameters));
        let covariance = DMatrix::from_diagonal(&std.component_mul(&std));
        let information = DMatrix::from_diagonal(&std.map(|std| 1.0 / (std * std)));
        let data = (&beta, information, &covariance);
        let least = constrained_fit(&base, (&guess, &ShapeBounds::default()), data, Prior::None).unwrap().phi;
        let least_chi_squared = (base.beta(&least) - &beta).component_div(&std).norm_squared();
        let ratio = set.chi_squared / least_chi_squared;
        assert!((1.0 - 1e-6..=1.0 + 1e-2).contains(&ratio), "{ratio}");
        let region = Region::of(&base, &guess, (&beta, &std), &ShapeBounds::default()).unwrap();
        let found = set.parameters.vector(&crs_a460(), Columns::RIGID_ROTOR_FRICTION);
        let (found, of_least) = (region.divergence(&found), region.divergence(&least));
        assert!(found < 0.9 * of_least, "{found} {of_least}");
    }

    #[test]
    fn identity_noise_that_leaves_the_cone_is_met_within_the_intervals() {
        // Nothing consistent has a wrist friction below zero, and the estimate says so within its interval.
        let (base, guess, mut beta, mut std) = setting();
        let at = base.names().iter().position(|name| name == "Fv6").unwrap();
        beta[at] = -0.01;
        std[at] = 0.02;
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        assert!(set.chi_squared > 0.0 && set.is_within() && is_consistent(&set.parameters), "{}", set.chi_squared);
        // Beyond its interval there is none.
        std[at] = 0.001;
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        // (0.01/0.001)², and 1 % for a set nearer to the guess.
        let limit = set.chi_squared_limit;
        assert!((99.5..=101.5).contains(&set.chi_squared) && !set.is_within(), "{} {limit}", set.chi_squared);
        assert!(is_consistent(&set.parameters) && set.termination.was_successful(), "{:?}", set.termination);
    }
}
