//! What every criterion is: a value of an information matrix, and its derivative.

use nalgebra::DMatrix;

use super::CriterionKind;

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
    #[must_use]
    pub const fn exact(value: f64) -> Self {
        Self { value, exact: value }
    }
}

/// A number to be minimised, made from an information matrix.
pub trait Criterion: Send + Sync {
    /// Which one it is.
    fn kind(&self) -> CriterionKind;

    /// Its value for the information `m` (b × b, symmetric), and where `sensitivity` is given (b × b, overwritten)
    /// the symmetric S with `d value = tr(S dM)`. Infinite where M is not positive definite; S is zero there.
    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::criterion::{Condition, ConditionScaled};
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
        let mut all: Vec<Box<dyn Criterion>> = CriterionKind::ALL.map(CriterionKind::criterion).into();
        all.push(Box::new(Condition::smooth(6.0)));
        all.push(Box::new(ConditionScaled::smooth(6.0)));
        all
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
            let h = 1e-4;
            let forward = criterion.evaluate(&(&m + &d * h), None).value;
            let backward = criterion.evaluate(&(&m - &d * h), None).value;
            let difference = (forward - backward) / (2.0 * h);
            let expected = s.component_mul(&d).sum();
            assert!((difference - expected).abs() < 1e-8, "{:?}: {expected} {difference}", criterion.kind());
            assert!((&s - s.transpose()).norm() < 1e-14);
        }
    }

    #[test]
    fn identity_values_are_those_of_the_singular_values() {
        let mut rng = Seed::new(23).stream("stack", 0);
        let w = DMatrix::from_fn(30, 6, |_, j| rng.random_range(-1.0..1.0) * (1.0 + j as f64));
        let m = w.tr_mul(&w);
        let value = |kind: CriterionKind| kind.report(kind.criterion().evaluate(&m, None).value);
        assert!((value(CriterionKind::Condition) / crate::linalg::condition(&w) - 1.0).abs() < 1e-12);
        assert!((value(CriterionKind::ConditionScaled) / crate::linalg::condition_scaled(&w) - 1.0).abs() < 1e-12);
        let log_det: f64 = crate::linalg::singular_values(&w).iter().map(|s| 2.0 * libm::log(*s)).sum();
        assert!((value(CriterionKind::DOptimal) - log_det).abs() < 1e-11);
    }

    #[test]
    fn analytic_smoothing_bounds_the_condition_from_above() {
        // ½/p (ln Σ λ^p + ln Σ λ^-p) exceeds ln κ by at most ln(b)/p.
        let m = information(8, 50);
        let exact = Condition::exact().evaluate(&m, None).value;
        for p in [2.0, 8.0, 64.0] {
            let score = Condition::smooth(p).evaluate(&m, None);
            let smooth = score.value;
            assert!((score.exact - exact).abs() < 1e-15);
            assert!(smooth >= exact && smooth - exact <= libm::log(8.0) / p);
        }
    }

    #[test]
    fn analytic_information_without_full_rank_is_infinitely_bad() {
        let mut m = information(5, 60);
        m.row_mut(2).fill(0.0);
        m.column_mut(2).fill(0.0);
        for criterion in all() {
            assert!(criterion.evaluate(&m, None).value == f64::INFINITY, "{:?}", criterion.kind());
        }
    }
}
