//! The wrench on one body as a linear function of its ten parameters.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::dynamics::Symmetric3;
use crate::spatial::{Force, Motion};

/// `K(v, a)` with `K φ = I a + v ×* I v`, φ the ten parameters of one body in its frame (Atkeson, An, Hollerbach,
/// "Estimation of inertial parameters of manipulator loads and links", IJRR 5(3), 1986, eq. 12, angular part first).
///
/// ```text
/// K = [ 0   −[b]×             L(α) + [ω]× L(ω) ]      b = a_lin + ω × v_lin
/// K = [ b   [α]× + [ω]×[ω]×   0                ]      L(ω) J = J ω for the six of a symmetric J
/// ```
/// Only the blocks are stored: `b`, the 3×3 block of the first moment, and the 3×6 block of the rotational inertia.
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
/// let at_once = BodyRegressor::new(&v, &a).wrench(&phi);
/// assert!((at_once.ang - wrench.ang).norm() < 1e-14 && (at_once.lin - wrench.lin).norm() < 1e-14);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRegressor {
    /// Acceleration of the point at the frame's origin, `b = a_lin + ω × v_lin`.
    pub b: Vector3<f64>,
    /// `[α]× + [ω]×[ω]×`: force per first moment.
    pub moment: Matrix3<f64>,
    /// `L(α) + [ω]× L(ω)`: moment per rotational inertia.
    pub inertia: SMatrix<f64, 3, 6>,
}

/// Weights P of the entries of K: rows of the moment, and of the force's first four columns; the rest of K is zero.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Weights {
    moment: [[f64; 10]; 3],
    force: [[f64; 4]; 3],
}

impl Weights {
    /// Adds `s φᵀ`.
    #[inline]
    pub(super) fn add(&mut self, s: &Motion, phi: &[f64; 10]) {
        for r in 0..3 {
            for c in 0..10 {
                self.moment[r][c] += s.ang[r] * phi[c];
            }
            for c in 0..4 {
                self.force[r][c] += s.lin[r] * phi[c];
            }
        }
    }
}

impl BodyRegressor {
    /// For a body with spatial velocity `v` and acceleration `a`, in its own frame.
    #[inline]
    #[must_use]
    pub fn new(v: &Motion, a: &Motion) -> Self {
        let (w, dw) = (&v.ang, &a.ang);
        let (xx, yy, zz) = (w.x * w.x, w.y * w.y, w.z * w.z);
        let (xy, xz, yz) = (w.x * w.y, w.x * w.z, w.y * w.z);
        #[rustfmt::skip]
        let moment = Matrix3::new(
            -yy - zz,    xy - dw.z,   xz + dw.y,
            xy + dw.z,   -xx - zz,    yz - dw.x,
            xz - dw.y,   yz + dw.x,   -xx - yy,
        );
        #[rustfmt::skip]
        let inertia = SMatrix::<f64, 3, 6>::new(
            dw.x,  dw.y - xz,  dw.z + xy,  -yz,   yy - zz,    yz,
            xz,    dw.x + yz,  zz - xx,    dw.y,  dw.z - xy,  -xz,
            -xy,   xx - yy,    dw.x - yz,  xy,    dw.y + xz,  dw.z,
        );
        Self { b: a.lin + w.cross(&v.lin), moment, inertia }
    }

    /// `sᵀ K`: what the ten parameters contribute to the effort along the axis `s`, given in the body's frame.
    #[inline]
    pub fn project(&self, s: &Motion, out: &mut [f64; 10]) {
        let (n, f) = (&s.ang, &s.lin);
        let (b, k) = (&self.b, &self.moment);
        out[0] = b.dot(f);
        let turned = b.cross(n);
        for c in 0..3 {
            out[1 + c] = turned[c] + (k[(0, c)] * f.x + k[(1, c)] * f.y + k[(2, c)] * f.z);
        }
        for c in 0..6 {
            let column = self.inertia.column(c);
            out[4 + c] = column[0] * n.x + column[1] * n.y + column[2] * n.z;
        }
    }

    /// `K φ`: the wrench on a body with these ten parameters.
    #[inline]
    #[must_use]
    pub fn wrench(&self, phi: &[f64; 10]) -> Force {
        let moment = Vector3::new(phi[1], phi[2], phi[3]);
        let rotational = SVector::from_column_slice(&phi[4..]);
        Force { ang: moment.cross(&self.b) + self.inertia * rotational, lin: self.b * phi[0] + self.moment * moment }
    }

    /// Slopes of `L = Σ_rc P_rc K_rc` with respect to `v` and `a`, where `v` is what this was made with.
    ///
    /// K depends on `b`, `α` and `ω` alone, quadratically on the last: `L = b̄·b + ᾱ·α + ωᵀ Q ω`.
    #[inline]
    #[must_use]
    pub(super) fn pull_back(&self, p: &Weights, v: &Motion) -> (Force, Force) {
        let (n, f) = (&p.moment, &p.force);
        let b = Vector3::new(f[0][0] + n[1][3] - n[2][2], f[1][0] + n[2][1] - n[0][3], f[2][0] + n[0][2] - n[1][1]);
        let dw = Vector3::new(
            f[2][2] - f[1][3] + n[0][4] + n[1][5] + n[2][6],
            f[0][3] - f[2][1] + n[0][5] + n[1][7] + n[2][8],
            f[1][1] - f[0][2] + n[0][6] + n[1][8] + n[2][9],
        );
        let (xx, yy, zz) = (n[2][5] - n[1][6], n[0][8] - n[2][5], n[1][6] - n[0][8]);
        let twice = Symmetric3 {
            xx: 2.0 * (xx - f[1][2] - f[2][3]),
            yy: 2.0 * (yy - f[0][1] - f[2][3]),
            zz: 2.0 * (zz - f[0][1] - f[1][2]),
            xy: n[0][6] - n[1][8] - n[2][4] + n[2][7] + f[0][2] + f[1][1],
            xz: n[1][4] - n[0][5] - n[1][9] + n[2][8] + f[0][3] + f[2][1],
            yz: n[0][9] - n[0][7] + n[1][5] - n[2][6] + f[1][3] + f[2][2],
        };
        // b = a_lin + ω × v_lin.
        let by_v = Force { ang: twice.times(&v.ang) + v.lin.cross(&b), lin: b.cross(&v.ang) };
        (by_v, Force { ang: dw, lin: b })
    }

    /// The whole 6 × 10 matrix, angular rows first.
    #[must_use]
    pub fn matrix(&self) -> SMatrix<f64, 6, 10> {
        let mut k = SMatrix::<f64, 6, 10>::zeros();
        k.fixed_view_mut::<3, 3>(0, 1).copy_from(&(-self.b.cross_matrix()));
        k.fixed_view_mut::<3, 6>(0, 4).copy_from(&self.inertia);
        k.fixed_view_mut::<3, 1>(3, 0).copy_from(&self.b);
        k.fixed_view_mut::<3, 3>(3, 1).copy_from(&self.moment);
        k
    }
}
