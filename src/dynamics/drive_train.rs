//! All drive terms of a robot, bound to its joints and motors and to their parameters.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::DriveTerm;
use super::torque_term::{
    CoulombFriction, MotorCoulomb, MotorViscous, Offset, RotorInertia, Side, TorqueTerm, ViscousFriction,
};
use crate::model::{Columns, ParameterId, Robot, StandardParameters};

/// So many joints are evaluated at once, without allocating.
const CHUNK: usize = 8;

/// One law and those joints or motors that have its parameter.
#[derive(Clone, Debug)]
struct Bank {
    law: Arc<dyn TorqueTerm>,
    /// Whether its coordinates are those of coupled motors.
    through_coupling: bool,
    /// Index of the joint or motor, and which of the drive columns its parameter is.
    members: Vec<(usize, usize)>,
}

/// The drive terms of a robot and the columns they have in its regressor, after those of the links.
///
/// ```
/// use armid::conformance::chains;
/// use armid::dynamics::DriveTrain;
/// use armid::model::Columns;
/// let drives = DriveTrain::new(&chains::planar_2r(), Columns::RigidRotorFriction);
/// let names: Vec<String> = drives.parameters().iter().map(ToString::to_string).collect();
/// assert_eq!(names, ["Ia1", "Fv1", "Fc1", "Fo1", "Ia2", "Fv2", "Fc2", "Fo2"]);
/// ```
#[derive(Clone, Debug)]
pub struct DriveTrain {
    dof: usize,
    parameters: Vec<ParameterId>,
    banks: Vec<Bank>,
    /// Motor coordinates from joint coordinates, row-major n × n; empty where motors are not coupled.
    coupling: Vec<f64>,
}

impl DriveTrain {
    /// The drive terms among these columns of a robot.
    #[must_use]
    pub fn new(robot: &Robot, columns: Columns) -> Self {
        let dof = robot.dof();
        let parameters = columns.parameters(robot).split_off(10 * dof);
        let coupled = robot.coupling().is_some();
        let banks = laws(robot)
            .into_iter()
            .map(|law| {
                let members = parameters.iter().enumerate().filter(|(_, id)| id.kind == law.kind());
                let members = members.map(|(column, id)| (id.index, column)).collect();
                Bank { through_coupling: coupled && law.side() == Side::Motor, members, law }
            })
            .filter(|bank: &Bank| !bank.members.is_empty())
            .collect();
        let coupling = robot.coupling().map(|c| c.transpose().as_slice().to_vec()).unwrap_or_default();
        Self { dof, parameters, banks, coupling }
    }

    /// The parameter of each drive column, in order.
    #[must_use]
    pub fn parameters(&self) -> &[ParameterId] {
        &self.parameters
    }

    /// The terms one by one, in the order of their parameters: for engines with equations of motion of their own.
    #[must_use]
    pub fn terms(&self) -> Vec<DriveTerm> {
        let mut terms = vec![None; self.parameters.len()];
        for bank in &self.banks {
            for &(index, column) in &bank.members {
                let direction = (0..self.dof).map(|joint| (joint, self.direction(bank, index, joint)));
                terms[column] = Some(DriveTerm {
                    parameter: self.parameters[column],
                    law: Arc::clone(&bank.law),
                    direction: direction.filter(|&(_, d)| d != 0.0).collect(),
                });
            }
        }
        terms.into_iter().flatten().collect()
    }

    /// The terms' part in the mass matrix: `Σ φ d dᵀ ∂g/∂a`, n × n, constant.
    #[must_use]
    pub fn inertia(&self, parameters: &StandardParameters) -> DMatrix<f64> {
        let mut m = DMatrix::zeros(self.dof, self.dof);
        for bank in &self.banks {
            for &(index, column) in &bank.members {
                let (_, slope) = bank.law.slopes(index, 0.0, 0.0);
                let value = parameters.get(self.parameters[column]) * slope;
                for i in 0..self.dof {
                    for j in 0..self.dof {
                        m[(i, j)] += value * self.direction(bank, index, i) * self.direction(bank, index, j);
                    }
                }
            }
        }
        m
    }

    /// The parameters' values in the order in which [`add_torque`](Self::add_torque) takes them: n for each law, zero for a
    /// joint that does not have the parameter.
    pub(crate) fn values(&self, parameters: &StandardParameters) -> Vec<f64> {
        let mut values = vec![0.0; self.banks.len() * self.dof];
        for (bank, values) in self.banks.iter().zip(values.chunks_exact_mut(self.dof)) {
            for &(index, column) in &bank.members {
                values[index] = parameters.get(self.parameters[column]);
            }
        }
        values
    }

