//! Linear least squares with the factors of the covariance.
//!
//! ```text
//! min ‖y − W β‖        [W D⁻¹, y] = Q [R, z], D = diag(‖w_j‖)        β̂ = D⁻¹ R⁻¹ z
//! (WᵀW)⁻¹ = D⁻¹ R⁻¹ R⁻ᵀ D⁻¹        cov β̂ = (WᵀW)⁻¹ Wᵀ C W (WᵀW)⁻¹   for cov y = C
//! ```
//! Householder QR ([`RowFactor`], block of rows by block of rows): the error of β̂ grows with the condition number and not,
//! as with normal equations, with its square. Weights come in by [`super::BlockWhitening`].
//!
//! Reference: Å. Björck, *Numerical Methods for Least Squares Problems*, SIAM 1996, ch. 2.

use nalgebra::{DMatrix, DVector};

use super::condition::condition;
use super::product::product;
use super::row_factor::RowFactor;
use super::tolerance::RankTolerance;
use super::triangular::solve_upper;

/// Why a least-squares problem has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum LeastSquaresError {
    /// Fewer equations than unknowns.
    #[error("{rows} equations for {columns} unknowns, expected at least as many equations as unknowns")]
    TooFewRows { rows: usize, columns: usize },
    /// Matrix and right-hand side do not fit.
    #[error("{found} measurements for {expected} equations, expected one each")]
    Shape { found: usize, expected: usize },
    /// A NaN or an infinity among the equations.
    #[error("equation {row} holds {value}, expected finite numbers")]
    NotFinite { row: usize, value: f64 },
    /// A column is a combination of those before it.
    #[error(
        "column {column} has {independent:.1e} of its length independent of the columns before it, expected more than {least:.1e}"
    )]
    Dependent { column: usize, independent: f64, least: f64 },
    /// The covariance of a block is not positive definite.
    #[error("the {size} × {size} covariance of one sample is not positive definite")]
    Covariance { size: usize },
    /// Rows do not divide into blocks.
    #[error("{rows} rows, expected a multiple of the {size} rows in one sample")]
    Blocks { rows: usize, size: usize },
}

/// The solution of a least-squares problem, and the factor that its covariance is made of.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::LeastSquares;
/// use nalgebra::{dmatrix, dvector};
/// // A straight line through (0, 1), (1, 3), (2, 5).
/// let fit = LeastSquares::solve(&dmatrix![1.0, 0.0; 1.0, 1.0; 1.0, 2.0], &dvector![1.0, 3.0, 5.0])?;
/// assert!((fit.solution() - dvector![1.0, 2.0]).norm() < 1e-14);
/// assert!((fit.inverse_information()[(1, 1)] - 0.5).abs() < 1e-15);
/// # Ok::<(), armid::linalg::LeastSquaresError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSquares {
    solution: DVector<f64>,
    /// L and R of `A⁻¹ = L Rᵀ`; by [`LeastSquares::solve`] both are R⁻¹ of the scaled problem, with the scales divided out
    /// of its rows: D⁻¹ R⁻¹.
    left: DMatrix<f64>,
    right: DMatrix<f64>,
    conditions: Conditions,
}

/// Condition numbers. Those of a factor are found when they are asked for, since few fits are.
#[derive(Clone, Debug, PartialEq)]
enum Conditions {
    /// As it stands, and with columns of unit length.
    Known(f64, f64),
    /// Of `R D`, where columns of R have unit length.
    Factor { r: DMatrix<f64>, scales: Vec<f64> },
}

impl LeastSquares {
    /// Solves `min ‖y − W β‖` for W (m × b) and y (m).
    ///
    /// # Errors
    /// [`LeastSquaresError`] where shapes do not fit, a number is not finite or a column depends on others.
    pub fn solve(w: &DMatrix<f64>, y: &DVector<f64>) -> Result<Self, LeastSquaresError> {
        let (rows, columns) = w.shape();
        if y.len() != rows {
            return Err(LeastSquaresError::Shape { found: y.len(), expected: rows });
        }
        if rows < columns {
            return Err(LeastSquaresError::TooFewRows { rows, columns });
        }
        let bad = w.iter().position(|v| !v.is_finite()).map(|at| (at % rows, w[at]));
        if let Some((row, value)) = bad.or_else(|| y.iter().position(|v| !v.is_finite()).map(|row| (row, y[row]))) {
            return Err(LeastSquaresError::NotFinite { row, value });
        }
        let mut factor = RowFactor::new(columns + 1);
        factor.add(rows, |row, column| if column < columns { w[(row, column)] } else { y[row] });
        Self::from_triangle(&factor.finish())
    }

