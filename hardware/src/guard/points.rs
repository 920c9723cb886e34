//! How fast the points of an arm move: its flange, and those that its robot file names.

use armid::experiment::{Command, ExperimentPlan, Layout};
use armid::model::Robot;

/// Places in the base frame, m, in the order of [`names`].
pub(super) type Places = Vec<[f64; 3]>;

/// Names of the points: the flange first, then those of the robot file.
pub(super) fn names(robot: &Robot) -> Vec<String> {
    let named = robot.points().iter().map(|point| point.name.clone());
    std::iter::once("flange".to_owned()).chain(named).collect()
}

/// Where the points are. The flange is the origin of the last link's frame: where the arm ends by the standard
/// Denavit-Hartenberg rule; by the modified one it is on the last axis, and a named point says where the arm ends.
pub(super) fn places(robot: &Robot, q: &[f64]) -> Places {
    let poses = robot.poses(q);
    let flange = poses.last().map_or([0.0; 3], |pose| pose.translation.into());
    let named = robot.points().iter().map(|point| point.place(&poses).into());
    std::iter::once(flange).chain(named).collect()
}

/// The point that went furthest between two moments, and how far, m.
pub(super) fn furthest(before: &Places, now: &Places) -> (usize, f64) {
    let distances = before.iter().zip(now).map(|(a, b)| distance(a, b)).enumerate();
    distances.fold((0, 0.0), |most, found| if found.1 > most.1 { found } else { most })
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let square = |k: usize| (a[k] - b[k]) * (a[k] - b[k]);
    libm::sqrt(square(0) + square(1) + square(2))
}

/// The fastest point of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Fastest {
    /// Its name.
    pub point: String,
    /// Its largest speed, m/s.
    pub speed: f64,
}

/// The fastest point along joint positions `at(k)`, k = 0 … `steps`, `dt` s apart.
pub(super) fn fastest(robot: &Robot, steps: usize, dt: f64, at: &mut dyn FnMut(usize, &mut [f64])) -> Fastest {
    let mut q = vec![0.0; robot.dof()];
    at(0, &mut q);
    let (mut before, mut most) = (places(robot, &q), (0, 0.0_f64));
    for k in 1..=steps {
        at(k, &mut q);
        let now = places(robot, &q);
        let found = furthest(&before, &now);
        if found.1 > most.1 {
            most = found;
        }
        before = now;
    }
    Fastest { point: names(robot).swap_remove(most.0), speed: most.1 / dt }
}

/// The fastest point in the periodic motion of a plan: the ramps run the same path and are no faster.
pub fn fastest_point(robot: &Robot, plan: &ExperimentPlan, layout: &Layout) -> Fastest {
    let command = Command::new(plan, layout);
    let n = robot.dof();
    let (mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n]);
    fastest(robot, layout.period_samples, 1.0 / plan.rate_hz, &mut |k, q| {
        command.evaluate(command.periodic_s + k as f64 / plan.rate_hz, q, &mut qd, &mut qdd);
    })
}

#[cfg(test)]
mod tests {
    use armid::model::NamedPoint;

    use super::*;

    /// A planar arm of which the first joint alone turns, at 2 rad/s.
    fn turning(robot: &Robot) -> Fastest {
        fastest(robot, 1000, 1e-3, &mut |k, q| q.copy_from_slice(&[2e-3 * k as f64, 0.0]))
    }

    #[test]
    fn analytic_the_fastest_point_is_the_one_furthest_from_the_axis() {
        let robot = armid::conformance::chains::planar_2r();
        let flange = places(&robot, &[0.0; 2])[0];
        let radius = distance(&flange, &[0.0; 3]);
        let found = turning(&robot);
        assert!(found.point == "flange" && (found.speed - 2.0 * radius).abs() < 1e-5, "{found:?} {radius}");
        // Straight, the arm ends as far from the base as the flange is: a tool that long is twice as fast, a foot stands.
        let position = robot.poses(&[0.0; 2])[1].translation;
        let tip = NamedPoint { name: "tip".to_owned(), link: 2, position };
        let foot = NamedPoint { name: "foot".to_owned(), link: 0, position };
        let found = turning(&robot.with_spec(|spec| spec.points = vec![foot, tip]).unwrap());
        assert!(found.point == "tip" && (found.speed - 4.0 * radius).abs() < 4e-5, "{found:?} {radius}");
    }
}
