//! The search for the nearest consistent set.

use nalgebra::DVector;

use super::distance::Distance;
use super::newton::{DataTerm, Minimum, newton, project};
use crate::base::BaseReduction;
use crate::estimation::{BaseEstimate, Estimate, EstimationError, Termination};
use crate::model::StandardParameters;

/// λ of the series, one after the other.
const WEIGHTS: [f64; 7] = [1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6];

/// A consistent set of standard parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ConsistentSet {
    /// The set.
    pub parameters: StandardParameters,
    /// Its base parameters minus the estimated ones, over their standard deviations (b).
    pub deviations: Vec<f64>,
    /// Whether its base parameters are the estimated ones.
    pub is_exact: bool,
    /// Names of the base parameters outside their 95 % intervals.
    pub outside: Vec<String>,
    /// How the minimisation ended that gave the set.
    pub termination: Termination,
}

/// The consistent set of parameters that is nearest to a guess and has the base parameters of an estimate.
///
/// # Errors
/// [`EstimationError::OtherBase`] where the estimate is not one of this base, [`EstimationError::Count`] where the guess is of
/// another arm, [`EstimationError::NotDefinite`] where the covariance of the estimate is none.
pub fn consistent_set(
    base: &BaseReduction,
    estimate: &Estimate,
    guess: &StandardParameters,
) -> Result<ConsistentSet, EstimationError> {
    if estimate.names() != base.names() {
        return Err(EstimationError::OtherBase { found: estimate.names(), expected: base.names() });
    }
    let links = base.parameters.iter().map(|id| id.index + 1).max().unwrap_or(0);
    if guess.links.len() != links || guess.drives.len() != links {
        let found = guess.links.len();
        return Err(EstimationError::Count { quantity: "links of the nominal set", found, expected: links });
    }
    let Some(information) = estimate.information() else { return Err(EstimationError::NotDefinite) };
    let distance = Distance::of(base, guess);
    let (beta, std) = (estimate.beta(), estimate.std());
    let mut last = Minimum { phi: distance.centre(), termination: Termination::Direct };
    let mut within = None;
    for weight in WEIGHTS {
        let data = DataTerm { k: &base.k, beta: &beta, information: &information * weight };
        last = newton(last.phi, &distance, &data);
        within = within.or_else(|| outside(base, estimate, &last.phi).is_empty().then(|| last.clone()));
    }
    let exact = project(&last.phi, &distance, base, &beta);
    let is_exact = exact.is_some();
    let Minimum { phi, termination } = match exact {
        Some(phi) => Minimum { phi, ..last },
        None => within.unwrap_or(last),
    };
    let mut parameters = guess.clone();
    for (c, &id) in base.parameters.iter().enumerate() {
        parameters.set(id, phi[c]);
    }
    Ok(ConsistentSet {
        parameters,
        deviations: (base.beta(&phi) - &beta).component_div(&std).as_slice().to_vec(),
        is_exact,
        outside: outside(base, estimate, &phi),
        termination,
    })
}

/// Base parameters outside their intervals.
fn outside(base: &BaseReduction, estimate: &Estimate, phi: &DVector<f64>) -> Vec<String> {
    let found = base.beta(phi);
    let stated = estimate.base.iter().zip(found.iter());
    let beyond = |(stated, found): &(&BaseEstimate, &f64)| !(stated.ci95[0]..=stated.ci95[1]).contains(*found);
    stated.filter(beyond).map(|(stated, _)| stated.name.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::estimation::IntervalBasis;
    use crate::excitation::fixtures::{crs_a460, crs_a460_nominal};
    use crate::model::Columns;
    use crate::model::term::{COULOMB, ROTOR, VISCOUS};
    use crate::seed::Seed;
    use crate::spatial::Inertia;

    fn estimate(base: &BaseReduction, beta: &DVector<f64>, std: &DVector<f64>) -> Estimate {
        let b = beta.len();
        let of = |i: usize| BaseEstimate {
            name: base.names()[i].clone(),
            value: beta[i],
            std: std[i],
            ci95: [beta[i] - 1.96 * std[i], beta[i] + 1.96 * std[i]],
            unit: String::new(),
        };
        Estimate {
            estimator: "wls".to_owned(),
            robot: "crs-a460".to_owned(),
            columns: "rigid".to_owned(),
            base: (0..b).map(of).collect(),
            covariance: (0..b).map(|i| (0..b).map(|j| if i == j { std[i] * std[i] } else { 0.0 }).collect()).collect(),
            standard: None,
            consistent: None,
            residual_rms: Vec::new(),
            noise_std: Vec::new(),
            units: Vec::new(),
            condition: 1.0,
            condition_scaled: 1.0,
            interval_basis: IntervalBasis::Scatter,
            degrees_of_freedom: 100.0,
            samples: 1,
            periods: 1,
            findings: Vec::new(),
            termination: Termination::Direct,
            provenance: None,
        }
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
        assert!(set.is_exact && set.outside.is_empty() && set.termination.was_successful(), "{:?}", set.termination);
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
        assert!(set.is_exact && is_consistent(&set.parameters));
        assert!(matches!(set.termination, Termination::Converged { .. }), "{:?}", set.termination);
        let found = base.beta(&set.parameters.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
        assert!((&found - &beta).amax() < 1e-9 * beta.amax(), "{}", (found - beta).amax());
        // Nearer to the guess than the other arm is, by the distance itself.
        let distance = Distance::of(&base, &guess);
        let value = |set: &StandardParameters| distance.value(&set.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
        assert!(value(&set.parameters) < value(&other));
    }

    #[test]
    fn identity_noise_that_leaves_the_cone_is_met_within_the_intervals() {
        // Nothing consistent has a wrist friction below zero, and the estimate says so within its interval.
        let (base, guess, mut beta, mut std) = setting();
        let at = base.names().iter().position(|name| name == "Fv6").unwrap();
        beta[at] = -0.01;
        std[at] = 0.02;
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        assert!(!set.is_exact && set.outside.is_empty() && is_consistent(&set.parameters), "{:?}", set.outside);
        assert!(set.deviations[at] > 0.5 && set.deviations[at] < 1.96, "{}", set.deviations[at]);
        // Beyond its interval there is none, and the parameter is named.
        std[at] = 0.001;
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        assert_eq!(set.outside, ["Fv6"]);
        assert!(is_consistent(&set.parameters) && set.termination.was_successful(), "{:?}", set.termination);
    }
}
