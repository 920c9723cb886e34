//! Small robots for tests, and a plant whose motion has a closed form: rotors alone, each on a vertical axis.

use crate::model::term::ROTOR;
use nalgebra::DMatrix;

use super::plant::{Plant, PlantError};
use crate::model::{DhConvention, DhRow, Drive, Joint, JointKind, Limits, Robot, RobotSpec, StandardParameters};
use crate::trajectory::{FourierJoint, FourierTrajectory};

/// Inertia of every hinge, kg·m².
pub const INERTIA: f64 = 2.0;

fn drive() -> Drive {
    Drive {
        gear: 100.0,
        torque_constant: 0.15,
        current_limit: 5.0,
        counts_per_revolution: 400_000.0,
        encoder_sign: -1.0,
        current_noise: 0.02,
        adc_range: 10.0,
        adc_bits: 12,
        coulomb_velocity: 0.01,
        ..Drive::ideal()
    }
}

fn robot(dof: usize, coupling: Option<DMatrix<f64>>) -> Robot {
    let joints = (0..dof).map(|i| {
        let row = DhRow { offset_deg: 0.0, d: 0.0, a: 0.0, alpha_deg: 0.0 };
        let (before, after) = row.placements(DhConvention::Standard);
        Joint {
            name: format!("hinge{}", i + 1),
            kind: JointKind::Revolute,
            before,
            after,
            dh: Some((DhConvention::Standard, row)),
            limits: Limits { position: (-3.0, 3.0), velocity: 3.0, acceleration: 12.0, torque: 75.0, ..Limits::NONE },
            drive: drive(),
        }
    });
    Robot::new(RobotSpec { name: "hinges".to_owned(), joints: joints.collect(), coupling, ..RobotSpec::default() })
        .expect("distinct joints with positive limits")
}

/// One vertical hinge: no gravity, no friction.
pub fn single() -> Robot {
    robot(1, None)
}

/// Two vertical hinges whose second motor is driven through the first: `C = [1 0; 1 1]`.
pub fn coupled() -> Robot {
    robot(2, Some(DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 1.0, 1.0])))
}

/// Rotors alone: [`FlyWheels`] is the plant with these parameters.
pub fn parameters(dof: usize) -> StandardParameters {
    let mut set = StandardParameters::zero(dof);
    set.drives.iter_mut().for_each(|drive| drive[ROTOR] = INERTIA);
    set
}

/// A trajectory of one harmonic per joint, period 2 s, that keeps within the limits.
pub fn trajectory(dof: usize) -> FourierTrajectory {
    let joint = |i: usize| FourierJoint {
        name: format!("hinge{}", i + 1),
        a: vec![0.5 - 0.2 * i as f64, 0.3],
        b: vec![0.4, -0.3],
        q0: 0.1,
    };
    FourierTrajectory { period_s: 2.0, joints: (0..dof).map(joint).collect() }
}

/// Flywheels without friction: under a held torque each step has the closed form `q += q̇ dt + τ dt²/2J`.
#[derive(Clone, Debug)]
pub struct FlyWheels {
    q: Vec<f64>,
    qd: Vec<f64>,
}

impl FlyWheels {
    /// At rest at zero.
    pub fn new(dof: usize) -> Self {
        Self { q: vec![0.0; dof], qd: vec![0.0; dof] }
    }
}

impl Plant for FlyWheels {
    fn dof(&self) -> usize {
        self.q.len()
    }

    fn state(&self) -> (&[f64], &[f64]) {
        (&self.q, &self.qd)
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        self.q.copy_from_slice(q);
        self.qd.copy_from_slice(qd);
    }

    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
        for i in 0..tau.len() {
            let acceleration = tau[i] / INERTIA;
            self.q[i] += dt * (self.qd[i] + 0.5 * dt * acceleration);
            self.qd[i] += dt * acceleration;
        }
        PlantError::of_state(&self.q, &self.qd).map_or(Ok(()), Err)
    }
}
