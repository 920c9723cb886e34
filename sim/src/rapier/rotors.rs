//! Rotors of coupled motors, which the engine does not model.
//!
//! ```text
//! R = Cᵀ Ia C        A = diag R        (M + A) a = u + b − K a,  K = R − A
//! ```
//! The engine adds a diagonal `A`, its armature, to its mass matrix; a rotor that several joints drive fills more than
//! the diagonal. The rest acts as the torque `−K a`, `a` the solution of `(M + A + K) a = u + b`: `M + A` is the
//! engine's own mass matrix, `u` what is applied from outside, and `b`, gravity and Coriolis forces, is read off the
//! engine's own step before, `b = (M + A) a₋ − u₋`. That `b` is one step late leaves the order of the method, 1; the
//! first step after a reset is preceded by one that is taken back.

use nalgebra::{DMatrix, DVector};

/// The part of the rotors that the armature cannot hold.
#[derive(Clone, Debug)]
pub(super) struct CoupledRotors {
    rest: DMatrix<f64>,
    bias: Option<DVector<f64>>,
}

impl CoupledRotors {
    /// From the rotors' part `R` of the mass matrix; `None` where it is diagonal.
    pub(super) fn new(rotors: &DMatrix<f64>) -> Option<Self> {
        let mut rest = rotors.clone();
        rest.fill_diagonal(0.0);
        (rest.amax() > 0.0).then_some(Self { rest, bias: None })
    }

    /// What the armature does not hold, `K`.
    pub(super) const fn rest(&self) -> &DMatrix<f64> {
        &self.rest
    }

    pub(super) fn reset(&mut self) {
        self.bias = None;
    }

    pub(super) const fn knows_bias(&self) -> bool {
        self.bias.is_some()
    }

    /// Notes what a step of the engine with the mass matrix `mass` and the external torques `applied` showed.
    pub(super) fn observe(&mut self, mass: &DMatrix<f64>, applied: &[f64], qdd: &[f64]) {
        self.bias = Some(mass * DVector::from_column_slice(qdd) - DVector::from_column_slice(applied));
    }

    /// The torque `−K a` under these external torques; zeros where the bias is not known or the mass matrix singular.
    pub(super) fn torque(&self, mass: &DMatrix<f64>, applied: &[f64]) -> DVector<f64> {
        let n = applied.len();
        let Some(bias) = &self.bias else { return DVector::zeros(n) };
        let forces = bias + DVector::from_column_slice(applied);
        match (mass + &self.rest).cholesky() {
            Some(factor) => -(&self.rest * factor.solve(&forces)),
            None => DVector::zeros(n),
        }
    }
}
