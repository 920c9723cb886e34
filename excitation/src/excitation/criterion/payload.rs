//! D-optimality for a load on the last link.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score, fill_symmetric};
use crate::base::{BaseReduction, LOAD_UNITS};

/// `−ln det(Kᵀ S K)` with S the information on the base parameters of links and rotors, friction and offsets being estimated
/// with them and not asked for:
///
/// ```text
/// M = [ M_RR  M_RF ]      S = M_RR − M_RF M_FF⁻¹ M_FR = ((M⁻¹)_RR)⁻¹      R: links and rotors, F: the others
///     [ M_FR  M_FF ]      β_R changes by K θ
/// d value = tr(S_M dM)    S_M = −Vᵀ (Kᵀ S K)⁻¹ V                          V = Kᵀ [ 1  −M_RF M_FF⁻¹ ]
/// ```
/// `Kᵀ S K` is the information on θ of a log with the load where the links and rotors of the arm are known. Where they come from a log
/// of the same motion without the load, it is half of it, `Kᵀ (2 (M⁻¹)_RR)⁻¹ K`: the design is the same. K are the
/// columns of the last link that the base shows, each in the natural unit of its parameter.
///
/// Reference: A. C. Atkinson, A. N. Donev, R. D. Tobias, *Optimum Experimental Designs, with SAS*, 2007, section 10.3 (D_S-optimality).
#[derive(Clone, Debug)]
pub struct PayloadOptimal {
    /// Places of links and rotors in the base, and of the others.
    rows: [Vec<usize>; 2],
    /// K, R × rank.
    k: DMatrix<f64>,
}

impl PayloadOptimal {
    /// The criterion of designs on this base; `None` where the base shows nothing of a load.
    pub fn new(base: &BaseReduction) -> Option<Self> {
        let (rows, columns) = (base.inertial_rows(), base.columns_of_last_link());
        let shown = base.of_load().kept;
        let others = (0..base.rank()).filter(|row| !rows.contains(row)).collect();
        let k = DMatrix::from_fn(rows.len(), shown.len(), |i, j| {
            base.k[(rows[i], columns[shown[j]])] * LOAD_UNITS[shown[j]]
        });
        (!shown.is_empty()).then_some(Self { rows: [rows, others], k })
    }
}

/// The part of a matrix with these rows and columns.
fn part(m: &DMatrix<f64>, rows: &[usize], columns: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), columns.len(), |i, j| m[(rows[i], columns[j])])
}

impl Criterion for PayloadOptimal {
    fn name(&self) -> &'static str {
        "payload"
    }

    fn evaluate(&self, m: &DMatrix<f64>, mut sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        if let Some(s) = &mut sensitivity {
            s.fill(0.0);
        }
        let [links, others] = &self.rows;
        // No estimate without full rank.
        let (Some(_), Some(factor)) = (m.clone().cholesky(), part(m, others, others).cholesky()) else {
            return Score::exact(f64::INFINITY);
        };
        // B = M_RF M_FF⁻¹, transposed.
        let across = part(m, others, links);
        let b = factor.solve(&across);
        let s = part(m, links, links) - across.tr_mul(&b);
        let Some(information) = self.k.tr_mul(&(s * &self.k)).cholesky() else {
            return Score::exact(f64::INFINITY);
        };
        let value = -2.0 * information.l_dirty().diagonal().iter().map(|l| libm::log(*l)).sum::<f64>();
        if let Some(out) = sensitivity {
            // Vᵀ, b × rank.
            let mut v = DMatrix::zeros(m.nrows(), self.k.ncols());
            let on_others = &b * &self.k;
            for j in 0..self.k.ncols() {
                links.iter().enumerate().for_each(|(i, &row)| v[(row, j)] = self.k[(i, j)]);
                others.iter().enumerate().for_each(|(i, &row)| v[(row, j)] = -on_others[(i, j)]);
            }
            fill_symmetric(out, &(&v * information.inverse() * v.transpose()), 1.0);
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
        let criterion = PayloadOptimal::new(&base).unwrap();
        (base, criterion)
    }

    fn information(size: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(71).stream("information", run);
        let w = DMatrix::from_fn(4 * size, size, |_, _| rng.random_range(-1.0..1.0));
        w.tr_mul(&w) / (4 * size) as f64
    }

    /// The inverse of the block of the inverse: the covariance of the estimate, without any Schur complement.
    #[test]
    fn identity_the_value_is_that_of_the_covariance_of_links_and_rotors() {
        let (base, criterion) = criterion();
        let m = information(base.rank(), 0);
        let rows = base.inertial_rows();
        let covariance = part(&m.clone().try_inverse().unwrap(), &rows, &rows);
        let of_load = criterion.k.tr_mul(&(covariance.try_inverse().unwrap() * &criterion.k));
        assert_eq!(of_load.nrows(), 10);
        let expected = -libm::log(of_load.determinant());
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
