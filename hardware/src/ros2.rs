//! A real robot over ROS 2, reached only through the guard.

use armid::experiment::{
    Arm, ArmError, Ending, ExperimentPlan, Flow, Phase, RawSample, ReceivedState, Recording, Sink,
};
use armid::model::Robot;

use crate::guard::{Approach, Approached, Confirmation, GuardRecord, GuardSettings, Guarded, Machine, Mode, Survey};
use crate::link::{self, GridSample, JointRow, LinkError, LinkSettings, Listener, Motion, Ros2Arm, StampFindings};
use crate::message::Text;

/// Topic on which a guard reports its state, below the namespace of the link: JSON in `std_msgs/msg/String`.
pub const GUARD_STATE: &str = "armid/guard_state";

/// A robot over ROS 2, behind the guard.
pub struct GuardedRos2 {
    guarded: Guarded<Approached<Ros2Arm>>,
}

/// Finds the robot on the network and puts the guard around it, unless `asked` says that the operator asks for the end.
/// Nothing has moved yet.
///
/// There is no other way to a [`Ros2Arm`], and none to a [`Confirmation`] but the operator's confirmation.
///
/// # Errors
/// [`LinkError`] where a setting is impossible, there is no answer, or the joints are not those of the robot file;
/// [`LinkError::Interrupted`] where the end was asked for.
pub fn guarded_ros2(
    settings: &LinkSettings,
    guard: &GuardSettings,
    robot: &Robot,
    robot_text: &str,
    confirmation: Confirmation,
    asked: fn() -> bool,
) -> Result<GuardedRos2, LinkError> {
    let mut arm = Ros2Arm::find(settings, robot, robot_text, asked)?;
    let status_publisher = arm.status_publisher(&settings.full(GUARD_STATE))?;
    let disables = arm.can_disable();
    let mode = match settings.mode {
        link::Mode::Trajectory | link::Mode::Topic => Mode::Trajectory,
        link::Mode::Stream => Mode::Stream,
    };
    let approached = Approached::new(arm, robot, guard, confirmation);
    let guarded = Guarded::new(approached, robot, guard, mode).with_disable(disables);
    let guarded = guarded.with_observer(Box::new(move |state| {
        // A monitor misses one report; nothing else depends on it.
        if let Ok(data) = serde_json::to_string(state) {
            let _ = status_publisher.publish(Text { data });
        }
    }));
    Ok(GuardedRos2 { guarded })
}

impl GuardedRos2 {
    /// What the guard did and saw.
    pub fn record(&self) -> GuardRecord {
        let (passed, approach) = self.guarded.arm().before();
        let mut record = self.guarded.record().clone();
        record.preflight.extend_from_slice(passed);
        record.approach = approach.cloned();
        record
    }

    /// What the stamps of the last motion showed.
    pub fn findings(&self) -> &StampFindings {
        self.guarded.arm().machine().findings()
    }
}

impl Arm for GuardedRos2 {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        self.guarded.perform(plan, sink)
    }
}

impl Motion for Approach {
    fn dof(&self) -> usize {
        self.to.len()
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.evaluate(t, q, qd, qdd);
    }
}

fn unavailable(error: &LinkError) -> ArmError {
    ArmError::Unavailable { arm: "ros2".to_owned(), reason: error.to_string() }
}

impl Machine for Ros2Arm {
    fn survey(&mut self) -> Result<Survey, ArmError> {
        let reading = self.reading().map_err(|error| unavailable(&error))?;
        // At this point every joint has been mapped by its name.
        let joints = self.robot().joints().iter().map(|joint| joint.name.clone()).collect();
        // What is on the list says all of it: homed, drives on, no emergency stop. No other state is accepted.
        let ready = reading.state.as_ref().map(|state| self.ready_states().iter().any(|ready| ready == state.trim()));
        Ok(Survey {
            joints,
            q: reading.row.q.clone(),
            effort: reading.row.effort.clone(),
            rate_hz: reading.rate_hz,
            homed: ready.filter(|ready| *ready),
            ready,
            state: reading.state,
            ready_states: self.ready_states().to_vec(),
        })
    }

    fn announcement(&self, plan: &ExperimentPlan) -> Result<Recording, ArmError> {
        Ok(self.recording(plan, &plan.check(self.robot().dof())?))
    }

    fn approach(&mut self, approach: &Approach, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        let rate_hz = self.rate_hz().round();
        let mut way = Way { sink, rate_hz, t: 0.0 };
        let followed = self.follow(approach, rate_hz, &mut way);
        let (t, phase) = (way.t, Phase::Settle);
        Ok(link::ending(followed, t, phase))
    }
}

/// Hands the samples of an approach on.
struct Way<'a> {
    sink: &'a mut dyn Sink,
    rate_hz: f64,
    t: f64,
}

impl Way<'_> {
    fn receive(&mut self, t: f64, q: &[f64], effort: &[f64], command: &[f64]) -> Flow {
        self.t = t;
        self.sink.unrecorded(&RawSample {
            index: 0,
            t,
            phase: Phase::Settle,
            q,
            effort,
            voltage: &[],
            link_q: &[],
            command,
        })
    }
}

impl Listener for Way<'_> {
    fn sample(&mut self, sample: &GridSample, command: &[f64]) -> Flow {
        self.receive(sample.index as f64 / self.rate_hz, &sample.q, &sample.effort, command)
    }

    fn standing(&mut self, t: f64, row: &JointRow, command: &[f64]) -> Flow {
        self.receive(t, &row.q, &row.effort, command)
    }

    fn received(&mut self, state: &ReceivedState<'_>) -> Flow {
        self.sink.received(state)
    }

    fn idle(&mut self, age_s: f64) -> Flow {
        self.sink.idle(age_s)
    }

    fn command(&mut self, set_point: &[f64], age_s: f64) -> Flow {
        self.sink.command(set_point, age_s)
    }
}
