//! A guarded arm is an arm.

use armid::conformance::arm_laws::{self, ArmTolerance};
use armid::experiment::{ExperimentPlan, Plant, PlantError, Servo, record};
use armid::model::StandardParameters;
use armid::model::term::ROTOR;
use armid::seed::Seed;
use armid::spatial::Inertia;

use super::stage::{plan, robot};
use crate::guard::{GuardSettings, Guarded, Mode, Trip};

/// Rotors of 2 kg·m² on every joint and nothing else: under a held torque each step has a closed form.
#[derive(Clone, Debug)]
struct Rotors {
    q: Vec<f64>,
    qd: Vec<f64>,
}

impl Plant for Rotors {
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
            let acceleration = tau[i] / 2.0;
            self.q[i] += dt * (self.qd[i] + 0.5 * dt * acceleration);
            self.qd[i] += dt * acceleration;
        }
        Ok(())
    }
}

fn servo() -> Servo<Rotors> {
    let robot = robot();
    let mut rotors = StandardParameters::zero(6);
    for (link, drive) in rotors.links.iter_mut().zip(&mut rotors.drives) {
        *link = Inertia::zero();
        drive[ROTOR] = 2.0;
    }
    Servo::new(&robot, &rotors, Rotors { q: vec![0.0; 6], qd: vec![0.0; 6] }).unwrap().with_seed(Seed::new(3), 0)
}

/// A motion gentle enough for the wrist's small drives.
fn gentle() -> ExperimentPlan {
    plan(0.3, 1000.0)
}

#[test]
fn identity_a_guarded_servo_obeys_the_laws_of_arms_and_changes_no_bit() {
    let settings = GuardSettings::default();
    let guarded = || Guarded::new(servo(), &robot(), &settings, Mode::Trajectory);
    arm_laws::check(&gentle(), &ArmTolerance::SIMULATED, guarded).unwrap();
    assert_eq!(record(&mut guarded(), &gentle()).unwrap(), record(&mut servo(), &gentle()).unwrap());
}

#[test]
fn a_servo_that_cannot_follow_trips() {
    let settings = GuardSettings { following_error_deg: 0.01, ..GuardSettings::default() };
    let mut guarded = Guarded::new(servo(), &robot(), &settings, Mode::Trajectory);
    let (recording, ending) = record(&mut guarded, &gentle()).unwrap();
    let trip = super::stage::tripped(&ending);
    assert_eq!(Trip::parse(trip.trip), Some(Trip::FollowingError));
    assert!(!recording.is_empty() && trip.reason.contains("joint \""), "{trip}");
    assert!(guarded.record().used["following-error"] > 1.0);
}
