//! What every criterion is: a value of an information matrix, and its derivative.

use std::fmt;

use nalgebra::DMatrix;

use super::prediction::Prediction;

/// A criterion's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// What is minimised: smooth where the criterion has been smoothed.
    pub value: f64,
    /// The criterion itself, the same where nothing has been smoothed.
    pub exact: f64,
}

impl Score {
    /// A value that nothing has smoothed.
    pub const fn exact(value: f64) -> Self {
        Self { value, exact: value }
    }
}

/// Of information that is not positive definite.
pub(super) fn singular(sensitivity: Option<&mut DMatrix<f64>>) -> Score {
    if let Some(s) = sensitivity {
        s.fill(0.0);
    }
    Score::exact(f64::INFINITY)
}

/// Writes `−½ (A + Aᵀ) / by`, symmetric to the bit.
pub(super) fn fill_symmetric(s: &mut DMatrix<f64>, a: &DMatrix<f64>, by: f64) {
    for j in 0..a.ncols() {
        for i in 0..=j {
            let entry = -0.5 * (a[(i, j)] + a[(j, i)]) / by;
            s[(i, j)] = entry;
            s[(j, i)] = entry;
        }
    }
}

/// A number to be minimised, made from an information matrix.
///
/// The list is [`CriterionKind`](super::CriterionKind); one from outside is used like those of the list. Laws that every
/// criterion obeys are in `conformance::criterion_laws`.
pub trait Criterion: fmt::Debug + Send + Sync {
    /// Its name, as `d-optimal`.
    fn name(&self) -> &str;

    /// Its value for the information `m` (b × b, symmetric), and where `sensitivity` is given (b × b, overwritten)
    /// the symmetric S with `d value = tr(S dM)`. Infinite where M is not positive definite; S is zero there.
    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score;

    /// The reported number, from the value that is minimised: by default that of which it is the logarithm.
    fn report(&self, value: f64) -> f64 {
        libm::exp(value)
    }

    /// Whether the reported number is better the larger it is.
    fn is_larger_better(&self) -> bool {
        false
    }

    /// Whether it is one of the information: the noise of the joints weights its rows, and prior information adds to
    /// it. Others are of W_b itself.
    fn is_weighted(&self) -> bool {
        false
    }

    /// Whether more information never makes it worse.
    fn is_monotone(&self) -> bool {
        self.is_weighted()
    }

    /// This criterion for parameters in these units (b); `None` of a criterion that does not ask.
    fn in_units(&self, units: &[f64]) -> Option<Box<dyn Criterion>> {
        let _ = units;
        None
    }

    /// A smooth stand-in for the optimiser, nowhere below the criterion and the closer to it the larger `sharpness` is;
    /// `None` of a criterion that is smooth itself wherever M is positive definite.
    fn smoothed(&self, sharpness: f64) -> Option<Box<dyn Criterion>> {
        let _ = sharpness;
        None
    }

    /// Whether it asks what the estimate is for.
    fn asks_for_prediction(&self) -> bool {
        false
    }

    /// This criterion for an estimate that is to predict torque; `None` of a criterion that does not ask what it is for.
    fn for_prediction(&self, prediction: Prediction) -> Option<Box<dyn Criterion>> {
        let _ = prediction;
        None
    }

    /// Whether its value depends on effects that the model leaves out.
    fn expects_effects(&self) -> bool {
        false
    }

    /// Whether the estimate is to predict the torque of the arm with these effects, as far as it can.
    fn predicts_measured_torque(&self) -> bool {
        false
    }

