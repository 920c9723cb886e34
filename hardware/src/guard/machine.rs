//! An arm that is brought to the start pose before its experiment begins.

use armid::experiment::{
    Arm, ArmError, Command, Ending, ExperimentPlan, Phase, Recording, Rest, SafeAction, Sink, TripReport,
};
use armid::model::Robot;

use super::{
    Approach, ApproachRecord, Confirmation, GuardSettings, JointBounds, Passed, REACTION_MS, Survey, Trip, preflight,
};

/// A real arm, or a simulated one that is reached as a real one is.
pub trait Machine: Arm {
    /// Looks at the arm without moving it.
    ///
    /// # Errors
    /// [`ArmError`] where nothing is received from it.
    fn survey(&mut self) -> Result<Survey, ArmError>;

    /// What a recording of this plan is, before its first sample.
    ///
    /// # Errors
    /// [`ArmError`] where the plan cannot be performed.
    fn announcement(&self, plan: &ExperimentPlan) -> Result<Recording, ArmError>;

    /// Moves along an approach. The sink receives samples as no part of the experiment ([`Sink::unrecorded`]), idle
    /// time and set-points, but no [`Sink::begin`].
    ///
    /// # Errors
    /// [`ArmError`] where the motion cannot begin.
    fn approach(&mut self, approach: &Approach, sink: &mut dyn Sink) -> Result<Ending, ArmError>;
}

/// Surveys a machine, brings it to the start pose, and has it perform the experiment.
#[derive(Debug)]
pub struct Approached<M> {
    machine: M,
    robot: Robot,
    settings: GuardSettings,
    bounds: Vec<JointBounds>,
    confirmation: Confirmation,
    preflight: Vec<Passed>,
    approach: Option<ApproachRecord>,
}

impl<M: Machine> Approached<M> {
    pub(crate) fn new(machine: M, robot: &Robot, settings: &GuardSettings, confirmation: Confirmation) -> Self {
        Self {
            machine,
            robot: robot.clone(),
            settings: settings.clone(),
            bounds: JointBounds::of_robot(robot, settings),
            confirmation,
            preflight: Vec::new(),
            approach: None,
        }
    }

    /// The machine, to read from.
    pub fn machine(&self) -> &M {
        &self.machine
    }

    /// What passed before the first motion, and how the arm came to the start pose.
    pub fn before(&self) -> (&[Passed], Option<&ApproachRecord>) {
        (&self.preflight, self.approach.as_ref())
    }
}

/// The ending of an experiment that the robot aborted before its first sample.
fn stopped(reason: String) -> Ending {
    let (trip, action) = (Trip::RobotStopped.name(), SafeAction::Cancel);
    // It stood at the start pose, and nothing was handed over since.
    let rest = Rest::Confirmed { after_ms: 0.0 };
    let trip = Box::new(TripReport { trip, action, bound_ms: REACTION_MS, reason, rest });
    Ending::Tripped { t: 0.0, phase: Phase::Settle, trip }
}

impl<M: Machine> Arm for Approached<M> {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        let layout = plan.check(self.robot.dof())?;
        let survey = self.machine.survey()?;
        self.preflight = preflight::of_survey(&self.bounds, plan, &survey, &self.confirmation)?;
        let mut start = vec![0.0; self.robot.dof()];
        Command::new(plan, &layout).start(&mut start);
        let approach = Approach::new(&self.robot, &self.settings, &survey.q, &start);
        self.approach = Some(ApproachRecord { from: survey.q, to: start, duration_s: approach.duration_s });
        let mut ending = self.machine.approach(&approach, sink)?;
        if ending.is_complete() {
            ending = match self.machine.perform(plan, sink) {
                // It came to the start pose and does not go on: something happened in between.
                Err(ArmError::Unavailable { reason, .. }) => stopped(reason),
                done => return done,
            };
        }
        // Nothing was recorded, and that is what the recording says: it has its plan, no sample, and an ending.
        sink.begin(&self.machine.announcement(plan)?);
        Ok(ending)
    }
}
