//! Which limits a design holds, on the command line.

use armid::excitation::effort::ParameterSpread;
use armid::excitation::{DesignLimits, ExcitationError, Margins};
use armid::model::{JointKind, Obstacle, Robot};
use armid_hardware::guard::GuardSettings;
use armid_io::{Error, LoadedRobot};
use miette::Result;

/// The part of the torque and current limits that may be used where the nominal parameters state no uncertainty.
const WITHOUT_UNCERTAINTY: f64 = 0.9;
/// What a servo may be beside its command, deg: a motion that touches a soft limit would be stopped by it.
const SERVO_DEG: f64 = 1.0;

/// Which limits hold.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LimitArguments {
    /// Largest acceleration of every joint, in place of the robot's own limits
    #[arg(long, value_name = "RAD_S2")]
    max_acceleration: Option<f64>,
    /// Distance to keep from the position limits, deg: by default the soft limits of the guard that watches a real arm, and
    /// a degree for the servo. Prismatic joints keep as much of the guard's margin in metres
    #[arg(long, value_name = "DEG", default_value_t = GuardSettings::default().soft_margin_deg + SERVO_DEG)]
    margin: f64,
    /// Do not hold the limits of torque and current
    #[arg(long)]
    ignore_torque: bool,
    /// Probability with which torque and current keep their limits at any one instant, by the uncertainty that the
    /// nominal parameters state; 0.5 holds them for the nominal parameters alone
    #[arg(long, value_name = "P", default_value_t = 0.95)]
    confidence: f64,
    /// Length of the ramps in which the limits hold as well, s
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    ramp: f64,
    /// Hold the limits on the period alone, not on the ramps around it
    #[arg(long)]
    no_ramps: bool,
    /// Distance to keep between the robot's collision shapes and from obstacles, m
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    clearance: f64,
    /// Do not hold any clearance
    #[arg(long)]
    ignore_clearance: bool,
    /// Keep everything above this height of the base frame, m, beside the obstacles of the robot file
    #[arg(long, value_name = "Z")]
    keep_above: Option<f64>,
}

impl LimitArguments {
    /// The clearance that is to be held, m.
    pub(crate) fn clearance(&self) -> Option<f64> {
        (!self.ignore_clearance).then_some(self.clearance)
    }

    /// The robot with the limits and obstacles that were given.
    pub(crate) fn robot(&self, loaded: &LoadedRobot) -> Result<Robot> {
        let mut robot = loaded.robot.clone();
        if let Some(acceleration) = self.max_acceleration {
            robot = robot
                .with_joints(|joint| joint.limits.acceleration = acceleration)
                .map_err(|fault| Error::new(format!("--max-acceleration: {fault}")))?;
        }
        if let Some(z) = self.keep_above {
            if !z.is_finite() {
                return Err(Error::new(format!("--keep-above is {z}, expected a finite number, m")).into());
            }
            robot = robot.with_obstacle(Obstacle::above("keep-above", z));
        }
        Ok(robot)
    }

    /// The limits of a design for a `robot` from [`Self::robot`].
    pub(crate) fn limits(&self, robot: &Robot, loaded: &LoadedRobot) -> Result<DesignLimits> {
        if !(0.5..1.0).contains(&self.confidence) {
            let message = format!("--confidence is {}, expected 0.5 or more and less than 1", self.confidence);
            return Err(Error::new(message).into());
        }
        if !(self.margin.is_finite() && self.margin >= 0.0) {
            return Err(Error::new(format!(
                "--margin is {}, expected a finite number of degrees, not below 0",
                self.margin
            ))
            .into());
        }
        let guard = GuardSettings::default();
        let sliding = guard.soft_margin_m * self.margin / guard.soft_margin_deg;
        let margin = |kind: JointKind| if kind == JointKind::Revolute { self.margin.to_radians() } else { sliding };
        let margins = robot.joints().iter().map(|joint| margin(joint.kind)).collect();
        self.limits_of(robot, loaded, margins).map_err(|error| Error::new(error.to_string()).into())
    }

    fn limits_of(
        &self,
        robot: &Robot,
        loaded: &LoadedRobot,
        position_margin: Vec<f64>,
    ) -> std::result::Result<DesignLimits, ExcitationError> {
        let mut limits = DesignLimits::default().with_position_margin(position_margin)?;
        if !self.no_ramps {
            limits = limits.with_ramps(self.ramp)?;
        }
        if !self.ignore_clearance {
            limits = limits.with_clearance(self.clearance)?;
        }
        if self.ignore_torque {
            return Ok(limits);
        }
        let part = |torque: f64| Margins { torque, ..Margins::default() };
        match (loaded.nominal.as_ref().or(loaded.own.as_ref()), &loaded.uncertainty) {
            (Some(nominal), Some(shares)) => {
                let multiple = ParameterSpread::multiple_of(self.confidence);
                let spread = ParameterSpread::of(robot, nominal, shares, multiple);
                limits.with_uncertain_efforts(nominal.clone(), spread)?.with_margins(part(1.0))
            }
            (Some(nominal), None) => limits.with_efforts(nominal.clone()).with_margins(part(WITHOUT_UNCERTAINTY)),
            (None, _) => limits.with_margins(part(WITHOUT_UNCERTAINTY)),
        }
    }
}
