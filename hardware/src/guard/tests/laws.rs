//! A guarded arm is an arm.

use armid::conformance::arm_laws::{self, ArmTolerance};
use armid::experiment::hinges::{self, FlyWheels};
use armid::experiment::{ExperimentPlan, Servo, record};
use armid::seed::Seed;

use super::stage::{plan, robot};
use crate::guard::{GuardSettings, Guarded, Mode, Trip};

fn servo() -> Servo<FlyWheels> {
    Servo::new(&robot(), &hinges::parameters(6), FlyWheels::new(6)).unwrap().with_seed(Seed::new(3), 0)
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
