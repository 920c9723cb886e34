//! The ten inertial parameters of one body, and the test of their physical consistency.

use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector3};

use super::vectors::{Force, Motion};

/// Inertia of one body about the origin of its frame: mass, first moment, rotational inertia.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::spatial::Inertia;
/// use nalgebra::{Matrix3, Vector3};
/// let ball = Inertia::from_com(2.0, Vector3::new(0.0, 0.0, 0.5), Matrix3::from_diagonal_element(0.01));
/// assert_eq!(ball.to_array(), [2.0, 0.0, 0.0, 1.0, 0.51, 0.0, 0.0, 0.51, 0.0, 0.01]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Mass `m`, kg.
    pub mass: f64,
    /// First moment `m c`, kg·m.
    pub first_moment: Vector3<f64>,
    /// Rotational inertia about the frame's origin, kg·m²; symmetric.
    pub rotational: Matrix3<f64>,
}

/// Why these ten parameters are physically inconsistent.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum InertiaError {
    /// A parameter is NaN or infinite.
    #[error("parameter {index} of the ten is {value}, expected a finite number")]
    NotFinite { index: usize, value: f64 },
    /// The 4×4 pseudo-inertia has an eigenvalue that is not positive.
    #[error("its pseudo-inertia has the eigenvalue {eigenvalue:.3e}, expected all four above zero")]
    NotPositiveDefinite { eigenvalue: f64 },
}

impl std::ops::AddAssign for Inertia {
    fn add_assign(&mut self, other: Self) {
        self.mass += other.mass;
        self.first_moment += other.first_moment;
        self.rotational += other.rotational;
    }
}

impl Inertia {
    /// No body at all.
    pub fn zero() -> Self {
        Self { mass: 0.0, first_moment: Vector3::zeros(), rotational: Matrix3::zeros() }
    }

    /// The inertia of a mass, its centre and the inertia about that centre (Steiner): `I = I_c + m (cᵀc 1 − c cᵀ)`.
    pub fn from_com(mass: f64, com: Vector3<f64>, about_com: Matrix3<f64>) -> Self {
        let steiner = (Matrix3::from_diagonal_element(com.norm_squared()) - com * com.transpose()) * mass;
        Self { mass, first_moment: com * mass, rotational: about_com + steiner }
    }

    /// The inertia of a mass (kg) with its centre (m) and one radius of gyration (m) about every axis through it, as of a ball.
    pub fn with_gyration(mass: f64, com: [f64; 3], radius: f64) -> Self {
        Self::from_com(mass, Vector3::from(com), Matrix3::from_diagonal_element(mass * radius * radius))
    }

    /// The inertia of a mass (kg) with its centre (m) and the inertia matrix about it as `xx, yy, zz, xy, xz, yz` (kg·m²).
    ///
    /// ```
    /// # use armid_mechanics as armid;
    /// use armid::spatial::Inertia;
    /// let body = Inertia::with_moments(2.0, [0.0, 0.0, 0.5], [0.01, 0.02, 0.03, 0.001, 0.0, 0.0]);
    /// assert_eq!(body.to_array(), [2.0, 0.0, 0.0, 1.0, 0.51, 0.001, 0.0, 0.52, 0.0, 0.03]);
    /// ```
    pub fn with_moments(mass: f64, com: [f64; 3], [xx, yy, zz, xy, xz, yz]: [f64; 6]) -> Self {
        Self::from_com(mass, Vector3::from(com), Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
    }

    /// The ten in the order of `NOTATION.md`: `m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz`.
    pub fn to_array(&self) -> [f64; 10] {
        let (h, i) = (&self.first_moment, &self.rotational);
        [self.mass, h.x, h.y, h.z, i[(0, 0)], i[(0, 1)], i[(0, 2)], i[(1, 1)], i[(1, 2)], i[(2, 2)]]
    }

    /// The inertia with these ten parameters in the order of `NOTATION.md`.
    pub fn from_array(p: &[f64; 10]) -> Self {
        Self {
            mass: p[0],
            first_moment: Vector3::new(p[1], p[2], p[3]),
            rotational: Matrix3::new(p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9]),
        }
    }

    /// Centre of mass, m; `None` where the mass is zero.
    pub fn com(&self) -> Option<Vector3<f64>> {
        (self.mass != 0.0).then(|| self.first_moment / self.mass)
    }

