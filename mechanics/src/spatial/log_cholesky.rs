//! Ten numbers without constraints for the inertia of one body: the log-Cholesky coordinates of its pseudo-inertia.
//!
//! ```text
//! P = U Uᵀ,   U = eᵅ ⎡ e^d1  s12   s13   t1 ⎤
//!                    ⎢       e^d2  s23   t2 ⎥
//!                    ⎢             e^d3  t3 ⎥
//!                    ⎣                   1  ⎦
//! ```
//! Every value of (α, d1, d2, d3, s12, s23, s13, t1, t2, t3) is a physically consistent body, and every such body has
//! exactly one: m = e^{2α}, and t is the centre of mass. C. Rucker, P. M. Wensing, "Smooth parameterization of
//! rigid-body inertia", IEEE RA-L 7(2), 2022, eq. 15.

use nalgebra::Matrix4;

use super::inertia::{Inertia, InertiaError, PseudoInertia};

/// Log-Cholesky coordinates of a body's inertia: `α, d1, d2, d3, s12, s23, s13, t1, t2, t3`; `t` in m, `d` the
/// logarithm of a length in m.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::spatial::{Inertia, LogCholesky};
/// let body = LogCholesky([0.0, -2.0, -2.5, -1.5, 0.01, 0.0, -0.02, 0.1, 0.0, 0.2]).inertia();
/// assert!(body.check().is_ok() && body.mass == 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogCholesky(pub [f64; 10]);

impl LogCholesky {
    /// The coordinates of an inertia.
    ///
    /// # Errors
    /// [`InertiaError`] where it is physically inconsistent.
    pub fn from_inertia(inertia: &Inertia) -> Result<Self, InertiaError> {
        inertia.check()?;
        let u = upper_factor(&inertia.pseudo().0);
        let scale = u[(3, 3)];
        let v = u / scale;
        Ok(Self([
            libm::log(scale),
            libm::log(v[(0, 0)]),
            libm::log(v[(1, 1)]),
            libm::log(v[(2, 2)]),
            v[(0, 1)],
            v[(1, 2)],
            v[(0, 2)],
            v[(0, 3)],
            v[(1, 3)],
            v[(2, 3)],
        ]))
    }

    /// The inertia with these coordinates.
    pub fn inertia(&self) -> Inertia {
        let u = self.factor();
        PseudoInertia(u * u.transpose()).inertia()
    }

    /// A body that differs by `change`, measured in the body's own size: `U' = U E`, `E` the factor with the
    /// coordinates `change`. Its mass is `m e^{2 δα}`; its centre of mass moves by `L δt`, where `L Lᵀ` is the mass
    /// distribution's covariance, m².
    pub fn moved(&self, change: &Self) -> Inertia {
        let u = self.factor() * change.factor();
        PseudoInertia(u * u.transpose()).inertia()
    }

    /// The upper triangular factor U.
    fn factor(&self) -> Matrix4<f64> {
        let [alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3] = self.0;
        let [d1, d2, d3] = [d1, d2, d3].map(libm::exp);
        Matrix4::new(
            d1, s12, s13, t1, //
            0.0, d2, s23, t2, //
            0.0, 0.0, d3, t3, //
            0.0, 0.0, 0.0, 1.0,
        ) * libm::exp(alpha)
    }
}

/// The upper triangular U with a positive diagonal and `U Uᵀ = P`, column by column from the last.
fn upper_factor(p: &Matrix4<f64>) -> Matrix4<f64> {
    let mut u = Matrix4::zeros();
    for j in (0..4).rev() {
        let tail: f64 = (j + 1..4).map(|k| u[(j, k)] * u[(j, k)]).sum();
        u[(j, j)] = (p[(j, j)] - tail).sqrt();
        for i in 0..j {
            let tail: f64 = (j + 1..4).map(|k| u[(i, k)] * u[(j, k)]).sum();
            u[(i, j)] = (p[(i, j)] - tail) / u[(j, j)];
        }
    }
    u
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    /// Four balls, so that the ten follow from sums over points alone.
    fn balls() -> (Vec<(f64, Vector3<f64>)>, Inertia) {
        let balls = vec![
            (0.5, Vector3::new(0.1, 0.0, -0.1)),
            (1.0, Vector3::new(-0.05, 0.2, 0.3)),
            (0.7, Vector3::new(0.0, -0.1, 0.05)),
            (0.3, Vector3::new(0.15, 0.1, 0.2)),
        ];
        let mut sum = [0.0; 10];
        for (m, c) in &balls {
            let point = Inertia::from_com(*m, *c, Matrix3::zeros()).to_array();
            sum.iter_mut().zip(point).for_each(|(sum, point)| *sum += point);
        }
        (balls, Inertia::from_array(&sum))
    }

    #[test]
    fn identity_round_trip_gives_the_same_ten() {
        let (_, body) = balls();
        let back = LogCholesky::from_inertia(&body).unwrap().inertia();
        // A logarithm, its exponential and a square: a few units in the last place of 2.5 kg.
        for (a, b) in body.to_array().iter().zip(back.to_array()) {
            assert!((a - b).abs() < 5e-15, "{a} against {b}");
        }
    }

    #[test]
    fn analytic_coordinates_are_moments_of_the_mass() {
        let (balls, body) = balls();
        let LogCholesky([alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3]) = LogCholesky::from_inertia(&body).unwrap();
        let mass: f64 = balls.iter().map(|(m, _)| m).sum();
        let com = balls.iter().map(|(m, c)| c * *m).sum::<Vector3<f64>>() / mass;
        assert!((libm::exp(2.0 * alpha) - mass).abs() < 1e-14);
        assert!((Vector3::new(t1, t2, t3) - com).norm() < 1e-14);
        // The covariance of the points, summed directly, is the upper factor times its transpose.
        let covariance = balls.iter().map(|(m, c)| (c - com) * (c - com).transpose() * *m).sum::<Matrix3<f64>>() / mass;
        let l = Matrix3::new(libm::exp(d1), s12, s13, 0.0, libm::exp(d2), s23, 0.0, 0.0, libm::exp(d3));
        assert!((l * l.transpose() - covariance).norm() < 1e-14);
    }

    #[test]
    fn analytic_a_change_scales_mass_and_moves_the_centre_by_the_bodys_size() {
        let (_, body) = balls();
        let own = LogCholesky::from_inertia(&body).unwrap();
        let moved = own.moved(&LogCholesky([0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3]));
        assert!((moved.mass - body.mass * libm::exp(0.2)).abs() < 1e-14);
        // Along the third axis: 0.3 times the last column of L = (s13, s23, e^d3).
        let expected = Vector3::new(own.0[6], own.0[5], libm::exp(own.0[3])) * 0.3;
        assert!((moved.com().unwrap() - body.com().unwrap() - expected).norm() < 1e-14);
        let same = own.moved(&LogCholesky([0.0; 10]));
        assert!(same.to_array().iter().zip(body.to_array()).all(|(a, b)| (a - b).abs() < 5e-15));
    }

    #[test]
    fn what_cannot_exist_has_no_coordinates() {
        let flat = Inertia::from_com(1.0, Vector3::zeros(), Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0)));
        assert!(matches!(LogCholesky::from_inertia(&flat), Err(InertiaError::NotPositiveDefinite { .. })));
    }
}
