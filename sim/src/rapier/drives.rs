//! Friction and offset, so split that the engine integrates them stably.
//!
//! ```text
//! τ_friction(q̇ + h a) ≈ τ_friction(q̇) + h D a        D_jj = Σ_terms φ |d_j| ∂g/∂v Σ_i |d_i|
//! ```
//! Smooth Coulomb friction makes velocities near zero decay some thousand times per second, too fast for an explicit
//! step of order 1. The engine has a diagonal damping that it treats implicitly, `−D (q̇ + h a)`: it is given the
//! slopes of friction at the present velocity, and the torque `D q̇ − τ_friction(q̇)` beside it, so that at `h → 0` the
//! law is the core's, whatever `D` is. A joint's own terms have `D` equal to their slope; a coupled motor's slopes fill
//! a matrix, of which the sums of absolute values over rows are an upper bound, so that the implicit step stays stable.

use armid::dynamics::{DriveTerm, DriveTrain};
use armid::model::{Columns, ParameterKind, Robot, StandardParameters};

use super::RapierError;

/// Friction and offset of all joints and motors.
#[derive(Clone, Debug)]
pub(super) struct Drives {
    terms: Vec<(DriveTerm, f64)>,
}

impl Drives {
    pub(super) fn new(robot: &Robot, parameters: &StandardParameters) -> Result<Self, RapierError> {
        for (joint, drive) in robot.joints().iter().zip(&parameters.drives) {
            let coulomb = if drive.coulomb == 0.0 { drive.motor_coulomb } else { drive.coulomb };
            if coulomb != 0.0 && joint.drive.coulomb_velocity == 0.0 {
                return Err(RapierError::Jump { joint: joint.name.clone(), coulomb });
            }
        }
        let terms = DriveTrain::new(robot, Columns::RigidRotorFriction).terms().into_iter();
        let terms = terms.filter(|term| term.parameter().kind != ParameterKind::Ia);
        let terms = terms.map(|term| {
            let value = parameters.get(term.parameter());
            (term, value)
        });
        Ok(Self { terms: terms.filter(|&(_, value)| value != 0.0).collect() })
    }

    /// Torque that friction and offset take at the velocities `qd`, and the damping that makes it implicit; n each.
    pub(super) fn evaluate(&self, qd: &[f64], torque: &mut [f64], damping: &mut [f64]) {
        torque.fill(0.0);
        damping.fill(0.0);
        for (term, value) in &self.terms {
            term.add_torque(*value, qd, torque);
            let slope = value * term.slopes(term.speed(qd)).0;
            let sum: f64 = term.direction().iter().map(|&(_, d)| d.abs()).sum();
            for &(joint, d) in term.direction() {
                // A negative coefficient is not made implicit: that would take stability away.
                damping[joint] += (slope * d.abs() * sum).max(0.0);
            }
        }
    }
}
