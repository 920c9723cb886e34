//! Whether errors of the measured motion bias least squares: the Durbin–Wu–Hausman test.
//!
//! ```text
//! y = W β + V δ + ε        V = W − Z (ZᵀZ)⁻¹ ZᵀW        H₀: δ = 0
//! (RSS_W − RSS_{W,V}) / (RSS_{W,V}/(E − b − r)) ~ χ²_r        r = rank [Z W] − b
//! ```
//! V is the part of the regressor that the instruments do not have. Where it goes with the residual, its errors are in both,
//! and least squares is biased. W and V span what W and Z span, so the second sum of squares is that of a fit by both. A column
//! that Z and W share (an offset) has no part in r. All equations are weighted.
//!
//! Assumes noise that is white in time; correlated noise makes the test reject too often, and so does a model that misses
//! something.
//!
//! Sources: J. A. Hausman, "Specification tests in econometrics", Econometrica 46(6), 1978; A. Janot, P.-O. Vandanjon, M. Gautier,
//! "A Durbin-Wu-Hausman test for industrial robots identification", IEEE ICRA 2013.

use nalgebra::{DMatrix, DVector};

use crate::estimation::finding::Finding;
use crate::linalg::RowFactor;
use crate::statistics::chi_squared_quantile;

/// Length of the part of a column that the others do not have, over its own, below which it counts as none.
const SHARED: f64 = 1e-9;

/// The test with weighted Z, W and y and the weighted sum of squares of the linear fit; `None` where instruments and regressor
/// are the same, or too few equations are left. `largest_change` is handed on.
pub(super) fn durbin_wu_hausman(
    z: &DMatrix<f64>,
    w: &DMatrix<f64>,
    y: &DMatrix<f64>,
    restricted: f64,
    equations: usize,
    largest_change: f64,
) -> Option<Finding> {
    let b = w.ncols();
    let mut factor = RowFactor::new(2 * b + 1);
    factor.add(w.nrows(), |row, c| {
        if c < b {
            z[(row, c)]
        } else if c < 2 * b {
            w[(row, c - b)]
        } else {
            y[(row, 0)]
        }
    });
    let r = factor.finish();
    let below = |c: usize| DVector::from_fn(b + 1, |i, _| r[(b + i, c)]);
    let mut rest = below(2 * b);
    let mut directions: Vec<DVector<f64>> = Vec::new();
    for c in b..2 * b {
        let (mut own, length) = (below(c), r.column(c).norm());
        // Twice, so that what rounding left goes too.
        for _ in 0..2 {
            for direction in &directions {
                own -= direction * direction.dot(&own);
            }
        }
        let left = own.norm();
        if left > SHARED * length {
            let direction = own / left;
            rest -= &direction * direction.dot(&rest);
            directions.push(direction);
        }
    }
    let freedom = directions.len();
    let left = equations.checked_sub(b + freedom).filter(|left| *left > 0 && freedom > 0)?;
    let free = rest.norm_squared();
    if free <= 0.0 {
        return None;
    }
    let statistic = (restricted - free).max(0.0) / (free / left as f64);
    let limit = chi_squared_quantile(0.95, freedom as f64);
    Some(Finding::DurbinWuHausman { statistic, limit, freedom, largest_change: Some(largest_change) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::LeastSquares;
    use crate::seed::Seed;
    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};

    /// Equations with errors of size `error` in the regressor, which the instruments do not have; the last column has none.
    fn case(run: u64, error: f64) -> (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>) {
        let mut rng = Seed::new(7).stream("endogeneity", run);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let z = DMatrix::from_fn(300, 4, |_, j| if j == 3 { 1.0 } else { normal() });
        let beta = DMatrix::from_column_slice(4, 1, &[1.0, -2.0, 0.5, 0.3]);
        let y = &z * beta + DMatrix::from_fn(300, 1, |_, _| 0.1 * normal());
        let w = z.map_with_location(|_, j, x| if j == 3 { x } else { x + error * normal() });
        (z, w, y)
    }

    fn test((z, w, y): &(DMatrix<f64>, DMatrix<f64>, DMatrix<f64>)) -> (f64, f64, usize) {
        let fit = LeastSquares::solve(w, &y.column(0).into_owned()).unwrap();
        let rss = (y.column(0) - w * fit.solution()).norm_squared();
        match durbin_wu_hausman(z, w, y, rss, 300, 0.0) {
            Some(Finding::DurbinWuHausman { statistic, limit, freedom, .. }) => (statistic, limit, freedom),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn identity_the_statistic_is_that_of_the_augmented_regression() {
        let (z, w, y) = case(0, 0.2);
        let (statistic, limit, freedom) = test(&(z.clone(), w.clone(), y.clone()));
        // By its definition, with V from the normal equations.
        let v = &w - &z * (z.tr_mul(&z).try_inverse().unwrap() * z.tr_mul(&w));
        let rss = |x: &DMatrix<f64>| {
            let beta = x.tr_mul(x).try_inverse().unwrap() * x.tr_mul(&y);
            (&y - x * beta).norm_squared()
        };
        let mut both = DMatrix::zeros(300, 7);
        both.columns_mut(0, 4).copy_from(&w);
        both.columns_mut(4, 3).copy_from(&v.columns(0, 3));
        let expected = (rss(&w) - rss(&both)) / (rss(&both) / 293.0);
        assert_eq!(freedom, 3);
        // χ²_3 at 95 %: 7.815.
        assert!((limit - 7.814_727_903).abs() < 1e-6);
        assert!((statistic / expected - 1.0).abs() < 1e-9, "{statistic} {expected}");
    }

    #[test]
    fn analytic_it_rejects_where_the_regressor_has_errors_and_hardly_where_not() {
        let rejected = |error: f64| {
            (0..200)
                .filter(|&run| matches!(test(&case(run, error)), (statistic, limit, _) if statistic > limit))
                .count()
        };
        // Errors of the regressor that are not in y at all: 5 % of 200, standard deviation 3.
        let mut rng = Seed::new(8).stream("harmless", 0);
        let harmless = (0..200)
            .filter(|&run| {
                let (z, w, _) = case(run, 0.2);
                let beta = DMatrix::from_column_slice(4, 1, &[1.0, -2.0, 0.5, 0.3]);
                let y = &w * beta + DMatrix::from_fn(300, 1, |_, _| rng.random_range(-0.1..0.1));
                matches!(test(&(z, w, y)), (statistic, limit, _) if statistic > limit)
            })
            .count();
        assert_eq!(rejected(0.2), 200);
        assert!(harmless < 22, "{harmless}");
        // Nothing to test.
        let (z, _, y) = case(0, 0.0);
        assert!(durbin_wu_hausman(&z, &z, &y, 1.0, 300, 0.0).is_none());
    }
}