    /// Adds the drives' torque to `tau` (n), for `values` of their parameters.
    #[inline]
    pub(crate) fn add_torque(&self, values: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        for (bank, values) in self.banks.iter().zip(values.chunks_exact(self.dof)) {
            self.evaluate(bank, qd, qdd, |first, g| {
                let values = &values[first..];
                if bank.through_coupling {
                    for (k, (value, g)) in values.iter().zip(g).enumerate() {
                        for (tau, d) in tau.iter_mut().zip(self.coupling_row(first + k)) {
                            *tau += d * (value * g);
                        }
                    }
                } else {
                    for ((tau, value), g) in tau[first..].iter_mut().zip(values).zip(g) {
                        *tau += value * g;
                    }
                }
            });
        }
    }

    /// Writes the drive columns into a row-major regressor whose rows are `stride` long and in which they start at column
    /// `start`; entries that are zero for every state are left alone.
    #[inline]
    pub(crate) fn write_columns(&self, qd: &[f64], qdd: &[f64], start: usize, stride: usize, y: &mut [f64]) {
        for bank in &self.banks {
            self.evaluate(bank, qd, qdd, |first, g| {
                for &(index, column) in &bank.members {
                    // Another chunk's otherwise.
                    let Some(&g) = g.get(index.wrapping_sub(first)) else { continue };
                    let column = start + column;
                    if bank.through_coupling {
                        for (row, d) in self.coupling_row(index).iter().enumerate() {
                            y[row * stride + column] = d * g;
                        }
                    } else {
                        y[index * stride + column] = g;
                    }
                }
            });
        }
    }

    /// Adds the gradient of `Σ w ∘ Y` over the drive columns to `dqd` and `dqdd` (n each); the row-major weights `w` have
    /// the layout of [`write_columns`](Self::write_columns).
    pub(crate) fn add_gradient(
        &self,
        (qd, qdd): (&[f64], &[f64]),
        start: usize,
        stride: usize,
        weights: &[f64],
        dqd: &mut [f64],
        dqdd: &mut [f64],
    ) {
        for bank in &self.banks {
            for &(index, column) in &bank.members {
                let column = start + column;
                if bank.through_coupling {
                    let d = self.coupling_row(index);
                    let dot = |x: &[f64]| d.iter().zip(x).fold(0.0, |sum, (d, x)| sum + d * x);
                    let weight = (0..self.dof).fold(0.0, |sum, i| sum + d[i] * weights[i * stride + column]);
                    let (by_velocity, by_acceleration) = bank.law.slopes(index, dot(qd), dot(qdd));
                    for i in 0..self.dof {
                        dqd[i] += d[i] * weight * by_velocity;
                        dqdd[i] += d[i] * weight * by_acceleration;
                    }
                } else {
                    let weight = weights[index * stride + column];
                    let (by_velocity, by_acceleration) = bank.law.slopes(index, qd[index], qdd[index]);
                    dqd[index] += weight * by_velocity;
                    dqdd[index] += weight * by_acceleration;
                }
            }
        }
    }

    /// Calls `each(first, g)` with the law of the joints or motors from `first` on, in chunks.
    #[inline]
    fn evaluate(&self, bank: &Bank, qd: &[f64], qdd: &[f64], mut each: impl FnMut(usize, &[f64])) {
        let mut g = [0.0; CHUNK];
        let mut first = 0;
        while first < self.dof {
            let count = CHUNK.min(self.dof - first);
            let g = &mut g[..count];
            if bank.through_coupling {
                let (mut v, mut a) = ([0.0; CHUNK], [0.0; CHUNK]);
                for k in 0..count {
                    let row = self.coupling_row(first + k);
                    v[k] = row.iter().zip(qd).fold(0.0, |sum, (d, x)| sum + d * x);
                    a[k] = row.iter().zip(qdd).fold(0.0, |sum, (d, x)| sum + d * x);
                }
                bank.law.torques(first, &v[..count], &a[..count], g);
            } else {
                bank.law.torques(first, &qd[first..first + count], &qdd[first..first + count], g);
            }
            each(first, g);
            first += count;
        }
    }

    /// Row `motor` of the coupling matrix.
    #[inline]
    fn coupling_row(&self, motor: usize) -> &[f64] {
        &self.coupling[motor * self.dof..(motor + 1) * self.dof]
    }

    /// Entry `joint` of the direction of a member.
    fn direction(&self, bank: &Bank, index: usize, joint: usize) -> f64 {
        if bank.through_coupling { self.coupling_row(index)[joint] } else { f64::from(u8::from(index == joint)) }
    }
}

/// Every law there is, for the joints and motors of a robot.
fn laws(robot: &Robot) -> [Arc<dyn TorqueTerm>; 6] {
    let velocities: Vec<f64> = robot.joints().iter().map(|joint| joint.drive.coulomb_velocity).collect();
    [
        Arc::new(RotorInertia),
        Arc::new(ViscousFriction),
        Arc::new(CoulombFriction { velocities: velocities.clone() }),
        Arc::new(Offset),
        Arc::new(MotorViscous),
        Arc::new(MotorCoulomb { velocities }),
    ]
}
