//! The wrench on one body as a linear function of its ten parameters.

use nalgebra::SMatrix;

use crate::spatial::Motion;

/// `K(v, a)` with `K φ = I a + v ×* I v`, φ the ten parameters of one body in its frame (Atkeson, An, Hollerbach,
/// "Estimation of inertial parameters of manipulator loads and links", IJRR 5(3), 1986, eq. 12, angular part first).
///
/// ```text
/// K = [ 0   −[b]×             L(α) + [ω]× L(ω) ]      b = a_lin + ω × v_lin
/// K = [ b   [α]× + [ω]×[ω]×   0                ]      L(ω) J = J ω for the six of a symmetric J
/// ```
/// Only what is not zero is stored, by rows.
///
/// ```
/// use armid::regressor::BodyRegressor;
/// use armid::spatial::{Inertia, Motion};
/// use nalgebra::{SVector, Vector3};
/// let phi = [2.0, 0.1, -0.2, 0.3, 0.5, 0.01, -0.02, 0.6, 0.03, 0.7];
/// let v = Motion::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.4, 0.5, 0.6));
/// let a = Motion::new(Vector3::new(-1.0, 2.0, 0.5), Vector3::new(0.7, -0.3, 9.0));
/// let body = Inertia::from_array(&phi);
/// let wrench = body.apply(&a) + v.cross_force(&body.apply(&v));
/// let by_k = BodyRegressor::new(&v, &a).matrix() * SVector::from(phi);
/// assert!((by_k.fixed_rows::<3>(0) - wrench.ang).norm() < 1e-14);
/// assert!((by_k.fixed_rows::<3>(3) - wrench.lin).norm() < 1e-14);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRegressor {
    /// The rows of the moment, all ten columns; the first is zero.
    angular: [[f64; 10]; 3],
    /// The rows of the force, the columns of the mass and the first moment.
    linear: [[f64; 4]; 3],
}

impl BodyRegressor {
    /// For a body with spatial velocity `v` and acceleration `a`, in its own frame.
    #[inline]
    #[must_use]
    pub fn new(v: &Motion, a: &Motion) -> Self {
        let (w, dw) = (&v.ang, &a.ang);
        let b = a.lin + w.cross(&v.lin);
        let (xx, yy, zz) = (w.x * w.x, w.y * w.y, w.z * w.z);
        let (xy, xz, yz) = (w.x * w.y, w.x * w.z, w.y * w.z);
        Self {
            angular: [
                [0.0, 0.0, b.z, -b.y, dw.x, dw.y - xz, dw.z + xy, -yz, yy - zz, yz],
                [0.0, -b.z, 0.0, b.x, xz, dw.x + yz, zz - xx, dw.y, dw.z - xy, -xz],
                [0.0, b.y, -b.x, 0.0, -xy, xx - yy, dw.x - yz, xy, dw.y + xz, dw.z],
            ],
            linear: [
                [b.x, -yy - zz, xy - dw.z, xz + dw.y],
                [b.y, xy + dw.z, -xx - zz, yz - dw.x],
                [b.z, xz - dw.y, yz + dw.x, -xx - yy],
            ],
        }
    }

    /// `sᵀ K`: what the ten parameters contribute to the effort along the axis `s`, given in the body's frame.
    #[inline]
    pub fn project(&self, s: &Motion, out: &mut [f64; 10]) {
        let (n, f) = (&s.ang, &s.lin);
        let ([x, y, z], [u, v, w]) = (&self.angular, &self.linear);
        for c in 0..10 {
            out[c] = n.x * x[c] + n.y * y[c] + n.z * z[c];
        }
        for c in 0..4 {
            out[c] += f.x * u[c] + f.y * v[c] + f.z * w[c];
        }
    }

    /// The whole 6 × 10 matrix, angular rows first.
    #[must_use]
    pub fn matrix(&self) -> SMatrix<f64, 6, 10> {
        SMatrix::from_fn(|r, c| match r {
            0..3 => self.angular[r][c],
            _ => self.linear[r - 3].get(c).copied().unwrap_or(0.0),
        })
    }
}
