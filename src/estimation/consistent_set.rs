//! A full set of standard parameters that real bodies can have, as close to a guess as the estimate allows.
//!
//! ```text
//! minimise   Σ_links ( tr(P₀⁻¹ P) − ln det P ) + Σ_drives ( x/x₀ − ln x )     subject to   K φ = β̂
//! ```
//! P is a link's pseudo-inertia and P₀ that of the guess; x is a rotor inertia or a friction, never negative. This
//! distance is least at the guess itself, does not depend on frames or units, and grows without bound towards what no
//! body can have, so its minimum is consistent. Where no consistent set has exactly the estimated base parameters, the
//! equation is replaced by `½ λ rᵀ C⁻¹ r` with `r = K φ − β̂` and the covariance C of the estimate, for the smallest λ of
//! a series with which every base parameter stays inside its 95 % interval; or, where there is none, the largest.
//!
//! Reference: T. Lee, P. M. Wensing, F. C. Park, "Geometric robot dynamic identification: a convex programming approach",
//! IEEE Trans. Robotics 36(2), 2020.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix4};

use super::{Estimate, EstimationError};
use crate::base::BaseReduction;
use crate::model::{ParameterId, ParameterKind, StandardParameters};
use crate::spatial::{Inertia, PseudoInertia};

/// λ of the series, one after the other.
const WEIGHTS: [f64; 7] = [1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6];

/// Newton steps for one λ.
const STEPS: usize = 100;

/// Decrease that counts as none: half the squared Newton decrement.
const CONVERGED: f64 = 1e-11;

/// Halvings of a Newton step.
const SHORTENINGS: i32 = 60;

/// Projections onto the equation: the first does it but for rounding.
const PROJECTIONS: usize = 3;

/// Part of a link's pseudo-inertia that stands for what a guess does not say: where P₀ is not positive definite.
const INFLATION: f64 = 1e-3;

/// A drive's rotor inertia or friction where nobody guesses it, SI.
const UNKNOWN_DRIVE: f64 = 1e-3;

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
}

/// The consistent set of parameters that is nearest to a guess and has the base parameters of an estimate.
///
/// # Errors
/// [`EstimationError::Mismatch`] where the estimate is not one of this base or the guess is of another arm.
pub fn consistent_set(
    base: &BaseReduction,
    estimate: &Estimate,
    guess: &StandardParameters,
) -> Result<ConsistentSet, EstimationError> {
    let mismatch =
        |quantity, found: String, expected: String| Err(EstimationError::Mismatch { quantity, found, expected });
    if estimate.names() != base.names() {
        return mismatch("base parameters", estimate.names().join(" "), base.names().join(" "));
    }
    let links = base.parameters.iter().map(|id| id.index + 1).max().unwrap_or(0);
    if guess.links.len() != links || guess.drives.len() != links {
        return mismatch("links of the nominal set", guess.links.len().to_string(), links.to_string());
    }
    let Some(information) = estimate.information() else {
        return mismatch("covariance", "one that is not positive definite".into(), "a positive definite one".into());
    };
    let distance = Distance::of(base, guess);
    let (beta, std) = (estimate.beta(), estimate.std());
    let mut phi = distance.centre();
    let mut within = None;
    for weight in WEIGHTS {
        let pull = Pull { k: &base.k, beta: &beta, information: &information * weight };
        phi = newton(phi, &distance, &pull);
        within = within.or_else(|| outside(base, estimate, &phi).is_empty().then(|| phi.clone()));
    }
    let exact = project(&phi, &distance, base, &beta);
    let is_exact = exact.is_some();
    let phi = exact.or(within).unwrap_or(phi);
    let mut parameters = guess.clone();
    for (c, &id) in base.parameters.iter().enumerate() {
        parameters.set(id, phi[c]);
    }
    Ok(ConsistentSet {
        parameters,
        deviations: (base.beta(&phi) - &beta).component_div(&std).as_slice().to_vec(),
        is_exact,
        outside: outside(base, estimate, &phi),
    })
}

