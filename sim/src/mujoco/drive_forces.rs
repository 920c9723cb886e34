//! Friction and offset of the drives as generalised forces, and how stiff they are.
//!
//! ```text
//! τ_drive = Σ φ d g(dᵀq̇, 0)                    λ ≤ tr(M⁻¹ D) = Σ φ ∂g/∂v dᵀ M⁻¹ d
//! ```
//! The laws `g` and directions `d` are the core's. Smooth Coulomb friction makes velocities near zero decay at rates up
//! to `λ`, some thousands per second; an explicit step must not be longer than a part of `1/λ`.

use armid::dynamics::{DriveTerm, DriveTrain};
use armid::model::{Columns, ParameterKind, Robot, StandardParameters};

/// One law as the bound on `λ` sees it.
#[derive(Clone, Debug)]
struct Brake {
    /// Its place among the terms.
    term: usize,
    /// The entries `(joint, d)` of its direction that are not zero.
    direction: Vec<(usize, f64)>,
    /// An upper bound of `dᵀ M⁻¹ d` that needs no mass matrix: rotors alone, or infinity.
    mobility: f64,
}

/// The drives of a robot but for their rotors.
#[derive(Clone, Debug)]
pub(super) struct DriveForces {
    terms: Vec<(DriveTerm, f64)>,
    brakes: Vec<Brake>,
    dof: usize,
}

impl DriveForces {
    pub(super) fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let train = DriveTrain::new(robot, Columns::RigidRotorFriction);
        let terms: Vec<(DriveTerm, f64)> = train
            .terms()
            .iter()
            .filter(|term| term.slopes(0.0).1 == 0.0)
            .map(|term| (term.clone(), parameters.get(term.parameter())))
            .filter(|&(_, value)| value != 0.0)
            .collect();
        let brakes = terms
            .iter()
            .enumerate()
            .filter(|(_, (term, _))| term.slopes(0.0).0 != 0.0)
            .map(|(index, (term, _))| {
                let motor = term.parameter().index;
                let direction = term.direction().to_vec();
                // M ≥ Ia d dᵀ for the rotor's own direction, and then dᵀ M⁻¹ d ≤ 1 / Ia.
                let of_motor = matches!(term.parameter().kind, ParameterKind::Fvm | ParameterKind::Fcm);
                let carried = of_motor || robot.coupling().is_none();
                let mobility = if carried { 1.0 / parameters.drives[motor].rotor } else { f64::INFINITY };
                Brake { term: index, direction, mobility }
            })
            .collect();
        Self { terms, brakes, dof: robot.dof() }
    }

    /// `applied = tau − friction − offset` at the velocities `qd`; n each.
    pub(super) fn apply(&self, tau: &[f64], qd: &[f64], applied: &mut [f64]) {
        applied.fill(0.0);
        for (term, value) in &self.terms {
            term.add_torque(*value, qd, applied);
        }
        for (applied, tau) in applied.iter_mut().zip(tau) {
            *applied = tau - *applied;
        }
    }

    /// Bound on `λ` while each joint's velocity `qd` changes by `change` at most, 1/s, by the rotors' inertia alone.
    pub(super) fn coarse_decay(&self, qd: &[f64], change: &[f64]) -> f64 {
        self.brakes.iter().map(|brake| self.slope(brake, qd, change) * brake.mobility).sum()
    }

    /// The same with the inverse of the mass matrix, row-major n × n.
    pub(super) fn decay(&self, qd: &[f64], change: &[f64], inverse: &[f64]) -> f64 {
        let n = self.dof;
        let mut rate = 0.0;
        for brake in &self.brakes {
            let mut mobility = 0.0;
            for &(i, di) in &brake.direction {
                for &(j, dj) in &brake.direction {
                    mobility += di * inverse[i * n + j] * dj;
                }
            }
            rate += self.slope(brake, qd, change) * mobility;
        }
        rate
    }

    /// The steepest that a law gets: at the velocity closest to zero, since friction flattens away from it.
    fn slope(&self, brake: &Brake, qd: &[f64], change: &[f64]) -> f64 {
        let (term, value) = &self.terms[brake.term];
        let (mut v, mut swing) = (0.0, 0.0);
        for &(joint, d) in &brake.direction {
            v += d * qd[joint];
            swing += d.abs() * change[joint];
        }
        let closest = (v.abs() - swing).max(0.0);
        value.abs() * term.slopes(closest).0
    }
}
