//! From where the arm stands to the start pose, at low speed.

use armid::model::Robot;
use armid::trajectory::QuinticStep;

use super::GuardSettings;
use super::points::fastest;

/// A straight line in joint space, run with zero velocity and acceleration at both ends:
///
/// ```text
/// q(t) = q_from + (q_to − q_from) S(t/T)      S the quintic step
/// max |q̇| = 15/8 |Δ|/T      max |q̈| = 10/√3 |Δ|/T²
/// T = max_j max(15/8 |Δ_j| / (f q̇_max,j), √(10/√3 |Δ_j| / (f q̈_max,j)), T_min)
/// ```
/// with the part `f` of the robot's limits. The line stays within position limits where both ends do. **Whether it is
/// free of collisions is not known**: the guard has no model of the surroundings, so the operator watches.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// Where it begins, rad (m).
    pub from: Vec<f64>,
    /// Where it ends, rad (m).
    pub to: Vec<f64>,
    /// How long it takes, s.
    pub duration_s: f64,
}

/// Shortest approach, s: of an arm that stands at the start pose already.
const SHORTEST_S: f64 = 0.5;
/// Speed of a joint without a limit of its own while it approaches, rad/s (m/s), before the part is taken.
const UNSTATED_SPEED: f64 = 1.0;

impl Approach {
    /// The approach of a robot between two poses of its joints.
    pub fn new(robot: &Robot, settings: &GuardSettings, from: &[f64], to: &[f64]) -> Self {
        let part = settings.approach_speed;
        let duration = robot.joints().iter().zip(from.iter().zip(to)).map(|(joint, (from, to))| {
            let way = (to - from).abs();
            let speed = if joint.limits.velocity.is_finite() { joint.limits.velocity } else { UNSTATED_SPEED };
            let by_speed = 15.0 / 8.0 * way / (part * speed);
            let by_acceleration = libm::sqrt(10.0 / libm::sqrt(3.0) * way / (part * joint.limits.acceleration));
            by_speed.max(by_acceleration)
        });
        let duration_s = duration.fold(SHORTEST_S, f64::max);
        let mut approach = Self { from: from.to_vec(), to: to.to_vec(), duration_s };
        if settings.reduced_speed_mm_s > 0.0 {
            // The same line more slowly: speeds are inverse to the duration. A tenth is left for the servo.
            let line = 0.9e-3 * settings.reduced_speed_mm_s;
            approach.duration_s *= (approach.largest_speed(robot) / line).max(1.0);
        }
        approach
    }

    /// Largest speed of the flange and of every named point, m/s.
    fn largest_speed(&self, robot: &Robot) -> f64 {
        const STEPS: usize = 400;
        let dt = self.duration_s / STEPS as f64;
        let (mut qd, mut qdd) = (vec![0.0; self.from.len()], vec![0.0; self.from.len()]);
        fastest(robot, STEPS, dt, &mut |k, q| self.evaluate(k as f64 * dt, q, &mut qd, &mut qdd)).speed
    }

    /// Position, velocity and acceleration at time `t` (s), n each; at rest before and after.
    pub fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let step = QuinticStep::evaluate(t / self.duration_s);
        for j in 0..q.len() {
            let way = self.to[j] - self.from[j];
            q[j] = self.from[j] + way * step.value;
            qd[j] = way * (step.slope / self.duration_s);
            qdd[j] = way * (step.curvature / (self.duration_s * self.duration_s));
        }
    }
}