    /// Its value where effects are expected, by the moments `c = W_bᵀ Σ⁻¹ d / rows` (b × E) of their torque beside `m`; where
    /// `sensitivity` is given, (S, S_c) with `d value = tr(S dM) + tr(S_cᵀ dc)`. Of a criterion that expects none the same
    /// as [`Self::evaluate`].
    fn evaluate_with_effects(
        &self,
        m: &DMatrix<f64>,
        moments: &DMatrix<f64>,
        sensitivity: Option<(&mut DMatrix<f64>, &mut DMatrix<f64>)>,
    ) -> Score {
        let _ = moments;
        let by_m = sensitivity.map(|(by_m, by_moments)| {
            by_moments.fill(0.0);
            by_m
        });
        self.evaluate(m, by_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::criterion::{Condition, CriterionKind};
    use crate::seed::Seed;
    use rand::RngExt;

    fn information(size: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(21).stream("information", run);
        let w = DMatrix::from_fn(4 * size, size, |_, j| {
            let scale = 1.0 + j as f64;
            rng.random_range(-scale..scale)
        });
        w.tr_mul(&w)
    }

    fn all() -> Vec<Box<dyn Criterion>> {
        let exact = CriterionKind::ALL.map(CriterionKind::criterion);
        let smooth = CriterionKind::ALL.map(CriterionKind::criterion).map(|exact| exact.smoothed(6.0).unwrap_or(exact));
        exact.into_iter().chain(smooth).collect()
    }

    /// The derivative along a direction by fourth-order central differences.
    fn difference(criterion: &dyn Criterion, m: &DMatrix<f64>, d: &DMatrix<f64>, h: f64) -> f64 {
        let at = |h: f64| criterion.evaluate(&(m + d * h), None).value;
        (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
    }

    #[test]
    fn identity_sensitivity_matches_central_differences() {
        for (run, criterion) in all().iter().enumerate() {
            let m = information(7, run as u64);
            let mut s = DMatrix::zeros(7, 7);
            criterion.evaluate(&m, Some(&mut s));
            let mut rng = Seed::new(22).stream("direction", run as u64);
            let d = DMatrix::from_fn(7, 7, |_, _| rng.random_range(-1.0..1.0));
            let d = &d + d.transpose();
            let difference = difference(&**criterion, &m, &d, 1e-3);
            let expected = s.component_mul(&d).sum();
            let size = 1.0 + expected.abs();
            assert!((difference - expected).abs() < 1e-9 * size, "{run}: {expected} {difference}");
            assert!((&s - s.transpose()).norm() < 1e-13 * (1.0 + s.norm()));
        }
    }

    #[test]
    fn identity_smooth_forms_have_a_gradient_where_extreme_eigenvalues_cross() {
        // Along Q diag(1 + t, 1 − t, 3, 9 + t, 9 − t) Qᵀ both extremes cross at t = 0.
        let mut rng = Seed::new(24).stream("turned", 0);
        let q = DMatrix::from_fn(5, 5, |_, _| rng.random_range(-1.0..1.0)).qr().q();
        let turned = |values: [f64; 5]| {
            let m = &q * DMatrix::from_diagonal(&nalgebra::DVector::from_row_slice(&values)) * q.transpose();
            0.5 * (&m + m.transpose())
        };
        let along = turned([1.0, -1.0, 0.0, 1.0, -1.0]);
        let at = |t: f64| turned([1.0 + t, 1.0 - t, 3.0, 9.0 + t, 9.0 - t]);
        for kind in CriterionKind::ALL.into_iter().filter(|kind| kind.criterion().smoothed(1.0).is_some()) {
            let gradient = |criterion: &dyn Criterion, t: f64| {
                let mut s = DMatrix::zeros(5, 5);
                criterion.evaluate(&at(t), Some(&mut s));
                (s.component_mul(&along).sum(), s)
            };
            let smooth = kind.criterion().smoothed(16.0).unwrap();
            for t in [0.0, 1e-9, 1e-5] {
                let (slope, s) = gradient(&*smooth, t);
                let expected = difference(&*smooth, &at(t), &along, 1e-4);
                // Fourth-order differences of a curvature of 16² leave 1e-8.
                assert!((slope - expected).abs() < 1e-7, "{kind:?} at {t}: {slope} {expected}");
                // The gradient itself does not jump, whichever eigenvectors the solver picks at the crossing.
                let (_, before) = gradient(&*smooth, -1e-9);
                assert!((&s - before).norm() < 1e-6 + 1e3 * t, "{kind:?} at {t}");
            }
            // The exact forms have a kink there: their slopes on both sides differ by more than 0.1, except that of the
            // normalised matrix, whose diagonal moves as well.
            let exact = kind.criterion();
            let kink = gradient(&*exact, 1e-6).0 - gradient(&*exact, -1e-6).0;
            assert!(kink.abs() > 0.1 || kind == CriterionKind::ConditionScaled, "{kind:?}: {kink}");
        }
    }

    #[test]
    fn identity_values_are_those_of_the_singular_values() {
        let mut rng = Seed::new(23).stream("stack", 0);
        let w = DMatrix::from_fn(30, 6, |_, j| rng.random_range(-1.0..1.0) * (1.0 + j as f64));
        let m = w.tr_mul(&w);
        let value = |kind: CriterionKind| {
            let criterion = kind.criterion();
            criterion.report(criterion.evaluate(&m, None).value)
        };
        assert!((value(CriterionKind::Condition) / crate::linalg::condition(&w) - 1.0).abs() < 1e-12);
        assert!((value(CriterionKind::ConditionScaled) / crate::linalg::condition_scaled(&w) - 1.0).abs() < 1e-12);
        let log_det: f64 = crate::linalg::singular_values(&w).iter().map(|s| 2.0 * libm::log(*s)).sum();
        assert!((value(CriterionKind::DOptimal) - log_det).abs() < 1e-11);
        let singular = crate::linalg::singular_values(&w);
        let (largest, smallest) = singular.iter().fold((0.0_f64, f64::INFINITY), |(a, b), &s| (a.max(s), b.min(s)));
        let variances: f64 = singular.iter().map(|s| 1.0 / (s * s)).sum();
        assert!((value(CriterionKind::AOptimal) / variances - 1.0).abs() < 1e-12);
        assert!((value(CriterionKind::EOptimal) / (smallest * smallest) - 1.0).abs() < 1e-12);
        let condition = largest / smallest;
        let sum = condition + 1.0 / smallest;
        assert!((value(CriterionKind::ConditionPlusSigma) / sum - 1.0).abs() < 1e-12);
        assert!((value(CriterionKind::ConditionPlusD) - (condition - log_det)).abs() < 1e-10);
    }

    #[test]
    fn analytic_smoothing_bounds_the_condition_from_above() {
        // ½/p (ln Σ λ^p + ln Σ λ^-p) exceeds ln κ by at most ln(b)/p.
        let m = information(8, 50);
        let exact = Condition::default().evaluate(&m, None).value;
        for p in [2.0, 8.0, 64.0] {
            let score = Condition { sharpness: Some(p) }.evaluate(&m, None);
            let smooth = score.value;
            assert!((score.exact - exact).abs() < 1e-15);
            assert!(smooth >= exact && smooth - exact <= libm::log(8.0) / p);
            for kind in [CriterionKind::EOptimal, CriterionKind::ConditionPlusSigma] {
                let score = kind.criterion().smoothed(p).unwrap().evaluate(&m, None);
                assert!((score.exact - kind.criterion().evaluate(&m, None).value).abs() < 1e-14);
                assert!(score.value >= score.exact && score.value - score.exact <= libm::log(8.0) / p, "{kind:?}");
            }
        }
    }

    #[test]
    fn analytic_information_without_full_rank_is_infinitely_bad() {
        let mut m = information(5, 60);
        m.row_mut(2).fill(0.0);
        m.column_mut(2).fill(0.0);
        for criterion in all() {
            assert!(criterion.evaluate(&m, None).value == f64::INFINITY);
        }
    }
}