/// Base parameters outside their intervals.
fn outside(base: &BaseReduction, estimate: &Estimate, phi: &DVector<f64>) -> Vec<String> {
    let found = base.beta(phi);
    let stated = estimate.base.iter().zip(found.iter());
    let beyond = |(stated, found): &(&super::BaseEstimate, &f64)| !(stated.ci95[0]..=stated.ci95[1]).contains(*found);
    stated.filter(beyond).map(|(stated, _)| stated.name.clone()).collect()
}

/// The distance from the guess and its derivatives.
struct Distance {
    parameters: Vec<ParameterId>,
    /// Position of the ten of each link among the parameters, and P₀ with its inverse.
    links: Vec<(usize, Matrix4<f64>, Matrix4<f64>)>,
    /// Position and x₀ of each quantity that is never negative.
    drives: Vec<(usize, f64)>,
    /// Position, guess and size of each offset.
    offsets: Vec<(usize, f64, f64)>,
    /// Pseudo-inertia of each of the ten parameters.
    units: [Matrix4<f64>; 10],
}

impl Distance {
    fn of(base: &BaseReduction, guess: &StandardParameters) -> Self {
        let parameters = base.parameters.clone();
        let units = std::array::from_fn(|k| {
            let mut ten = [0.0; 10];
            ten[k] = 1.0;
            Inertia::from_array(&ten).pseudo().0
        });
        let (mut links, mut drives, mut offsets) = (Vec::new(), Vec::new(), Vec::new());
        for (c, &id) in parameters.iter().enumerate() {
            let value = guess.get(id);
            match id.kind {
                ParameterKind::M => {
                    let p0 = within_the_cone(guess.links[id.index].pseudo());
                    let inverse = p0.try_inverse().unwrap_or_else(Matrix4::identity);
                    links.push((c, p0, inverse));
                }
                kind if kind <= ParameterKind::Izz => {}
                ParameterKind::Fo => offsets.push((c, value, value.abs().max(1.0))),
                _ => drives.push((c, if value > 0.0 { value } else { UNKNOWN_DRIVE })),
            }
        }
        Self { parameters, links, drives, offsets, units }
    }

    /// The guess, or what stands for it where it is not consistent.
    fn centre(&self) -> DVector<f64> {
        let mut phi = DVector::zeros(self.parameters.len());
        for (at, p0, _) in &self.links {
            phi.rows_mut(*at, 10).copy_from_slice(&PseudoInertia(*p0).inertia().to_array());
        }
        for &(at, x0) in &self.drives {
            phi[at] = x0;
        }
        for &(at, value, _) in &self.offsets {
            phi[at] = value;
        }
        phi
    }

    fn pseudo(&self, phi: &DVector<f64>, at: usize) -> Matrix4<f64> {
        let mut p = Matrix4::zeros();
        for (k, unit) in self.units.iter().enumerate() {
            p += unit * phi[at + k];
        }
        p
    }

    /// Infinite where the set is not consistent.
    fn value(&self, phi: &DVector<f64>) -> f64 {
        let mut sum = 0.0;
        for (at, _, inverse) in &self.links {
            let p = self.pseudo(phi, *at);
            let Some(factor) = p.cholesky() else { return f64::INFINITY };
            let log_det: f64 = factor.l_dirty().diagonal().iter().map(|&d| 2.0 * libm::log(d)).sum();
            sum += (inverse * p).trace() - log_det;
        }
        for &(at, x0) in &self.drives {
            if phi[at] <= 0.0 {
                return f64::INFINITY;
            }
            sum += phi[at] / x0 - libm::log(phi[at]);
        }
        sum + self.offsets.iter().map(|&(at, x0, size)| 0.5 * ((phi[at] - x0) / size).powi(2)).sum::<f64>()
    }

