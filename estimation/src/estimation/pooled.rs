//! One estimate by the estimates of several experiments.
//!
//! ```text
//! M = Σ_k C_k⁻¹      β̂ = Σ_k G_k β̂_k      G_k = M⁻¹ C_k⁻¹      C_k = N_k + D_k, by noise and by errors of the model
//! cov β̂ = Σ_k G_k N_k G_kᵀ + Σ_k G_k D_k G_kᵀ / w_k + L          Σ_k w_k = 1
//! ```
//! Noise is independent between experiments and averages out. The model has the same error in all of them, to an extent that no
//! residual shows. The second sum is an upper bound in every direction, whatever that extent is, by the inequality of Cauchy and Schwarz.
//! w_k is proportional to the root of the trace of part k in units of standard deviations. So one motion that is repeated keeps its error.
//!
//! How large the laws are that a model omits, one experiment says less well than all. Where an estimate by the equations of all is given, L is
//! its part beyond noise, and D_k is zero in experiments that show nothing beyond noise. Where motions differ it is zero too in those that show no
//! more than errors of the measured motion explain: another motion has other errors, and L has them.
//!
//! Where estimates differ at 5 % by more than the C_k say, `χ² = Σ_k (β̂_k − β̂)ᵀ C_k⁻¹ (β̂_k − β̂)`, the covariance is widened by χ²
//! over its degrees of freedom, b (K − 1) of K experiments. For a linear model and D_k = 0, nothing is lost against one fit of all data.
//!
//! Reference: R. T. Birge, "The calculation of errors by the method of least squares", *Physical Review* 40, 1932, for the widening.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::consistent_set::definite_inverse;
use super::error::EstimationError;
use super::estimate::{BaseEstimate, Estimate, IntervalBasis, rows_of, symmetric_rows_of};
use super::finding::Finding;
use crate::linalg::product;
use crate::statistics::{chi_squared_quantile, student_quantile};

/// Confidence at which experiments count as different.
const LEVEL: f64 = 0.95;

/// The estimates of several experiments as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Pooled {
    /// The estimate: what is not of its values and their covariance is that of the last experiment.
    pub estimate: Estimate,
    /// Factor on its standard deviations, 1 where the experiments differ by no more than their covariances say.
    pub widened_by: f64,
}

/// What all experiments say together.
#[derive(Clone, Copy, Debug)]
pub struct Together<'a> {
    /// The estimate by the equations of all.
    pub estimate: &'a Estimate,
    /// Whether each experiment has a motion of its own, and with it errors of the measured motion of its own.
    pub do_motions_differ: bool,
}

