//! The plant of tests: one flywheel of 1 kg·m² for each of two joints.

use armid::experiment::{Plant, PlantError};
use armid::model::StandardParameters;
use armid::model::term::ROTOR;

/// Positions and velocities.
#[derive(Clone)]
pub(crate) struct FlyWheels(pub(crate) [f64; 2], pub(crate) [f64; 2]);

impl Plant for FlyWheels {
    fn dof(&self) -> usize {
        2
    }

    fn state(&self) -> (&[f64], &[f64]) {
        (&self.0, &self.1)
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        self.0.copy_from_slice(q);
        self.1.copy_from_slice(qd);
    }

    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
        for i in 0..2 {
            self.1[i] += dt * tau[i];
            self.0[i] += dt * self.1[i];
        }
        Ok(())
    }
}

/// Their parameters.
pub(crate) fn nominal() -> StandardParameters {
    let mut nominal = StandardParameters::zero(2);
    nominal.drives.iter_mut().for_each(|drive| drive[ROTOR] = 1.0);
    nominal
}
