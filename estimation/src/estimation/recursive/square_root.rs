//! Triangular roots of covariances, without the covariances.
//!
//! ```text
//! S Sᵀ = A Aᵀ by a QR of Aᵀ        S' S'ᵀ = S Sᵀ − u uᵀ by rotations
//! ```
//!
//! Reference: G. H. Golub, C. F. Van Loan (2013), sections 5.2 and 6.5.4.

use nalgebra::{DMatrix, DVector};

/// The lower triangular S with `S Sᵀ = A Aᵀ` for A (b × c, c ≥ b), its diagonal not negative.
pub(super) fn root_of(a: &DMatrix<f64>) -> DMatrix<f64> {
    let mut s = a.transpose().qr().r().transpose();
    for j in 0..s.ncols() {
        if s[(j, j)] < 0.0 {
            s.column_mut(j).neg_mut();
        }
    }
    s
}

/// The lower triangular root of `S Sᵀ + variance · 1`.
pub(super) fn walked(s: &DMatrix<f64>, variance: f64) -> DMatrix<f64> {
    let b = s.nrows();
    let std = variance.sqrt();
    root_of(&DMatrix::from_fn(b, 2 * b, |i, j| if j < b { s[(i, j)] } else { std * f64::from(u8::from(i + b == j)) }))
}

/// The lower triangular root of `S Sᵀ − u uᵀ`; `None` where that is not positive definite.
pub(super) fn downdated(mut s: DMatrix<f64>, mut u: DVector<f64>) -> Option<DMatrix<f64>> {
    for k in 0..u.len() {
        let (own, other) = (s[(k, k)], u[k]);
        // (own − other)(own + other) keeps digits where both are nearly equal.
        let square = (own - other) * (own + other);
        // Not positive, or not a number.
        if square.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        let r = square.sqrt();
        let (c, t) = (r / own, other / own);
        s[(k, k)] = r;
        for i in k + 1..u.len() {
            let value = (s[(i, k)] - t * u[i]) / c;
            u[i] = c * u[i] - t * value;
            s[(i, k)] = value;
        }
    }
    Some(s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;

    #[test]
    fn identity_roots_have_the_covariances_that_they_say() {
        let mut rng = Seed::new(98).stream("roots", 0);
        let a = DMatrix::from_fn(5, 9, |_, _| rng.random_range(-1.0..1.0));
        let s = root_of(&a);
        assert!(
            (&s * s.transpose() - &a * a.transpose()).norm() < 1e-13
                && s.upper_triangle().lower_triangle() == DMatrix::from_diagonal(&s.diagonal())
        );
        let more = walked(&s, 0.3);
        assert!((&more * more.transpose() - &a * a.transpose() - DMatrix::identity(5, 5) * 0.3).norm() < 1e-13);
        let u = a.column(0).into_owned();
        let less = downdated(more.clone(), u.clone()).unwrap();
        assert!((&less * less.transpose() - &more * more.transpose() + &u * u.transpose()).norm() < 1e-13);
        assert!(downdated(s, u * 100.0).is_none());
    }
}
