//! Motions and forces: two types, so that neither is ever added to the other.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use nalgebra::Vector3;

/// A spatial motion `(ω, v)`: a velocity, an acceleration or a joint axis. Units rad/s and m/s (or their derivatives).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Angular part.
    pub ang: Vector3<f64>,
    /// Linear part, of the point at the frame's origin.
    pub lin: Vector3<f64>,
}

/// A spatial force `(n, f)`: moment about the frame's origin in N·m, and force in N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force {
    /// Moment about the frame's origin.
    pub ang: Vector3<f64>,
    /// Force.
    pub lin: Vector3<f64>,
}

macro_rules! six_vector {
    ($name:ident) => {
        impl $name {
            /// Six zeros.
            #[must_use]
            pub fn zero() -> Self {
                Self { ang: Vector3::zeros(), lin: Vector3::zeros() }
            }

            /// From the angular and the linear part.
            #[must_use]
            pub const fn new(ang: Vector3<f64>, lin: Vector3<f64>) -> Self {
                Self { ang, lin }
            }
        }

        impl Add for $name {
            type Output = Self;
            #[inline]
            fn add(self, other: Self) -> Self {
                Self { ang: self.ang + other.ang, lin: self.lin + other.lin }
            }
        }

        impl AddAssign for $name {
            #[inline]
            fn add_assign(&mut self, other: Self) {
                self.ang += other.ang;
                self.lin += other.lin;
            }
        }

        impl Sub for $name {
            type Output = Self;
            #[inline]
            fn sub(self, other: Self) -> Self {
                Self { ang: self.ang - other.ang, lin: self.lin - other.lin }
            }
        }

        impl Neg for $name {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self { ang: -self.ang, lin: -self.lin }
            }
        }

        impl Mul<f64> for $name {
            type Output = Self;
            #[inline]
            fn mul(self, factor: f64) -> Self {
                Self { ang: self.ang * factor, lin: self.lin * factor }
            }
        }
    };
}

six_vector!(Motion);
six_vector!(Force);

impl Motion {
    /// `self × other`, the rate of change of `other` when it moves with velocity `self` (Featherstone eq. 2.31).
    #[inline]
    #[must_use]
    pub fn cross(&self, other: &Self) -> Self {
        Self { ang: self.ang.cross(&other.ang), lin: self.ang.cross(&other.lin) + self.lin.cross(&other.ang) }
    }

    /// `self ×* force`, the same for a force (Featherstone eq. 2.32).
    #[inline]
    pub fn cross_force(&self, force: &Force) -> Force {
        Force { ang: self.ang.cross(&force.ang) + self.lin.cross(&force.lin), lin: self.ang.cross(&force.lin) }
    }

    /// Power of a force along this motion: `ω·n + v·f`.
    #[inline]
    pub fn dot(&self, force: &Force) -> f64 {
        self.ang.dot(&force.ang) + self.lin.dot(&force.lin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_cross_products_are_adjoint() {
        // (v × m)·f = −m·(v ×* f): power is frame invariant.
        let v = Motion::new(Vector3::new(0.3, -1.0, 2.0), Vector3::new(0.7, 0.1, -0.4));
        let m = Motion::new(Vector3::new(-0.2, 0.5, 1.1), Vector3::new(1.3, -0.6, 0.2));
        let f = Force::new(Vector3::new(0.9, 0.8, -0.7), Vector3::new(-1.2, 0.4, 0.6));
        assert!((v.cross(&m).dot(&f) + m.dot(&v.cross_force(&f))).abs() < 1e-15);
    }
}
