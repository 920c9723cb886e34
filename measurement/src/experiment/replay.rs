//! A stored recording as an arm.

use super::arm::{Arm, ArmError, Ending, Sink};
use super::command::Command;
use super::layout::Layout;
use super::phase::Phase;
use super::plan::ExperimentPlan;
use super::plan_mismatch::PlanMismatchError;
use super::recording::Recording;
use super::trip::Rest;

/// Performs an experiment by playing what another arm once recorded.
#[derive(Clone, Debug)]
pub struct Replay(pub Recording);

impl Replay {
    /// The plan's motion and rates must be those of the recording; times around the recorded periods may differ.
    fn check(&self, plan: &ExperimentPlan) -> Result<(), ArmError> {
        let recording = &self.0;
        let layout = plan.check(recording.dof)?;
        if (recording.rate_hz - plan.rate_hz).abs() > 1e-9 * plan.rate_hz {
            return Err(PlanMismatchError::Rate { found: recording.rate_hz, planned: plan.rate_hz }.into());
        }
        if recording.period_samples != layout.period_samples {
            let (found, planned) = (recording.period_samples, layout.period_samples);
            return Err(PlanMismatchError::PeriodSamples { found, planned }.into());
        }
        if recording.trajectory != plan.trajectory {
            return Err(PlanMismatchError::Trajectory.into());
        }
        if recording.periods() < plan.periods {
            return Err(PlanMismatchError::Periods { found: recording.periods(), planned: plan.periods }.into());
        }
        Ok(())
    }
}

impl Arm for Replay {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        self.check(plan)?;
        let recording = &self.0;
        let n = recording.dof;
        sink.begin(&recording.without_samples());
        let mut command = vec![0.0; n];
        let (mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n]);
        let layout = Layout { spans: recording.phases.clone(), period_samples: recording.period_samples };
        let commanded = Command::new(plan, &layout);
        for k in 0..recording.len() {
            let phase = recording.phase(k).unwrap_or(Phase::RampOut);
            commanded.evaluate(k as f64 / recording.rate_hz, &mut command, &mut qd, &mut qdd);
            if sink.sample(&recording.sample(k, phase, &command)).ends() {
                return Ok(Ending::Stopped { t: recording.t[k], phase, rest: Rest::Simulated });
            }
        }
        Ok(Ending::Completed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{ExperimentPlan, Servo, record};
    use crate::seed::Seed;

    fn plan() -> ExperimentPlan {
        ExperimentPlan { settle_s: 0.2, ramp_s: 0.5, periods: 2, ..ExperimentPlan::new(hinges::trajectory(2)) }
    }

    fn servo() -> Servo<FlyWheels> {
        let robot = hinges::coupled();
        Servo::new(&robot, &hinges::parameters(2), FlyWheels::new(2)).unwrap().with_seed(Seed::new(6), 1)
    }

    #[test]
    fn identity_a_replay_hands_on_its_recording() {
        let recording = record(&mut servo(), &plan()).unwrap().0;
        assert_eq!(record(&mut Replay(recording.clone()), &plan()).unwrap().0, recording);
    }

    #[test]
    fn a_recording_of_another_experiment_is_refused() {
        let recording = record(&mut servo(), &plan()).unwrap().0;
        let mut other = plan();
        other.trajectory.adjust(0, 1.0, 0.1);
        for (plan, word) in [
            (ExperimentPlan { rate_hz: 500.0, ..plan() }, "rate_hz is 1000, expected the plan's 500"),
            (other, "trajectory"),
            (plan().with_periods(3), "number of recorded periods is 2, expected the plan's 3"),
        ] {
            let message = record(&mut Replay(recording.clone()), &plan).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
