//! Accelerations from torques.
//!
//! ```text
//! M q̈ = τ − c        M = Lᵀ D L, L lower triangular with ones on its diagonal, from the last joint to the first
//! ```
//! From the last joint on, as the entries of the last joints are the simplest. Nothing is pivoted: a mass matrix is positive definite.
//!
//! Reference: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, sec. 6.5.

use super::expression::{Expression, Expressions, Id};

impl Expressions {
    /// q̈ (n) under the torque τ, with M (n × n by rows) and the torque c (n) of the motion without acceleration.
    pub(super) fn forward(&mut self, mass: &[Id], bias: &[Id]) -> Vec<Id> {
        let n = bias.len();
        // Below the diagonal rows of L; `scaled` has its entries times those of D.
        let (mut l, mut inverse) = (mass.to_vec(), vec![0; n]);
        let mut scaled = mass.to_vec();
        for k in (0..n).rev() {
            for j in 0..=k {
                for i in k + 1..n {
                    let part = self.product(l[i * n + k], scaled[i * n + j]);
                    scaled[k * n + j] = self.difference(scaled[k * n + j], part);
                }
            }
            inverse[k] = self.reciprocal(scaled[k * n + k]);
            for j in 0..k {
                l[k * n + j] = self.product(scaled[k * n + j], inverse[k]);
            }
        }
        let mut x: Vec<Id> = Vec::with_capacity(n);
        for (k, &bias) in bias.iter().enumerate() {
            let torque = self.intern(Expression::Effort(k));
            x.push(self.difference(torque, bias));
        }
        for k in (0..n).rev() {
            for j in 0..k {
                let part = self.product(l[k * n + j], x[k]);
                x[j] = self.difference(x[j], part);
            }
        }
        for k in 0..n {
            x[k] = self.product(x[k], inverse[k]);
            for j in 0..k {
                let part = self.product(l[k * n + j], x[j]);
                x[k] = self.difference(x[k], part);
            }
        }
        x
    }
}
