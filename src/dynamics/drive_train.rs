//! All drive terms of a robot, each bound to its joint or motor and to its parameter.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::torque_term::{
    CoulombFriction, MotorCoulomb, MotorViscous, Offset, RotorInertia, Side, TorqueTerm, ViscousFriction,
};
use crate::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters};

/// One drive term in its place.
#[derive(Clone, Debug)]
pub struct DriveTerm {
    /// The parameter that multiplies it.
    pub parameter: ParameterId,
    /// Its law.
    pub law: Arc<dyn TorqueTerm>,
    /// The first non-zero entry of its direction `d`, as (joint, entry): the only one unless motors are coupled.
    lead: (usize, f64),
    /// The others.
    others: Vec<(usize, f64)>,
}

impl DriveTerm {
    /// The term's own rate for joint rates: `dᵀ x`.
    #[inline]
    fn project(&self, x: &[f64]) -> f64 {
        let mut sum = self.lead.1 * x[self.lead.0];
        for &(joint, d) in &self.others {
            sum += d * x[joint];
        }
        sum
    }

    /// The non-zero entries `(joint, d)` of its direction: `e_j`, or row j of the coupling matrix.
    #[inline]
    fn direction(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        std::iter::once(self.lead).chain(self.others.iter().copied())
    }

    /// Adds the torque of `value` units of the parameter: `τ += value d g(dᵀq̇, dᵀq̈)`; `qd`, `qdd`, `tau` of length n.
    #[inline]
    pub fn add_torque(&self, value: f64, qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        let g = value * self.law.torque(self.project(qd), self.project(qdd));
        tau[self.lead.0] += self.lead.1 * g;
        for &(joint, d) in &self.others {
            tau[joint] += d * g;
        }
    }

    /// Writes its column of a row-major regressor: `y[joint · stride + column] = d_joint g`; other rows are left alone.
    #[inline]
    pub fn write_column(&self, qd: &[f64], qdd: &[f64], column: usize, stride: usize, y: &mut [f64]) {
        let g = self.law.torque(self.project(qd), self.project(qdd));
        y[self.lead.0 * stride + column] = self.lead.1 * g;
        for &(joint, d) in &self.others {
            y[joint * stride + column] = d * g;
        }
    }

    /// Adds the gradient of `Σ_i w_i Y_i`, `Y` its column and `w` the entries of column `column` of the row-major
    /// `weights`, with respect to joint velocities and accelerations.
    #[inline]
    pub fn add_gradient(
        &self,
        qd: &[f64],
        qdd: &[f64],
        column: usize,
        stride: usize,
        weights: &[f64],
        dqd: &mut [f64],
        dqdd: &mut [f64],
    ) {
        let mut weight = 0.0;
        for (joint, d) in self.direction() {
            weight += d * weights[joint * stride + column];
        }
        let (by_velocity, by_acceleration) = self.law.slopes(self.project(qd), self.project(qdd));
        for (joint, d) in self.direction() {
            dqd[joint] += d * weight * by_velocity;
            dqdd[joint] += d * weight * by_acceleration;
        }
    }
}

/// The drive terms of a robot, in the order of their parameters.
///
/// ```
/// use armid::dynamics::DriveTrain;
/// use armid::model::Columns;
/// # let robot = armid::conformance::chains::planar_2r();
/// let drives = DriveTrain::new(&robot, Columns::RigidRotorFriction);
/// let names: Vec<String> = drives.terms().iter().map(|term| term.parameter.to_string()).collect();
/// assert_eq!(names, ["Ia1", "Fv1", "Fc1", "Fo1", "Ia2", "Fv2", "Fc2", "Fo2"]);
/// ```
#[derive(Clone, Debug)]
pub struct DriveTrain {
    dof: usize,
    terms: Vec<DriveTerm>,
}

impl DriveTrain {
    /// The drive terms among these columns of a robot.
    #[must_use]
    pub fn new(robot: &Robot, columns: Columns) -> Self {
        let terms = columns
            .parameters(robot)
            .into_iter()
            .filter_map(|parameter| {
                let law = law(robot, parameter)?;
                let (lead, others) = match (law.side(), robot.coupling()) {
                    (Side::Motor, Some(c)) => {
                        let row: Vec<f64> = c.row(parameter.index).iter().copied().collect();
                        let mut entries = row.into_iter().enumerate().filter(|&(_, d)| d != 0.0);
                        (entries.next()?, entries.collect())
                    }
                    _ => ((parameter.index, 1.0), Vec::new()),
                };
                Some(DriveTerm { parameter, law, lead, others })
            })
            .collect();
        Self { dof: robot.dof(), terms }
    }

    /// The terms in the order of their parameters.
    #[must_use]
    pub fn terms(&self) -> &[DriveTerm] {
        &self.terms
    }

    /// The terms' part in the mass matrix: `Σ φ d dᵀ ∂g/∂a`, n × n, constant.
    #[must_use]
    pub fn inertia(&self, parameters: &StandardParameters) -> DMatrix<f64> {
        let mut m = DMatrix::zeros(self.dof, self.dof);
        for term in &self.terms {
            let (_, slope) = term.law.slopes(0.0, 0.0);
            for (i, di) in term.direction() {
                for (j, dj) in term.direction() {
                    m[(i, j)] += parameters.get(term.parameter) * slope * di * dj;
                }
            }
        }
        m
    }
}

/// The law behind a parameter; `None` for the ten of a link.
fn law(robot: &Robot, parameter: ParameterId) -> Option<Arc<dyn TorqueTerm>> {
    let velocity = robot.joints()[parameter.index].drive.coulomb_velocity;
    Some(match parameter.kind {
        ParameterKind::Ia => Arc::new(RotorInertia),
        ParameterKind::Fv => Arc::new(ViscousFriction),
        ParameterKind::Fc => Arc::new(CoulombFriction { velocity }),
        ParameterKind::Fo => Arc::new(Offset),
        ParameterKind::Fvm => Arc::new(MotorViscous),
        ParameterKind::Fcm => Arc::new(MotorCoulomb { velocity }),
        _ => return None,
    })
}