    /// Rotational inertia about the centre of mass, kg·m²; about the origin where the mass is zero.
    pub fn about_com(&self) -> Matrix3<f64> {
        let Some(c) = self.com() else { return self.rotational };
        self.rotational - (Matrix3::from_diagonal_element(c.norm_squared()) - c * c.transpose()) * self.mass
    }

    /// Momentum of a body that moves with `v`, or the force that gives it the acceleration `v`: `I v`.
    #[inline]
    pub fn apply(&self, v: &Motion) -> Force {
        Force {
            ang: self.rotational * v.ang + self.first_moment.cross(&v.lin),
            lin: v.lin * self.mass - self.first_moment.cross(&v.ang),
        }
    }

    /// The 4×4 pseudo-inertia of these parameters.
    pub fn pseudo(&self) -> PseudoInertia {
        PseudoInertia::of(self)
    }

    /// Checks physical consistency: the pseudo-inertia is positive definite.
    ///
    /// # Errors
    /// [`InertiaError`] with the number that failed.
    pub fn check(&self) -> Result<(), InertiaError> {
        for (index, &value) in self.to_array().iter().enumerate() {
            if !value.is_finite() {
                return Err(InertiaError::NotFinite { index, value });
            }
        }
        let eigenvalue = self.pseudo().smallest_eigenvalue();
        if eigenvalue > 0.0 { Ok(()) } else { Err(InertiaError::NotPositiveDefinite { eigenvalue }) }
    }
}

/// The pseudo-inertia of a body, whose positive definiteness is exactly physical consistency.
///
/// ```text
/// P = ∫ [x; 1][x; 1]ᵀ ρ dV = [ ½ tr(I) 1 − I   m c ]
///                            [ (m c)ᵀ          m   ]
/// ```
/// P. M. Wensing, S. Kim, J.-J. E. Slotine, "Linear matrix inequalities for physically consistent inertial parameter
/// identification", IEEE RA-L 3(1), 2018, eq. 9.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PseudoInertia(pub Matrix4<f64>);

impl PseudoInertia {
    fn of(inertia: &Inertia) -> Self {
        let sigma = Matrix3::from_diagonal_element(0.5 * inertia.rotational.trace()) - inertia.rotational;
        let mut p = Matrix4::zeros();
        p.fixed_view_mut::<3, 3>(0, 0).copy_from(&sigma);
        p.fixed_view_mut::<3, 1>(0, 3).copy_from(&inertia.first_moment);
        p.fixed_view_mut::<1, 3>(3, 0).copy_from(&inertia.first_moment.transpose());
        p[(3, 3)] = inertia.mass;
        Self(p)
    }

    /// The inertia with this pseudo-inertia: `I = tr(Σ) 1 − Σ`.
    pub fn inertia(&self) -> Inertia {
        let sigma = self.0.fixed_view::<3, 3>(0, 0).into_owned();
        Inertia {
            mass: self.0[(3, 3)],
            first_moment: self.0.fixed_view::<3, 1>(0, 3).into_owned(),
            rotational: Matrix3::from_diagonal_element(sigma.trace()) - sigma,
        }
    }

    /// The smallest eigenvalue; positive exactly when the parameters are physically consistent.
    pub fn smallest_eigenvalue(&self) -> f64 {
        SymmetricEigen::new(self.0).eigenvalues.min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_two_point_masses_are_on_the_boundary_and_a_box_is_inside() {
        let rod = Inertia::from_com(1.0, Vector3::zeros(), Matrix3::from_diagonal(&Vector3::new(0.0, 1.0, 1.0)));
        assert!(rod.check().is_err());
        let brick = Inertia::from_com(1.0, Vector3::x(), Matrix3::from_diagonal(&Vector3::new(2.0, 2.5, 3.0)));
        assert!(brick.check().is_ok());
        let impossible = Inertia::from_com(1.0, Vector3::x(), Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0)));
        assert!(
            matches!(impossible.check(), Err(InertiaError::NotPositiveDefinite { eigenvalue }) if eigenvalue < 0.0)
        );
    }

    #[test]
    fn identity_pseudo_inertia_round_trip_and_arrays() {
        let p = [2.0, 0.1, -0.2, 0.3, 0.5, 0.01, -0.02, 0.6, 0.03, 0.7];
        let inertia = Inertia::from_array(&p);
        let back = inertia.pseudo().inertia().to_array();
        for (a, b) in p.iter().zip(back) {
            assert!((a - b).abs() < 1e-15);
        }
    }
}
