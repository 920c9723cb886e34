//! Where one frame stands in another.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::vectors::{Force, Motion};

/// The pose of a child frame in its parent: `x_parent = R x_child + p`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
pub struct Placement {
    /// Rotation `R`; its columns are the child's axes seen from the parent.
    #[serde(with = "crate::plain::matrix::three")]
    pub rotation: Matrix3<f64>,
    /// Position `p` of the child's origin in the parent, m.
    #[serde(with = "crate::plain::vector")]
    pub translation: Vector3<f64>,
}

/// Largest entry of `RᵀR − 1` of a rotation: rounding of a product of many, and of matrices printed with ten digits.
const ORTHONORMAL: f64 = 1e-9;

// Refuses a matrix that is no rotation.
crate::plain::checked_when_read!(Placement, |value| {
    let fault = "rotation, expected an orthonormal right-handed matrix";
    if value.is_rigid() { Ok(value) } else { Err(fault) }
});

impl Default for Placement {
    fn default() -> Self {
        Self::identity()
    }
}

impl Placement {
    /// Whether it is one of a rigid body: a finite translation, and a rotation whose columns are orthonormal and right-handed.
    pub fn is_rigid(&self) -> bool {
        let off = (self.rotation.tr_mul(&self.rotation) - Matrix3::identity()).amax();
        off <= ORTHONORMAL && self.rotation.determinant() > 0.0 && self.translation.iter().all(|x| x.is_finite())
    }

    /// The child stands on its parent.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// The placement with a rotation matrix and an origin (m).
    pub const fn new(rotation: Matrix3<f64>, translation: Vector3<f64>) -> Self {
        Self { rotation, translation }
    }

    /// A translation by `(x, y, z)` m.
    pub fn translation(x: f64, y: f64, z: f64) -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::new(x, y, z) }
    }

    /// A rotation about x by an angle whose sine and cosine are given, so that right angles can be exact.
    pub fn rotation_x(sin: f64, cos: f64) -> Self {
        Self { rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos), translation: Vector3::zeros() }
    }

    /// A rotation about y by an angle whose sine and cosine are given.
    pub fn rotation_y(sin: f64, cos: f64) -> Self {
        Self { rotation: Matrix3::new(cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos), translation: Vector3::zeros() }
    }

    /// A rotation about z by an angle whose sine and cosine are given.
    pub fn rotation_z(sin: f64, cos: f64) -> Self {
        Self { rotation: Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0), translation: Vector3::zeros() }
    }

    /// The pose of a grandchild: `self` places the child here, `child` places the grandchild in the child.
    #[inline]
    #[must_use]
    pub fn compose(&self, child: &Self) -> Self {
        Self {
            rotation: self.rotation * child.rotation,
            translation: self.rotation * child.translation + self.translation,
        }
    }

    /// The pose of the parent in the child.
    #[inline]
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// A point of the child, seen from the parent.
    #[inline]
    pub fn point(&self, child: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * child + self.translation
    }

    /// A motion given in the parent, expressed in the child: `ω' = Rᵀω`, `v' = Rᵀ(v + ω × p)`.
    #[inline]
    pub fn motion_to_child(&self, motion: &Motion) -> Motion {
        Motion {
            ang: self.rotation.tr_mul(&motion.ang),
            lin: self.rotation.tr_mul(&(motion.lin + motion.ang.cross(&self.translation))),
        }
    }

    /// A force given in the child, expressed in the parent: `f' = R f`, `n' = R n + p × f'`. `radkhah2007` eq. 4.
    #[inline]
    pub fn force_to_parent(&self, force: &Force) -> Force {
        let lin = self.rotation * force.lin;
        Force { ang: self.rotation * force.ang + self.translation.cross(&lin), lin }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Placement {
        let (s, c) = libm::sincos(0.7);
        Placement::rotation_x(s, c)
            .compose(&Placement::rotation_z(c, -s))
            .compose(&Placement::translation(0.1, -0.2, 0.3))
    }

    #[test]
    fn identity_inverse_and_round_trip() {
        let x = sample();
        let one = x.compose(&x.inverse());
        assert!((one.rotation - Matrix3::identity()).norm() < 1e-15 && one.translation.norm() < 1e-15);
        let m = Motion::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(-0.5, 0.2, 0.9));
        let back = x.inverse().motion_to_child(&x.motion_to_child(&m));
        assert!((back.ang - m.ang).norm() < 1e-14 && (back.lin - m.lin).norm() < 1e-14);
    }

    #[test]
    fn identity_power_is_frame_invariant() {
        let x = sample();
        let m = Motion::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(-0.5, 0.2, 0.9));
        let f = Force::new(Vector3::new(0.3, -0.1, 0.8), Vector3::new(1.5, 1.2, -0.9));
        assert!((x.motion_to_child(&m).dot(&f) - m.dot(&x.force_to_parent(&f))).abs() < 1e-13);
    }
}
