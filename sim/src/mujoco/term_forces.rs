//! The torque terms as generalised forces, and how stiff they are.
//!
//! ```text
//! τ_terms = Σ φ d g(dᵀq, dᵀq̇)                    λ ≤ tr(M⁻¹ D) = Σ φ ∂g/∂v dᵀ M⁻¹ d
//! ```
//! The laws `g` and directions `d` are the core's. Smooth Coulomb friction makes velocities near zero decay at rates up
//! to `λ`, some thousands per second; an explicit step must not be longer than a part of `1/λ`.

use armid::dynamics::{PlacedTerm, TorqueTerms};
use armid::model::term::ROTOR;
use armid::model::{Columns, Robot, StandardParameters};

/// One law as the bound on `λ` sees it.
#[derive(Clone, Debug)]
struct Brake {
    /// Its place among the terms.
    term: usize,
    /// An upper bound of `dᵀ M⁻¹ d` that needs no mass matrix: rotors alone, or infinity.
    mobility: f64,
}

/// The torque terms of a robot but for its rotors.
#[derive(Clone, Debug)]
pub(super) struct TermForces {
    terms: Vec<(PlacedTerm, f64)>,
    brakes: Vec<Brake>,
    dof: usize,
}

impl TermForces {
    pub(super) fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let columns = Columns::default().with_terms_of(parameters);
        let terms: Vec<(PlacedTerm, f64)> = TorqueTerms::new(robot, columns)
            .placed()
            .into_iter()
            .filter(|term| !term.term.is_inertia())
            .map(|term| {
                let value = parameters.get(term.parameter);
                (term, value)
            })
            .filter(|&(_, value)| value != 0.0)
            .collect();
        let brakes = terms
            .iter()
            .enumerate()
            .filter(|(_, (term, _))| term.slopes(0.0, 0.0)[1] != 0.0)
            .map(|(index, (term, _))| {
                let motor = term.parameter.index;
                // M ≥ Ia d dᵀ for the rotor's own direction, and then dᵀ M⁻¹ d ≤ 1 / Ia.
                let carried = term.term.is_motors() || robot.coupling().is_none();
                let mobility = if carried { 1.0 / parameters.drives[motor][ROTOR] } else { f64::INFINITY };
                Brake { term: index, mobility }
            })
            .collect();
        Self { terms, brakes, dof: robot.dof() }
    }

    /// `applied = tau − terms` at the positions `q` and velocities `qd`; n each.
    pub(super) fn apply(&self, tau: &[f64], q: &[f64], qd: &[f64], applied: &mut [f64]) {
        applied.fill(0.0);
        for (term, value) in &self.terms {
            term.add_torque(*value, q, qd, applied);
        }
        for (applied, tau) in applied.iter_mut().zip(tau) {
            *applied = tau - *applied;
        }
    }

    /// Bound on `λ` while each joint's velocity `qd` changes by `change` at most, 1/s, by the rotors' inertia alone.
    pub(super) fn coarse_decay(&self, q: &[f64], qd: &[f64], change: &[f64]) -> f64 {
        self.brakes.iter().map(|brake| self.slope(brake, q, qd, change) * brake.mobility).sum()
    }

    /// Bound on `λ` by the inverse of the mass matrix, row-major n × n.
    pub(super) fn decay(&self, q: &[f64], qd: &[f64], change: &[f64], inverse: &[f64]) -> f64 {
        let n = self.dof;
        let mut rate = 0.0;
        for brake in &self.brakes {
            let direction = &self.terms[brake.term].0.direction;
            let mut mobility = 0.0;
            for &(i, di) in direction {
                for &(j, dj) in direction {
                    mobility += di * inverse[i * n + j] * dj;
                }
            }
            rate += self.slope(brake, q, qd, change) * mobility;
        }
        rate
    }

    /// The steepest that a law gets: at the velocity closest to zero, since friction flattens away from it. A slope below
    /// zero brakes nothing.
    fn slope(&self, brake: &Brake, q: &[f64], qd: &[f64], change: &[f64]) -> f64 {
        let (term, value) = &self.terms[brake.term];
        let (mut v, mut swing) = (0.0, 0.0);
        for &(joint, d) in &term.direction {
            v += d * qd[joint];
            swing += d.abs() * change[joint];
        }
        let closest = (v.abs() - swing).max(0.0);
        value.abs() * term.slopes(term.project(q), closest)[1].max(0.0)
    }
}