    /// The solution from the triangular factor of the equations with their measurements as the last column, by which all of
    /// them are known:
    ///
    /// ```text
    /// [W y] = Q [ R  z ]        β̂ = R⁻¹ z        ‖y − W β̂‖ = |ρ|
    ///           [ 0  ρ ]
    /// ```
    /// # Errors
    /// [`LeastSquaresError::Dependent`] where a column depends on those before it, [`LeastSquaresError::NotFinite`] where a
    /// number of the factor is not finite.
    pub fn from_triangle(factor: &DMatrix<f64>) -> Result<Self, LeastSquaresError> {
        let columns = factor.ncols().saturating_sub(1);
        if let Some(at) = factor.iter().position(|value| !value.is_finite()) {
            return Err(LeastSquaresError::NotFinite { row: at % factor.nrows(), value: factor[at] });
        }
        // Lengths of the columns of W are those of the columns of R.
        let scales: Vec<f64> = (0..columns).map(|j| factor.view((0, j), (j + 1, 1)).norm()).collect();
        let r = DMatrix::from_fn(columns, columns, |i, j| {
            if i <= j && scales[j] > 0.0 { factor[(i, j)] / scales[j] } else { 0.0 }
        });
        let least = RankTolerance::default().independent;
        if let Some(column) = (0..columns).find(|&j| r[(j, j)].abs() <= least) {
            return Err(LeastSquaresError::Dependent { column, independent: r[(column, column)].abs(), least });
        }
        let mut solution = solve_upper(&r, &factor.view((0, columns), (columns, 1)).column(0).into_owned());
        let mut root = inverse_upper(&r);
        for (j, &scale) in scales.iter().enumerate() {
            solution[j] /= scale;
            root.row_mut(j).unscale_mut(scale);
        }
        Ok(Self { solution, right: root.clone(), left: root, conditions: Conditions::Factor { r, scales } })
    }

    /// A solution that was found another way: by an iteration, by total least squares, with instruments.
    ///
    /// ```text
    /// β̂ − β = A⁻¹ Bᵀ ε        A⁻¹ = L Rᵀ        to first order in the noise ε of y
    /// ```
    /// Least squares has `A = WᵀW, B = W`; weighted least squares `A = WᵀPW, B = PW`; instruments Z have `A = ZᵀW, B = Z`. L
    /// and R (b × b) are any factors of A⁻¹: the inverse itself and the identity, say. The condition numbers are those of the
    /// matrix that was solved with, as it stands and with columns of unit length.
    ///
    /// # Errors
    /// [`LeastSquaresError::Shape`] where a factor is not b × b, [`LeastSquaresError::NotFinite`] where a number of the solution
    /// is not finite.
    pub fn from_factors(
        solution: DVector<f64>,
        [left, right]: [DMatrix<f64>; 2],
        condition: f64,
        condition_scaled: f64,
    ) -> Result<Self, LeastSquaresError> {
        let b = solution.len();
        for factor in [&left, &right] {
            if factor.shape() != (b, b) {
                return Err(LeastSquaresError::Shape { found: factor.len(), expected: b * b });
            }
        }
        if let Some(row) = solution.iter().position(|value| !value.is_finite()) {
            return Err(LeastSquaresError::NotFinite { row, value: solution[row] });
        }
        Ok(Self { solution, left, right, conditions: Conditions::Known(condition, condition_scaled) })
    }

    /// Another solution of the same equations with an A⁻¹ of its own, by [`LeastSquares::from_factors`]. The condition numbers stay.
    ///
    /// # Errors
    /// As [`LeastSquares::from_factors`].
    pub fn with_solution(
        &self,
        solution: DVector<f64>,
        inverse_information: DMatrix<f64>,
    ) -> Result<Self, LeastSquaresError> {
        let unit = DMatrix::identity(solution.len(), solution.len());
        let other = Self::from_factors(solution, [inverse_information, unit], 1.0, 1.0)?;
        Ok(Self { conditions: self.conditions.clone(), ..other })
    }

    /// β̂, length b.
    pub const fn solution(&self) -> &DVector<f64> {
        &self.solution
    }

    /// Condition number of W as it stands.
    pub fn condition(&self) -> f64 {
        match &self.conditions {
            Conditions::Known(condition, _) => *condition,
            Conditions::Factor { r, scales } => {
                condition(&DMatrix::from_fn(r.nrows(), r.ncols(), |i, j| r[(i, j)] * scales[j]))
            }
        }
    }

    /// Condition number of W with columns of unit length.
    pub fn condition_scaled(&self) -> f64 {
        match &self.conditions {
            Conditions::Known(_, scaled) => *scaled,
            Conditions::Factor { r, .. } => condition(r),
        }
    }

    /// `(WᵀW)⁻¹`, or A⁻¹, b × b: the covariance of β̂ by [`LeastSquares::solve`] where y has unit covariance.
    pub fn inverse_information(&self) -> DMatrix<f64> {
        product(&self.left, &self.right.transpose())
    }

    /// `A⁻¹ V` for V of b rows: how far β̂ moves where `V = Bᵀ δy`.
    pub fn moved_by(&self, v: &DMatrix<f64>) -> DMatrix<f64> {
        product(&self.left, &product(&self.right.transpose(), v))
    }

