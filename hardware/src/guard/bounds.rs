//! The limits that the settings give for one robot, joint by joint.

use armid::model::{EffortInterface, JointKind, Robot};

use super::GuardSettings;

/// The limits of one joint, in rad (m), per second, and the unit of its effort.
#[derive(Clone, Debug, PartialEq)]
pub struct JointBounds {
    /// Its name.
    pub name: String,
    /// Unit of its coordinate.
    pub unit: &'static str,
    /// The robot's own position limits.
    pub hard: (f64, f64),
    /// The soft limits inside them; infinite where the hard ones are.
    pub soft: (f64, f64),
    /// Speed limit.
    pub velocity: f64,
    /// Largest measured speed; infinite where no limit is known.
    pub overspeed: f64,
    /// Acceleration limit.
    pub acceleration: f64,
    /// Largest distance from the command.
    pub following: f64,
    /// What a position may move between two samples beyond 1.5 times the speed limit.
    pub jump: f64,
    /// Largest lasting effort, A or N·m (N) as the robot reports it; infinite where no limit is known.
    pub effort: f64,
    /// Unit of the effort.
    pub effort_unit: &'static str,
}

impl JointBounds {
    /// The limits of every joint of a robot.
    ///
    /// An effort that is a torque is held against what the clamped currents give at the joint,
    /// `|τ_j| ≤ clamp · Σ_i |C_ij| N_i Kt_i i_max,i`, with the coupling `C` of the motors.
    #[must_use]
    pub fn of_robot(robot: &Robot, settings: &GuardSettings) -> Vec<Self> {
        let motors: Vec<f64> =
            robot.joints().iter().map(|joint| joint.drive.torque_per_ampere() * joint.drive.current_limit).collect();
        let bounds = |(j, joint): (usize, &armid::model::Joint)| {
            let turns = joint.kind == JointKind::Revolute;
            let pick = |deg: f64, m: f64| if turns { deg.to_radians() } else { m };
            let margin = pick(settings.soft_margin_deg, settings.soft_margin_m);
            let (low, high) = joint.limits.position;
            let (effort, effort_unit) = match robot.effort() {
                EffortInterface::Current => (joint.drive.current_limit, "A"),
                EffortInterface::Torque => {
                    let through = |i: usize| robot.coupling().map_or(f64::from(u8::from(i == j)), |c| c[(i, j)].abs());
                    // A motor without a known limit that does not act on this joint says nothing about it.
                    let share = |i: usize| if through(i) > 0.0 { through(i) * motors[i] } else { 0.0 };
                    ((0..motors.len()).map(share).sum(), joint.kind.effort_unit())
                }
            };
            Self {
                name: joint.name.clone(),
                unit: joint.kind.unit(),
                hard: (low, high),
                soft: (low + margin, high - margin),
                velocity: joint.limits.velocity,
                overspeed: settings.overspeed * joint.limits.velocity,
                acceleration: joint.limits.acceleration,
                following: pick(settings.following_error_deg, settings.following_error_m),
                jump: pick(settings.jump_deg, settings.jump_m),
                effort: settings.current_clamp * effort,
                effort_unit,
            }
        };
        robot.joints().iter().enumerate().map(bounds).collect()
    }

    /// Part of the soft range that a position uses, 1 at a soft limit; 0 where there is none.
    pub fn soft_use(&self, q: f64) -> f64 {
        let (low, high) = self.soft;
        if low.is_finite() && high.is_finite() {
            ((q - 0.5 * (low + high)) / (0.5 * (high - low))).abs()
        } else if q < low || q > high {
            1.0 + (low - q).max(q - high)
        } else {
            0.0
        }
    }
}