    /// Gradient and Hessian at a consistent set.
    fn derivatives(&self, phi: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let p = phi.len();
        let (mut gradient, mut hessian) = (DVector::zeros(p), DMatrix::zeros(p, p));
        for (at, _, inverse) in &self.links {
            let now = self.pseudo(phi, *at).try_inverse().unwrap_or_else(Matrix4::identity);
            let turned: Vec<Matrix4<f64>> = self.units.iter().map(|unit| now * unit).collect();
            for k in 0..10 {
                gradient[at + k] += (inverse * self.units[k]).trace() - turned[k].trace();
                for l in 0..10 {
                    hessian[(at + k, at + l)] += (turned[k] * turned[l]).trace();
                }
            }
        }
        for &(at, x0) in &self.drives {
            gradient[at] += 1.0 / x0 - 1.0 / phi[at];
            hessian[(at, at)] += 1.0 / (phi[at] * phi[at]);
        }
        for &(at, x0, size) in &self.offsets {
            gradient[at] += (phi[at] - x0) / (size * size);
            hessian[(at, at)] += 1.0 / (size * size);
        }
        (gradient, hessian)
    }
}

/// The pseudo-inertia itself where a body can have it, else one with small bodies added.
fn within_the_cone(pseudo: PseudoInertia) -> Matrix4<f64> {
    let lacking = (-pseudo.smallest_eigenvalue()).max(0.0);
    let size = pseudo.0.trace().abs().max(INFLATION);
    if lacking == 0.0 && pseudo.smallest_eigenvalue() > 0.0 {
        return pseudo.0;
    }
    pseudo.0 + Matrix4::identity() * (lacking + INFLATION * size)
}

/// The quadratic that pulls towards the estimate, `½ rᵀ L r`.
struct Pull<'a> {
    k: &'a DMatrix<f64>,
    beta: &'a DVector<f64>,
    information: DMatrix<f64>,
}

impl Pull<'_> {
    fn value(&self, phi: &DVector<f64>) -> f64 {
        let r = self.k * phi - self.beta;
        0.5 * r.dot(&(&self.information * &r))
    }
}

/// Damped Newton steps from a consistent set to the minimum of distance and pull; every iterate is consistent.
fn newton(mut phi: DVector<f64>, distance: &Distance, pull: &Pull<'_>) -> DVector<f64> {
    let value = |phi: &DVector<f64>| distance.value(phi) + pull.value(phi);
    let curvature = pull.k.tr_mul(&(&pull.information * pull.k));
    for _ in 0..STEPS {
        let (mut gradient, mut hessian) = distance.derivatives(&phi);
        gradient += pull.k.tr_mul(&(&pull.information * (pull.k * &phi - pull.beta)));
        hessian += &curvature;
        let Some(factor) = Scaled::of(&hessian) else { break };
        let step = -factor.solve(&gradient);
        let promised = -gradient.dot(&step);
        if promised.is_nan() || 0.5 * promised < CONVERGED {
            break;
        }
        let before = value(&phi);
        let lengths = (0..SHORTENINGS).map(|halvings| libm::exp2(-f64::from(halvings)));
        let trials = lengths.map(|length| (length, &phi + &step * length));
        let mut better = trials.filter(|(length, trial)| value(trial) <= before - 1e-4 * length * promised);
        let Some((_, trial)) = better.next() else { break };
        drop(better);
        phi = trial;
    }
    phi
}

/// The nearest set, in the curvature of the distance, with exactly these base parameters: consistent only where the set
/// that it starts from is close.
fn project(phi: &DVector<f64>, distance: &Distance, base: &BaseReduction, beta: &DVector<f64>) -> Option<DVector<f64>> {
    let mut phi = phi.clone();
    for _ in 0..PROJECTIONS {
        let (_, hessian) = distance.derivatives(&phi);
        let factor = Scaled::of(&hessian)?;
        let spread =
            DMatrix::from_columns(&base.k.row_iter().map(|row| factor.solve(&row.transpose())).collect::<Vec<_>>());
        let missing = Scaled::of(&(&base.k * &spread))?.solve(&(beta - base.beta(&phi)));
        phi += spread * missing;
        if !distance.value(&phi).is_finite() {
            return None;
        }
    }
    Some(phi)
}