/// Pools estimates of the same base parameters of one arm, in the order of the experiments.
///
/// # Errors
/// [`EstimationError::Count`] of none, [`EstimationError::OtherRobot`] and [`EstimationError::OtherBase`] where they are of different
/// things, [`EstimationError::NotDefinite`] where a covariance is not positive definite.
pub fn pool(estimates: &[&Estimate], together: Option<Together<'_>>) -> Result<Pooled, EstimationError> {
    let Some(&last) = estimates.last() else {
        return Err(EstimationError::Count { quantity: "estimates to pool", found: 0, expected: 1 });
    };
    let names = last.names();
    for estimate in estimates.iter().copied().chain(together.map(|of| of.estimate)) {
        if estimate.robot != last.robot {
            return Err(EstimationError::OtherRobot { first: last.robot.clone(), second: estimate.robot.clone() });
        }
        if estimate.names() != names {
            return Err(EstimationError::OtherBase { found: estimate.names(), expected: names });
        }
    }
    let b = names.len();
    // In units of the last standard deviations, where every covariance has entries of ordinary size.
    let unit = last.std();
    let scaled = |m: &DMatrix<f64>| DMatrix::from_fn(b, b, |i, j| m[(i, j)] / (unit[i] * unit[j]));
    let values: Vec<DVector<f64>> = estimates.iter().map(|of| of.beta().component_div(&unit)).collect();
    let lacks_fit = |of: &Estimate| of.findings.iter().any(|finding| matches!(finding, Finding::LackOfFit { .. }));
    let fits = |of: &Estimate| {
        let shows_nothing = of.interval_basis == IntervalBasis::Scatter;
        together.is_some_and(|all| shows_nothing || (all.do_motions_differ && !lacks_fit(of)))
    };
    let own = |of: &Estimate| if fits(of) { of.noise_covariance_matrix() } else { of.covariance_matrix() };
    let known = estimates.iter().map(|of| definite_inverse(&scaled(&own(of))));
    let known: Vec<DMatrix<f64>> = known.collect::<Option<_>>().ok_or(EstimationError::NotDefinite)?;
    let information = known.iter().fold(DMatrix::zeros(b, b), |sum, of| sum + of);
    let weighted = known.iter().zip(&values).fold(DVector::zeros(b), |sum, (known, value)| sum + known * value);
    let factor = Cholesky::new(information).ok_or(EstimationError::NotDefinite)?;
    let value = factor.solve(&weighted);
    let gains: Vec<DMatrix<f64>> = known.iter().map(|known| factor.solve(known)).collect();

    let (mut noise, mut parts) = (DMatrix::zeros(b, b), Vec::new());
    for (gain, estimate) in gains.iter().zip(estimates) {
        let through = |m: &DMatrix<f64>| product(&product(gain, m), &gain.transpose());
        let by_noise = estimate.noise_covariance_matrix();
        noise += through(&scaled(&by_noise));
        parts.push(through(&scaled(&(own(estimate) - by_noise))));
    }
    let roots: Vec<f64> = parts.iter().map(|part| part.trace().max(0.0).sqrt()).collect();
    let all: f64 = roots.iter().sum();
    let errors = parts.iter().zip(&roots).filter(|(_, root)| **root > 0.0);
    let mut covariance = errors.fold(noise.clone(), |sum, (part, root)| sum + part * (all / root));
    if let Some(all) = together {
        covariance += scaled(&(all.estimate.covariance_matrix() - all.estimate.noise_covariance_matrix()));
    }

    let chi_squared: f64 =
        known.iter().zip(&values).map(|(known, of)| (known * (of - &value)).dot(&(of - &value))).sum();
    let freedom = (b * (estimates.len() - 1)) as f64;
    let differ = freedom > 0.0 && chi_squared > chi_squared_quantile(LEVEL, freedom);
    let widened_by = if differ { (chi_squared / freedom).sqrt() } else { 1.0 };
    covariance *= widened_by * widened_by;

    let back = |m: &DMatrix<f64>| DMatrix::from_fn(b, b, |i, j| m[(i, j)] * unit[i] * unit[j]);
    let motors = gains.iter().zip(estimates).map(|(gain, of)| {
        let shifts = of.motor_errors_matrix();
        let turned = product(gain, &DMatrix::from_fn(b, shifts.ncols(), |i, j| shifts[(i, j)] / unit[i]));
        DMatrix::from_fn(b, shifts.ncols(), |i, j| turned[(i, j)] * unit[i])
    });
    let motors = motors.reduce(|sum, of| if sum.shape() == of.shape() { sum + of } else { sum });
    let degrees_of_freedom = estimates.iter().map(|of| of.degrees_of_freedom).fold(f64::INFINITY, f64::min);
    let t = student_quantile(0.975, degrees_of_freedom);
    let (noise, covariance) = (back(&noise), back(&covariance));
    let base = last.base.iter().enumerate().map(|(i, of)| {
        let (value, std) = (value[i] * unit[i], covariance[(i, i)].max(0.0).sqrt());
        BaseEstimate { value, std, ci95: [value - t * std, value + t * std], ..of.clone() }
    });
    let mut findings = last.findings.clone();
    if let Some(all) = together {
        findings.retain(|finding| !matches!(finding, Finding::EffectShown { .. }));
        let is_new = |finding: &&Finding| match finding {
            Finding::EffectShown { .. } => true,
            Finding::LackOfFit { joint, .. } => {
                !last.findings.iter().any(|of| matches!(of, Finding::LackOfFit { joint: of, .. } if of == joint))
            }
            _ => false,
        };
        findings.extend(all.estimate.findings.iter().filter(is_new).cloned());
    }
    let estimate = Estimate {
        effects: together.map_or_else(Vec::new, |all| all.estimate.effects.clone()),
        findings,
        base: base.collect(),
        noise_covariance: if noise == covariance { Vec::new() } else { symmetric_rows_of(noise) },
        covariance: rows_of(&covariance),
        motor_errors: motors.filter(|of| of.ncols() > 0).as_ref().map(rows_of).unwrap_or_default(),
        servo: Vec::new(),
        standard: None,
        consistent: None,
        degrees_of_freedom,
        periods: estimates.iter().map(|of| of.periods).sum(),
        provenance: None,
        ..last.clone()
    };
    Ok(Pooled { estimate, widened_by })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{BaseReduction, Method, reduce};
    use crate::chains;
    use crate::estimation::payload::fixtures::estimate_of;
    use crate::model::Columns;
    use crate::seed::Seed;
    use rand::RngExt;

    fn base() -> BaseReduction {
        reduce(&chains::planar_2r(), Columns::RIGID, Method::Structural, Seed::new(0)).unwrap()
    }

    fn definite(b: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(91).stream("covariance", run);
        let w = DMatrix::from_fn(4 * b, b, |_, j| rng.random_range(-1.0..1.0) * 10.0_f64.powi(j as i32));
        w.tr_mul(&w).try_inverse().unwrap()
    }

    /// An estimate with an error of the model in addition to its noise.
    fn with_error(value: &DVector<f64>, noise: &DMatrix<f64>, error: &DMatrix<f64>) -> Estimate {
        Estimate { noise_covariance: rows_of(noise), ..estimate_of(&base(), value, &(noise + error)) }
    }

    #[test]
    fn identity_one_motion_repeated_averages_its_noise_and_keeps_its_error() {
        let b = base().rank();
        let (noise, error, value) = (definite(b, 0), definite(b, 1), DVector::from_element(b, 0.3));
        let one = with_error(&value, &noise, &error);
        for k in [1, 2, 5] {
            let found = pool(&vec![&one; k], None).unwrap();
            assert_eq!(found.widened_by, 1.0);
            let expected = &noise / k as f64 + &error;
            let of = found.estimate;
            assert!((of.covariance_matrix() - &expected).norm() < 1e-9 * expected.norm());
            assert!((of.noise_covariance_matrix() - &noise / k as f64).norm() < 1e-9 * noise.norm());
            assert!((of.beta() - &value).amax() < 1e-9);
        }
    }

    #[test]
    fn identity_errors_of_any_correlation_stay_within_the_bound() {
        let b = base().rank();
        let (n1, n2) = (definite(b, 2), definite(b, 3));
        // Shifts by the same unknown number, as of a wrong torque constant: as much alike as two errors can be.
        let mut rng = Seed::new(92).stream("shift", 0);
        let mut shift = || DVector::from_fn(b, |i, _| rng.random_range(-1.0..1.0) * n1[(i, i)].sqrt());
        let (d1, d2) = (shift(), shift());
        let of = |d1: &DVector<f64>, d2: &DVector<f64>| {
            let at = |d: &DVector<f64>, noise: &DMatrix<f64>| with_error(d, noise, &(d * d.transpose()));
            pool(&[&at(d1, &n1), &at(d2, &n2)], None).unwrap().estimate
        };
        for of in [of(&d1, &d2), of(&d1, &-&d2)] {
            let bound = of.covariance_matrix() - of.noise_covariance_matrix();
            for i in 0..b {
                assert!(
                    of.beta()[i].powi(2) <= bound[(i, i)] * (1.0 + 1e-9),
                    "{i}: {} {}",
                    of.beta()[i],
                    bound[(i, i)]
                );
            }
        }
    }

    #[test]
    fn identity_laws_are_as_large_as_all_experiments_together_say() {
        let b = base().rank();
        let (noise, each, all_errors) = (definite(b, 5), definite(b, 6), definite(b, 7));
        let zero = DVector::zeros(b);
        let (one, all) = (with_error(&zero, &noise, &each), with_error(&zero, &noise, &all_errors));
        let found = |one: &Estimate, do_motions_differ| {
            let together = Some(Together { estimate: &all, do_motions_differ });
            pool(&[one, one], together).unwrap().estimate.covariance_matrix()
        };
        let is_near = |found: DMatrix<f64>, expected: DMatrix<f64>| (found - &expected).norm() < 1e-9 * expected.norm();
        let expected = &noise / 2.0 + &all_errors;
        for do_motions_differ in [true, false] {
            assert!(is_near(found(&one, do_motions_differ), expected.clone()));
        }
        // What repeats in one keeps its size where the motion is the same, or the fit lacks.
        let repeats = Estimate { interval_basis: IntervalBasis::Discrepancy, ..one };
        assert!(is_near(found(&repeats, false), &expected + &each));
        assert!(is_near(found(&repeats, true), expected.clone()));
        let lacks = Finding::LackOfFit {
            joint: 1,
            beyond_noise_rms: 1.0,
            noise_rms: 1.0,
            torque_rms: 1.0,
            p_adjusted: 0.01,
            most: None,
            unit: "N·m".to_owned(),
        };
        let lacking = Estimate { findings: vec![lacks], ..repeats };
        assert!(is_near(found(&lacking, true), &expected + &each));
    }

    #[test]
    fn analytic_experiments_that_differ_widen_their_intervals() {
        let b = base().rank();
        let noise = definite(b, 4);
        let at = |shift: f64| estimate_of(&base(), &DVector::from_fn(b, |i, _| shift * noise[(i, i)].sqrt()), &noise);
        let alike = pool(&[&at(0.0), &at(0.1)], None).unwrap();
        assert_eq!(alike.widened_by, 1.0);
        assert!(alike.estimate.noise_covariance.is_empty());
        let apart = pool(&[&at(0.0), &at(20.0)], None).unwrap();
        assert!(apart.widened_by > 5.0);
        let ratio = apart.estimate.std().component_div(&alike.estimate.std());
        assert!((ratio.add_scalar(-apart.widened_by)).amax() < 1e-9 * apart.widened_by);
        assert!(matches!(pool(&[], None), Err(EstimationError::Count { .. })));
        let other = Estimate { robot: "other".to_owned(), ..at(0.0) };
        assert!(matches!(pool(&[&at(0.0), &other], None), Err(EstimationError::OtherRobot { .. })));
    }
}