    /// `A⁻¹ V A⁻ᵀ` for a symmetric V (b × b): the covariance of β̂ where `V = Bᵀ (cov y) B`.
    pub fn sandwich(&self, v: &DMatrix<f64>) -> DMatrix<f64> {
        let middle = product(&product(&self.right.transpose(), v), &self.right);
        product(&product(&self.left, &middle), &self.left.transpose())
    }
}

/// Inverse of an upper triangular matrix without zeros on its diagonal.
fn inverse_upper(r: &DMatrix<f64>) -> DMatrix<f64> {
    let b = r.ncols();
    // Columns are rows of the inverse, so that all of a row are found together.
    let mut rows = DMatrix::identity(b, b);
    for i in (0..b).rev() {
        let (before, own) = rows.as_mut_slice()[..].split_at_mut((i + 1) * b);
        let row = &mut before[i * b..];
        for (k, below) in (i + 1..b).zip(own.chunks_exact(b)) {
            let size = r[(i, k)];
            row[k..].iter_mut().zip(&below[k..]).for_each(|(entry, below)| *entry -= size * below);
        }
        row[i..].iter_mut().for_each(|entry| *entry /= r[(i, i)]);
    }
    rows.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::transpose_product;
    use crate::seed::Seed;
    use rand::RngExt;

    fn random(rows: usize, columns: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(2).stream("least squares", run);
        DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0))
    }

    #[test]
    fn identity_solution_and_covariance_agree_with_the_singular_value_decomposition() {
        let mut w = random(60, 7, 0);
        // Columns of very different size, as masses and friction coefficients are.
        for (j, mut column) in w.column_iter_mut().enumerate() {
            column *= libm::pow(10.0, j as f64 - 3.0);
        }
        let y = random(60, 1, 1).column(0).into_owned();
        let fit = LeastSquares::solve(&w, &y).unwrap();
        let inverse = w.clone().pseudo_inverse(1e-14).unwrap();
        let expected = &inverse * &y;
        let covariance = &inverse * inverse.transpose();
        for i in 0..7 {
            // Both routes lose the condition number, 1e6, of 1e-16.
            assert!((fit.solution()[i] / expected[i] - 1.0).abs() < 1e-9);
            for j in 0..7 {
                let size = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
                assert!((fit.inverse_information()[(i, j)] - covariance[(i, j)]).abs() < 1e-9 * size);
            }
        }
        let c = random(60, 60, 2);
        let c = &c * c.transpose();
        let sandwich = fit.sandwich(&transpose_product(&w, &(&c * &w)));
        let expected = &inverse * c * inverse.transpose();
        for i in 0..7 {
            for j in 0..7 {
                let size = (expected[(i, i)] * expected[(j, j)]).sqrt();
                assert!((sandwich[(i, j)] - expected[(i, j)]).abs() < 1e-8 * size);
            }
        }
        let singular = w.singular_values();
        assert!((fit.condition() / (singular.max() / singular.min()) - 1.0).abs() < 1e-8);
        assert!(fit.condition_scaled() < 3.0, "unit columns of a random matrix");
    }

    #[test]
    fn impossible_problems_are_refused() {
        let mut w = random(6, 3, 8);
        let y = DVector::zeros(6);
        w.set_column(2, &(w.column(0) * 2.0 - w.column(1)));
        assert!(matches!(LeastSquares::solve(&w, &y), Err(LeastSquaresError::Dependent { column: 2, .. })));
        w[(4, 1)] = f64::NAN;
        assert!(matches!(LeastSquares::solve(&w, &y), Err(LeastSquaresError::NotFinite { row: 4, .. })));
        assert!(matches!(
            LeastSquares::solve(&random(2, 3, 9), &DVector::zeros(2)),
            Err(LeastSquaresError::TooFewRows { rows: 2, columns: 3 })
        ));
        assert!(matches!(
            LeastSquares::solve(&random(4, 3, 9), &DVector::zeros(2)),
            Err(LeastSquaresError::Shape { found: 2, expected: 4 })
        ));
    }
    #[test]
    fn identity_factors_of_another_kind_give_the_same_covariance() {
        let (w, y) = (random(40, 4, 3), random(40, 1, 4).column(0).into_owned());
        let fit = LeastSquares::solve(&w, &y).unwrap();
        let factors = [fit.inverse_information(), DMatrix::identity(4, 4)];
        let other = LeastSquares::from_factors(fit.solution().clone(), factors, 1.0, 1.0).unwrap();
        let v = random(4, 4, 5);
        let v = &v * v.transpose();
        assert!((fit.sandwich(&v) - other.sandwich(&v)).norm() < 1e-14 * fit.sandwich(&v).norm());
        assert!((fit.inverse_information() - other.inverse_information()).norm() < 1e-16);
        let wrong = LeastSquares::from_factors(y, [DMatrix::identity(4, 4), DMatrix::identity(4, 4)], 1.0, 1.0);
        assert!(matches!(wrong, Err(LeastSquaresError::Shape { found: 16, expected: 1600 })));
    }
}