/// The factor of a positive definite matrix, in units in which its diagonal is one.
struct Scaled {
    unit: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Scaled {
    fn of(matrix: &DMatrix<f64>) -> Option<Self> {
        let unit = matrix.diagonal().map(|d| 1.0 / d.sqrt());
        let scaled = DMatrix::from_fn(unit.len(), unit.len(), |i, j| matrix[(i, j)] * unit[i] * unit[j]);
        Some(Self { unit, factor: Cholesky::new(scaled)? })
    }

    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&right.component_mul(&self.unit)).component_mul(&self.unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::estimation::{BaseEstimate, IntervalBasis, Termination};
    use crate::excitation::fixtures::{crs_a460, crs_a460_nominal};
    use crate::model::Columns;
    use crate::seed::Seed;
    use rand::RngExt;

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
        let base = reduce(&robot, Columns::RigidRotorFriction, Method::Structural, Seed::new(0)).unwrap();
        let guess = crs_a460_nominal();
        let beta = base.beta(&guess.vector(&robot, Columns::RigidRotorFriction));
        let std = beta.map(|value| 0.02 * value.abs() + 1e-3);
        (base, guess, beta, std)
    }

    fn is_consistent(set: &StandardParameters) -> bool {
        set.links.iter().all(|link| link.check().is_ok())
            && set.drives.iter().all(|d| d.rotor > 0.0 && d.viscous > 0.0 && d.coulomb > 0.0)
    }

    #[test]
    fn identity_the_guess_itself_where_it_has_the_base_parameters() {
        let (base, guess, beta, std) = setting();
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        assert!(set.is_exact && set.outside.is_empty());
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
        let beta = base.beta(&other.vector(&robot, Columns::RigidRotorFriction));
        let set = consistent_set(&base, &estimate(&base, &beta, &std), &guess).unwrap();
        assert!(set.is_exact && is_consistent(&set.parameters));
        let found = base.beta(&set.parameters.vector(&robot, Columns::RigidRotorFriction));
        assert!((&found - &beta).amax() < 1e-9 * beta.amax(), "{}", (found - beta).amax());
        // Nearer to the guess than the other arm is, by the distance itself.
        let distance = Distance::of(&base, &guess);
        let value = |set: &StandardParameters| distance.value(&set.vector(&robot, Columns::RigidRotorFriction));
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
        assert!(is_consistent(&set.parameters));
    }

    #[test]
    fn analytic_derivatives_of_the_distance_are_its_differences() {
        let (base, guess, ..) = setting();
        let distance = Distance::of(&base, &guess);
        let mut rng = Seed::new(51).stream("consistent set", 0);
        let phi = distance.centre().map(|x| x * (1.0 + 0.01 * rng.random_range(-1.0..1.0)));
        let (gradient, hessian) = distance.derivatives(&phi);
        for i in (0..phi.len()).step_by(7) {
            let h = 1e-5 / hessian[(i, i)].sqrt();
            let at = |side: f64| {
                let mut moved = phi.clone();
                moved[i] += side * h;
                moved
            };
            let slope = (distance.value(&at(1.0)) - distance.value(&at(-1.0))) / (2.0 * h);
            let size = hessian[(i, i)].sqrt();
            assert!((slope - gradient[i]).abs() < 1e-6 * (size + gradient[i].abs()), "{i}: {slope} {}", gradient[i]);
            let bend = (distance.derivatives(&at(1.0)).0 - distance.derivatives(&at(-1.0)).0) / (2.0 * h);
            for j in 0..phi.len() {
                let size = size * hessian[(j, j)].sqrt();
                assert!((bend[j] - hessian[(i, j)]).abs() < 1e-6 * size, "{i} {j}");
            }
        }
    }
}
