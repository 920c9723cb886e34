//! How fast the end of the arm moves.

use armid::experiment::{Command, ExperimentPlan, Layout};
use armid::model::Robot;

/// Where the frame of the last link stands, m in the base frame: the flange by the standard Denavit-Hartenberg rule.
#[must_use]
pub(super) fn flange(robot: &Robot, q: &[f64]) -> [f64; 3] {
    robot.poses(q).last().map_or([0.0; 3], |pose| pose.translation.into())
}

/// Distance between two points, m.
#[must_use]
pub(super) fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let square = |k: usize| (a[k] - b[k]) * (a[k] - b[k]);
    libm::sqrt(square(0) + square(1) + square(2))
}

/// Largest speed of the flange along joint positions `at(k)`, k = 0 … `steps`, `dt` s apart, m/s.
pub(super) fn largest_speed(robot: &Robot, steps: usize, dt: f64, at: &mut dyn FnMut(usize, &mut [f64])) -> f64 {
    let mut q = vec![0.0; robot.dof()];
    at(0, &mut q);
    let (mut before, mut largest) = (flange(robot, &q), 0.0_f64);
    for k in 1..=steps {
        at(k, &mut q);
        let now = flange(robot, &q);
        largest = largest.max(distance(&before, &now) / dt);
        before = now;
    }
    largest
}

/// Largest speed of the flange in the periodic motion of a plan, m/s: the ramps run the same path and are no faster.
#[must_use]
pub fn flange_speed(robot: &Robot, plan: &ExperimentPlan, layout: &Layout) -> f64 {
    let command = Command::new(plan, layout);
    let n = robot.dof();
    let (mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n]);
    largest_speed(robot, layout.period_samples, 1.0 / plan.rate_hz, &mut |k, q| {
        command.evaluate(command.periodic_begin_s() + k as f64 / plan.rate_hz, q, &mut qd, &mut qdd);
    })
}
