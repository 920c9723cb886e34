//! What every criterion of an information matrix obeys.
//!
//! ```text
//! d f = tr(S dM),  S = Sᵀ        f(P M Pᵀ) = f(M)        f = ∞ and S = 0 where M is not positive definite
//! ```
//! - S is the gradient, by central differences along random directions;
//! - asking for S does not change the value, and the exact value is never above the smoothed one;
//! - the order of the parameters does not count, and beyond that what the criterion declares ([`Invariance`]);
//! - the reported number is better where the value is lower;
//! - a monotone criterion never gets worse by more information: `f(M + v vᵀ) ≤ f(M)`.

use nalgebra::DMatrix;
use rand::RngExt;

use super::law_error::LawError;
use crate::excitation::criterion::Criterion;
use crate::seed::{Seed, Stream};

/// Which change of parameters moves a criterion by one constant, for any information.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invariance {
    /// Their order alone.
    Order,
    /// Their units as well.
    Units,
    /// Any choice of parameters that stand for the base.
    Base,
}

/// Size of the matrices.
const SIZE: usize = 6;

/// Random matrices that each law is looked at on.
const RUNS: u64 = 8;

/// Checks one criterion, exact or smoothed.
///
/// ```
/// use armid::conformance::criterion_laws::{self, Invariance};
/// use armid::excitation::criterion::DOptimal;
/// criterion_laws::check(&DOptimal, Invariance::Base).unwrap();
/// ```
///
/// # Errors
/// [`LawError`]: the first law that does not hold, with what was found.
pub fn check(criterion: &dyn Criterion, invariance: Invariance) -> Result<(), LawError> {
    LawError::unless("a criterion has a name", !criterion.name().is_empty(), "none", "one")?;
    for run in 0..RUNS {
        let mut rng = Seed::new(41).stream("criterion laws", run);
        gradient(criterion, &mut rng)?;
        invariances(criterion, invariance, &mut rng)?;
        if criterion.is_monotone() {
            more_information(criterion, &mut rng)?;
        }
    }
    singular(criterion)?;
    let better = criterion.report(1.0) - criterion.report(2.0);
    LawError::unless(
        "the number that people read is better where the value is lower",
        if criterion.is_larger_better() { better > 0.0 } else { better < 0.0 },
        format!("{} at 1 and {} at 2", criterion.report(1.0), criterion.report(2.0)),
        if criterion.is_larger_better() { "the larger first" } else { "the smaller first" },
    )
}

/// A well-conditioned information matrix with eigenvalues that lie apart, as kinks lie where they meet.
fn information(rng: &mut Stream) -> DMatrix<f64> {
    let q = DMatrix::from_fn(SIZE, SIZE, |_, _| rng.random_range(-1.0..1.0)).qr().q();
    let values =
        DMatrix::from_fn(SIZE, SIZE, |i, j| if i == j { (1.0 + i as f64) * rng.random_range(0.95..1.05) } else { 0.0 });
    let m = &q * values * q.transpose();
    0.5 * (&m + m.transpose())
}

fn value(criterion: &dyn Criterion, m: &DMatrix<f64>) -> f64 {
    criterion.evaluate(m, None).value
}

fn gradient(criterion: &dyn Criterion, rng: &mut Stream) -> Result<(), LawError> {
    let m = information(rng);
    let mut s = DMatrix::zeros(SIZE, SIZE);
    let score = criterion.evaluate(&m, Some(&mut s));
    let alone = criterion.evaluate(&m, None);
    let size = 1.0 + score.value.abs();
    LawError::unless_at_most(
        "the value is the same with its gradient",
        (score.value - alone.value).abs(),
        1e-12 * size,
    )?;
    LawError::unless_at_most("smoothing bounds from above", score.exact - score.value, 1e-12 * size)?;
    LawError::unless_at_most("the gradient is symmetric", (&s - s.transpose()).norm(), 1e-12 * (1.0 + s.norm()))?;
    let d = DMatrix::from_fn(SIZE, SIZE, |_, _| rng.random_range(-1.0..1.0));
    let d = &d + d.transpose();
    // Fourth-order differences: h⁴/30 of a fifth derivative of 1e6, where the largest eigenvalues lie 0.4 apart.
    let at = |h: f64| value(criterion, &(&m + &d * h));
    let h = 2e-4;
    let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
    let expected = s.component_mul(&d).sum();
    LawError::unless_at_most(
        "the gradient is that of central differences",
        (difference - expected).abs(),
        1e-6 * (1.0 + expected.abs()),
    )
}

