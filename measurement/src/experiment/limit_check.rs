//! Does the commanded motion stay inside the robot's limits of motion, sample by sample?

use super::command::Command;
use super::phase::Phase;
use super::plan::ExperimentPlan;
use super::plan_error::PlanError;
use crate::model::Robot;

impl ExperimentPlan {
    /// Checks that the commanded motion, ramps included, stays inside the robot's position, speed and acceleration
    /// limits at every sample.
    ///
    /// # Errors
    /// [`PlanError::Limit`] for the first sample that leaves one, or as [`ExperimentPlan::check`].
    pub fn check_limits(&self, robot: &Robot) -> Result<(), PlanError> {
        let layout = self.check(robot.dof())?;
        let command = Command::new(self, &layout);
        let (ramp_in, ramp_out) = (layout.span(Phase::RampIn), layout.span(Phase::RampOut));
        // One period stands for all of them.
        let periodic = ramp_in.end..ramp_in.end + layout.period_samples;
        let n = robot.dof();
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in ramp_in.chain(periodic).chain(ramp_out) {
            let t = k as f64 / self.rate_hz;
            command.evaluate(t, &mut q, &mut qd, &mut qdd);
            for (i, joint) in robot.joints().iter().enumerate() {
                let limits = &joint.limits;
                let (low, high) = limits.position;
                let above =
                    |quantity, found: f64, limit: f64, per| (found > limit).then_some((quantity, found, limit, per));
                let broken = (q[i] < low)
                    .then_some(("position", q[i], low, ""))
                    .or_else(|| above("position", q[i], high, ""))
                    .or_else(|| above("speed", qd[i].abs(), limits.velocity, "/s"))
                    .or_else(|| above("acceleration", qdd[i].abs(), limits.acceleration, "/s²"));
                if let Some((quantity, found, limit, per)) = broken {
                    let (joint, unit) = (joint.name.clone(), format!("{}{per}", joint.kind.unit()));
                    return Err(PlanError::Limit { joint, quantity, found, limit, unit, t, phase: layout.phase(k) });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges;

    fn plan() -> ExperimentPlan {
        ExperimentPlan { settle_s: 0.3, ramp_s: 0.8, periods: 2, ..ExperimentPlan::new(hinges::trajectory(2)) }
    }

    #[test]
    fn limits_hold_or_the_first_break_is_named() {
        let robot = hinges::coupled();
        assert_eq!(plan().check_limits(&robot), Ok(()));
        let mut series = hinges::trajectory(2);
        series.joints[1].a[0] = 4.0;
        let fast = ExperimentPlan { trajectory: series.into(), ..plan() };
        let message = fast.check_limits(&robot).unwrap_err().to_string();
        assert!(
            message.contains("hinge2") && message.contains("exceeds its limit 12.0000 rad/s² at t = 0.8"),
            "{message}"
        );
        // A hurried ramp asks for more acceleration than the motion itself.
        let hurried = ExperimentPlan { ramp_s: 0.05, ..plan() };
        let fault = hurried.check_limits(&robot).unwrap_err();
        assert!(matches!(fault, PlanError::Limit { quantity: "acceleration", phase: Phase::RampIn, .. }), "{fault}");
    }
}
