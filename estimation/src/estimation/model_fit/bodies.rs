//! The bodies that one link can be, in coordinates in which its guess is the unit matrix.
//!
//! ```text
//! P = L X Lᵀ        X = Σ ξ_k E_k        S = X − ε 1        m/m⁰ = vᵀ X v,   v = Lᵀ e₄/√m⁰
//! d(ξ) = tr S/(1 − ε) − ln det S − ln(r − a) − ln(b − r) + c r        c = 1/(1 − a) − 1/(b − 1)
//! ```
//! E_k is an orthonormal basis of symmetric matrices. d is convex, and least at X = 1.

use nalgebra::{DMatrix, DVector, Matrix4, SMatrix, SVector, Vector4};

use crate::estimation::consistent_set::{basis, symmetric};
use crate::spatial::{Inertia, PseudoInertia};

pub(super) type Ten = SVector<f64, 10>;
pub(super) type TenByTen = SMatrix<f64, 10, 10>;

/// ε: the least eigenvalue of a body relative to its guess.
pub(super) const FLOOR: f64 = 1e-3;

/// One link.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Place of its ten among the parameters.
    pub(super) at: usize,
    root: Matrix4<f64>,
    /// Gradient of r by ξ.
    mass: Ten,
    /// a, b.
    bounds: (f64, f64),
}

/// A convex function at one point.
pub(super) struct Curved {
    pub(super) value: f64,
    pub(super) gradient: Ten,
    pub(super) hessian: TenByTen,
}

impl Body {
    /// Around a guess with a mass above zero whose pseudo-inertia is positive definite; `None` where it is not.
    pub(super) fn around(at: usize, guess: &Inertia, bounds: (f64, f64)) -> Option<Self> {
        let root = guess.pseudo().0.cholesky()?.l();
        let v: Vector4<f64> = root.transpose() * Vector4::w() / guess.mass.sqrt();
        let mass = Ten::from_fn(|k, _| v.dot(&(basis(k) * v)));
        Some(Self { at, root, mass, bounds })
    }

    /// ξ of the guess.
    pub(super) fn centre() -> Ten {
        Ten::from_fn(|k, _| basis(k).trace())
    }

    /// ∂(ten)/∂ξ.
    pub(super) fn jacobian(&self) -> TenByTen {
        let mut tens = TenByTen::zeros();
        for k in 0..10 {
            let change = PseudoInertia(self.root * basis(k) * self.root.transpose());
            tens.column_mut(k).copy_from_slice(&change.inertia().to_array());
        }
        tens
    }

    /// d; `None` where S is not positive definite or the mass beyond its bounds.
    pub(super) fn divergence(&self, xi: &Ten) -> Option<Curved> {
        let s = symmetric(xi) - Matrix4::identity() * FLOOR;
        let factor = s.cholesky()?;
        let (low, high) = self.bounds;
        let ratio = self.mass.dot(xi);
        if !(low < ratio && ratio < high) {
            return None;
        }
        let inverse = factor.inverse();
        let logarithm: f64 = factor.l_dirty().diagonal().iter().map(|&d| 2.0 * libm::log(d)).sum();
        let pull = 1.0 / (1.0 - low) - 1.0 / (high - 1.0);
        let (below, above) = (ratio - low, high - ratio);
        let value = s.trace() / (1.0 - FLOOR) - logarithm - libm::log(below) - libm::log(above) + pull * ratio;
        let slope = pull - 1.0 / below + 1.0 / above;
        let gradient = Ten::from_fn(|k, _| basis(k).trace() / (1.0 - FLOOR) - (inverse * basis(k)).trace());
        let images: Vec<Matrix4<f64>> = (0..10).map(|k| inverse * basis(k) * inverse).collect();
        let hessian = TenByTen::from_fn(|i, k| images[k].component_mul(&basis(i)).sum());
        let bend = below.powi(-2) + above.powi(-2);
        Some(Curved {
            value,
            gradient: gradient + self.mass * slope,
            hessian: hessian + self.mass * self.mass.transpose() * bend,
        })
    }

    /// Adds `w d` with its gradient and Hessian at ξ; the value. `None` as [`Self::divergence`].
    pub(super) fn add(
        &self,
        w: f64,
        x: &DVector<f64>,
        gradient: &mut DVector<f64>,
        hessian: &mut DMatrix<f64>,
    ) -> Option<f64> {
        let own = self.divergence(&x.fixed_rows::<10>(self.at).into_owned())?;
        let mut rows = gradient.fixed_rows_mut::<10>(self.at);
        rows += own.gradient * w;
        let mut block = hessian.fixed_view_mut::<10, 10>(self.at, self.at);
        block += own.hessian * w;
        Some(w * own.value)
    }
}
