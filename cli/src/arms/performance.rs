//! An experiment being performed by one of the arms.

use std::collections::BTreeMap;
use std::path::Path;

use armid::experiment::{Arm, Ending, Replay, Sink, Tracking};
use armid::seed::Seed;
use armid_hardware::guard::{GuardRecord, Guarded, Mode};
use armid_hardware::guarded_ros2;
use armid_hardware::link::StampFindings;
use armid_io::{Error, Log};
use armid_workflow::simulated_arm;
use miette::{Report, Result};

use super::{ArmKind, Experiment};
use crate::interrupt::{self, Interrupted};

/// An experiment's end, how well a simulated servo followed its command, and what guard and link saw.
pub(crate) struct Performed {
    pub(crate) ending: Ending,
    pub(crate) tracking: Option<Tracking>,
    pub(crate) guard: Option<GuardRecord>,
    pub(crate) stamps: Option<StampFindings>,
}

impl Performed {
    /// What goes into the recording beside its ending.
    pub(crate) fn remarks(&self) -> BTreeMap<String, String> {
        let mut remarks = BTreeMap::new();
        let mut remark = |key: &str, value: Option<serde_json::Result<String>>| {
            if let Some(Ok(value)) = value {
                remarks.insert(key.to_owned(), value);
            }
        };
        remark("guard", self.guard.as_ref().map(serde_json::to_string));
        remark("stamps", self.stamps.as_ref().map(serde_json::to_string));
        remarks
    }
}

/// Performs an experiment on an arm. `recording` is what `replay` plays.
pub(crate) fn perform(
    kind: ArmKind,
    experiment: &Experiment,
    recording: Option<&Path>,
    sink: &mut dyn Sink,
) -> Result<Performed> {
    let fault = |error: &dyn std::fmt::Display| Error::new(format!("arm {}: {error}", kind.name()));
    match kind {
        ArmKind::Simulated(engine) => {
            let robot = &experiment.planned.robot;
            let simulated = simulated_arm(robot, engine, experiment.planned.effects.clone())?;
            let is_tree = robot.text.content.trim_start().starts_with('<');
            let help = is_tree.then(|| {
                format!("`armid robot {} -o robot.toml` begins a robot file, which states it", robot.text.name)
            });
            let mut servo = simulated
                .servo(&experiment.planned.sensing)
                .map_err(|error| fault(&error).maybe_help(help))?
                .with_seed(Seed::new(experiment.planned.seed), experiment.planned.run);
            if !experiment.guarded {
                let ending = servo.perform(&experiment.planned.plan, sink).map_err(|error| fault(&error))?;
                return Ok(Performed { ending, tracking: servo.tracking().cloned(), guard: None, stamps: None });
            }
            // A simulated servo has the whole motion before it begins, as a robot controller has.
            let mut guarded = Guarded::new(servo, &simulated.robot, &experiment.guard, Mode::Trajectory);
            let ending = guarded.perform(&experiment.planned.plan, sink).map_err(|error| fault(&error))?;
            let (guard, tracking) = (Some(guarded.record().clone()), guarded.arm().tracking().cloned());
            Ok(Performed { ending, tracking, guard, stamps: None })
        }
        ArmKind::Replay => {
            let Some(path) = recording else {
                return Err(Error::new("arm replay needs --recording R.mcap: what it plays")
                    .help("`armid run EXPERIMENT -o R.mcap` makes one")
                    .into());
            };
            let recording = Log::read(path)?.into_recording()?;
            let ending = Replay(recording).perform(&experiment.planned.plan, sink).map_err(|error| fault(&error))?;
            Ok(Performed { ending, tracking: None, guard: None, stamps: None })
        }
        ArmKind::Ros2 => {
            let Some(confirmation) = experiment.confirmation.clone() else {
                return Err(Error::new("arm ros2 moves a real arm, and no operator confirmed it").into());
            };
            let (robot, text) = (&experiment.planned.robot.robot, experiment.planned.robot.text.content.as_ref());
            // An error here means that nothing has moved.
            let fault = |error: &dyn std::fmt::Display| match fault(error) {
                error if interrupt::asked() => Report::from(Interrupted(error.to_string())),
                error => error.into(),
            };
            let (link, guard) = (&experiment.ros2, &experiment.guard);
            let mut arm = guarded_ros2(link, guard, robot, text, confirmation, interrupt::asked)
                .map_err(|error| fault(&error))?;
            let ending = arm.perform(&experiment.planned.plan, sink).map_err(|error| fault(&error))?;
            let (guard, stamps) = (Some(arm.record()), Some(arm.findings().clone()));
            Ok(Performed { ending, tracking: None, guard, stamps })
        }
    }
}
