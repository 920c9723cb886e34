//! The torque terms, so split that the engine integrates them stably.
//!
//! ```text
//! τ_terms(q̇ + h a) ≈ τ_terms(q̇) + h D a        D_jj = Σ_terms φ |d_j| ∂g/∂v Σ_i |d_i|
//! ```
//! Smooth Coulomb friction makes velocities near zero decay some thousand times per second, too fast for an explicit
//! step of order 1. The engine has a diagonal damping that it treats implicitly, `−D (q̇ + h a)`: it is given the
//! slopes of the terms at the present velocity, and the torque `D q̇ − τ_terms(q̇)` beside it, so that at `h → 0` the
//! law is the core's, whatever `D` is. A joint's own terms have `D` equal to their slope; a coupled motor's slopes fill
//! a matrix, of which the sums of absolute values over rows are an upper bound, so that the implicit step stays stable.

use armid::dynamics::{PlacedTerm, TorqueTerms, check_simulable};
use armid::model::{Columns, Robot, StandardParameters};

use super::RapierError;

/// The torque terms of all joints and motors but for the rotors.
#[derive(Clone, Debug)]
pub(super) struct TermForces {
    terms: Vec<(PlacedTerm, f64)>,
}

impl TermForces {
    pub(super) fn new(robot: &Robot, parameters: &StandardParameters) -> Result<Self, RapierError> {
        check_simulable(robot, parameters)?;
        let columns = Columns::default().with_terms_of(parameters);
        let terms = TorqueTerms::new(robot, columns).placed().into_iter().filter(|term| !term.term.is_inertia());
        let terms = terms.map(|term| {
            let value = parameters.get(term.parameter);
            (term, value)
        });
        Ok(Self { terms: terms.filter(|&(_, value)| value != 0.0).collect() })
    }

    /// Torque that the terms take at the positions `q` and velocities `qd`, and the damping that makes it implicit; n each.
    pub(super) fn evaluate(&self, q: &[f64], qd: &[f64], torque: &mut [f64], damping: &mut [f64]) {
        torque.fill(0.0);
        damping.fill(0.0);
        for (term, value) in &self.terms {
            term.add_torque(*value, q, qd, torque);
            let slope = value * term.slopes(term.project(q), term.project(qd))[1];
            let sum: f64 = term.direction.iter().map(|&(_, d)| d.abs()).sum();
            for &(joint, d) in &term.direction {
                // A negative coefficient is not made implicit: that would take stability away.
                damping[joint] += (slope * d.abs() * sum).max(0.0);
            }
        }
    }
}
