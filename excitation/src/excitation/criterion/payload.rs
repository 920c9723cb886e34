//! D-optimality for a load on the last link.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score, fill_symmetric, singular};
use crate::base::{BaseReduction, LOAD_UNITS};

/// `−ln det(Kᵀ M K)`, with K the columns of the last link that the base shows, each in the natural unit of its parameter.
///
/// Two logs of the motion, without the load and with it, share the parameters β of the arm, its friction and offsets among them:
///
/// ```text
/// y₀ = W β + e₀,  y₁ = W (β + K θ) + e₁        information on (β, θ): [ 2M    MK   ]
///                                                                    [ KᵀM   KᵀMK ]
/// on θ, β being estimated: Kᵀ M K − Kᵀ M (2M)⁻¹ M K = ½ Kᵀ M K
/// d value = tr(S dM)        S = −K (Kᵀ M K)⁻¹ Kᵀ
/// ```
/// This is what the estimate of a load makes of both logs, but for what friction and offsets change between them. K is zero in their rows:
/// the log without the load tells them from its weight.
///
/// Reference: A. C. Atkinson, A. N. Donev, R. D. Tobias, *Optimum Experimental Designs, with SAS*, 2007, section 10.3 (D_S-optimality).
#[derive(Clone, Debug)]
pub struct PayloadOptimal {
    /// K, b × rank.
    k: DMatrix<f64>,
}

impl PayloadOptimal {
    /// For designs on this base; `None` where it shows nothing of a load.
    pub fn of(base: &BaseReduction) -> Option<Self> {
        let (columns, shown) = (base.columns_of_last_link(), base.of_load().kept);
        let k =
            DMatrix::from_fn(base.rank(), shown.len(), |i, j| base.k[(i, columns[shown[j]])] * LOAD_UNITS[shown[j]]);
        (!shown.is_empty()).then_some(Self { k })
    }
}

impl Criterion for PayloadOptimal {
    fn name(&self) -> &'static str {
        "payload"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        // No estimate without full rank.
        let information = m.clone().cholesky().and_then(|_| self.k.tr_mul(&(m * &self.k)).cholesky());
        let Some(information) = information else { return singular(sensitivity) };
        let value = -2.0 * information.l_dirty().diagonal().iter().map(|l| libm::log(*l)).sum::<f64>();
        if let Some(out) = sensitivity {
            fill_symmetric(out, &(&self.k * information.inverse() * self.k.transpose()), 1.0);
        }
        Score::exact(value)
    }

    fn report(&self, value: f64) -> f64 {
        -value
    }

    fn is_larger_better(&self) -> bool {
        true
    }

    fn is_weighted(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::chains;
    use crate::model::Columns;
    use crate::seed::Seed;
    use rand::RngExt;

    fn criterion() -> (BaseReduction, PayloadOptimal) {
        let robot = chains::crs_a460();
        let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
        let criterion = PayloadOptimal::of(&base).unwrap();
        (base, criterion)
    }

    fn information(size: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(71).stream("information", run);
        let w = DMatrix::from_fn(4 * size, size, |_, _| rng.random_range(-1.0..1.0));
        w.tr_mul(&w) / (4 * size) as f64
    }

    /// From the joint information of both logs, b + r unknowns, and the covariance of θ that it has.
    #[test]
    fn identity_the_value_is_that_of_the_load_by_both_logs() {
        let (base, criterion) = criterion();
        let (m, k, b) = (information(base.rank(), 0), &criterion.k, base.rank());
        assert_eq!(k.ncols(), 10);
        let inertial = base.inertial_rows();
        assert!((0..b).filter(|row| !inertial.contains(row)).all(|row| k.row(row).norm() == 0.0));
        let mut joint = DMatrix::zeros(b + 10, b + 10);
        joint.view_mut((0, 0), (b, b)).copy_from(&(&m * 2.0));
        joint.view_mut((0, b), (b, 10)).copy_from(&(&m * k));
        joint.view_mut((b, 0), (10, b)).copy_from(&k.tr_mul(&m));
        joint.view_mut((b, b), (10, 10)).copy_from(&k.tr_mul(&(&m * k)));
        let covariance = joint.lu().try_inverse().unwrap().view((b, b), (10, 10)).into_owned();
        let expected = libm::log(covariance.determinant()) - 10.0 * std::f64::consts::LN_2;
        let value = criterion.evaluate(&m, None).value;
        assert!((value - expected).abs() < 1e-8 * expected.abs(), "{value} {expected}");
        assert!(criterion.report(value) == -value && criterion.is_larger_better());
    }

    #[test]
    fn identity_sensitivity_matches_central_differences() {
        let (base, criterion) = criterion();
        let m = information(base.rank(), 1);
        let mut s = DMatrix::zeros(base.rank(), base.rank());
        criterion.evaluate(&m, Some(&mut s));
        assert!((&s - s.transpose()).norm() == 0.0);
        let mut rng = Seed::new(72).stream("direction", 0);
        let d = DMatrix::from_fn(base.rank(), base.rank(), |_, _| rng.random_range(-1.0..1.0));
        let d = &d + d.transpose();
        let at = |h: f64| criterion.evaluate(&(&m + &d * h), None).value;
        let h = 1e-4;
        let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        let expected = s.component_mul(&d).sum();
        assert!((difference - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{difference} {expected}");
    }

    #[test]
    fn analytic_ten_times_the_information_and_none() {
        let (base, criterion) = criterion();
        let m = information(base.rank(), 2);
        let once = criterion.evaluate(&m, None).value;
        let more = criterion.evaluate(&(&m * 10.0), None).value;
        assert!((once - more - 10.0 * libm::log(10.0)).abs() < 1e-9);
        let mut singular = m;
        singular.row_mut(3).fill(0.0);
        singular.column_mut(3).fill(0.0);
        assert_eq!(criterion.evaluate(&singular, None).value, f64::INFINITY);
        assert_eq!(criterion.report(-3.0), 3.0);
    }
}