fn invariances(criterion: &dyn Criterion, invariance: Invariance, rng: &mut Stream) -> Result<(), LawError> {
    let (m, other) = (information(rng), information(rng));
    // A cycle of all parameters.
    let order = DMatrix::from_fn(SIZE, SIZE, |i, j| if (i + 1) % SIZE == j { 1.0 } else { 0.0 });
    let units = DMatrix::from_fn(SIZE, SIZE, |i, j| if i == j { rng.random_range(0.5..2.0) } else { 0.0 });
    let base = DMatrix::from_fn(SIZE, SIZE, |i, j| f64::from(u8::from(i == j)) + 0.2 * rng.random_range(-1.0..1.0));
    let moved = |m: &DMatrix<f64>, t: &DMatrix<f64>| {
        let turned = t.transpose() * m * t;
        value(criterion, &(0.5 * (&turned + turned.transpose()))) - value(criterion, m)
    };
    LawError::unless_at_most("the order of the parameters does not count", moved(&m, &order).abs(), 1e-10)?;
    let constant = |law, t: &DMatrix<f64>| LawError::unless_at_most(law, (moved(&m, t) - moved(&other, t)).abs(), 1e-9);
    if invariance != Invariance::Order {
        constant("other units move every value by one constant", &units)?;
    }
    if invariance == Invariance::Base {
        constant("another base moves every value by one constant", &base)?;
    }
    Ok(())
}

fn more_information(criterion: &dyn Criterion, rng: &mut Stream) -> Result<(), LawError> {
    let m = information(rng);
    let v = DMatrix::from_fn(SIZE, 1, |_, _| rng.random_range(-1.0..1.0));
    let worse = value(criterion, &(&m + &v * v.transpose())) - value(criterion, &m);
    LawError::unless_at_most("more information is never worse", worse, 1e-12)
}

fn singular(criterion: &dyn Criterion) -> Result<(), LawError> {
    let mut m = DMatrix::identity(SIZE, SIZE);
    m[(2, 2)] = 0.0;
    let mut s = DMatrix::from_element(SIZE, SIZE, 1.0);
    let score = criterion.evaluate(&m, Some(&mut s));
    let law = "information that leaves a parameter unknown is infinitely bad, with no gradient";
    let found = format!("{} with a gradient of size {}", score.value, s.norm());
    LawError::unless(law, score.value == f64::INFINITY && s.norm() == 0.0, found, "inf with a gradient of size 0")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::CriterionKind;
    use crate::excitation::criterion::{DOptimal, IOptimal, Score};

    #[test]
    fn every_criterion_obeys_the_laws() {
        for kind in CriterionKind::ALL {
            let invariance = match kind {
                CriterionKind::DOptimal => Invariance::Base,
                CriterionKind::ConditionScaled => Invariance::Units,
                CriterionKind::Condition
                | CriterionKind::AOptimal
                | CriterionKind::EOptimal
                | CriterionKind::ConditionPlusSigma
                | CriterionKind::ConditionPlusD
                | CriterionKind::IOptimal
                | CriterionKind::ModelError
                | CriterionKind::MeasuredTorque
                | CriterionKind::ConditionInUnits => Invariance::Order,
            };
            for criterion in [Some(kind.criterion()), kind.criterion().smoothed(8.0)].into_iter().flatten() {
                check(&*criterion, invariance).unwrap_or_else(|broken| panic!("{kind:?}: {broken}"));
            }
        }
    }

    #[test]
    fn i_optimality_obeys_the_laws_for_a_prediction_that_treats_all_parameters_alike() {
        let gram = DMatrix::from_fn(6, 6, |i, j| if i == j { 2.0 } else { 0.5 });
        check(&IOptimal::new(gram), Invariance::Order).unwrap();
    }

    /// D-optimality with one thing wrong.
    #[derive(Debug)]
    struct Broken(fn(f64) -> f64, f64);

    impl Criterion for Broken {
        fn name(&self) -> &'static str {
            "broken"
        }

        fn evaluate(&self, m: &DMatrix<f64>, mut sensitivity: Option<&mut DMatrix<f64>>) -> Score {
            let Score { value, exact } = DOptimal.evaluate(m, sensitivity.as_deref_mut());
            if let Some(s) = sensitivity {
                *s *= self.1;
            }
            Score { value: self.0(value), exact: self.0(exact) }
        }

        fn is_weighted(&self) -> bool {
            true
        }

        fn report(&self, value: f64) -> f64 {
            value
        }
    }

    #[test]
    fn a_broken_criterion_is_found() {
        assert_eq!(check(&Broken(|value| value, 1.0), Invariance::Base), Ok(()));
        let law = |criterion: Broken| check(&criterion, Invariance::Base).unwrap_err().law;
        assert!(law(Broken(|value| value, 1.01)).contains("central differences"));
        assert!(law(Broken(|value| -value, -1.0)).contains("more information"));
        assert!(check(&*CriterionKind::AOptimal.criterion(), Invariance::Units).is_err());
    }
}
