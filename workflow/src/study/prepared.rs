//! A study and its arms, before anything is performed.

use std::path::Path;
use std::sync::{Arc, Mutex};

use armid::experiment::Sensing;
use armid::model::format::ChainEnds;
use armid::observer::Observer;
use armid::study::{OwnMethods, StudyPlan, StudySetup};
use armid_io::study::check_output;
use armid_io::{Error, robot};
use armid_sim::{Engine, SimulatedArm};

use super::part::Part;
use super::performance::Performance;
use crate::simulated_arm;

/// A study and the arms that it is performed on, one for each condition.
#[derive(Debug)]
pub struct PreparedStudy {
    /// What it studies, by which plan.
    pub setup: StudySetup,
    arms: Vec<SimulatedArm>,
    robot_text: Arc<str>,
}

impl PreparedStudy {
    /// Everything that a study needs before its first design. Relative paths of the plan begin at `beside`; it may name the methods
    /// `own`.
    ///
    /// # Errors
    /// [`Error`] where the robot cannot be read, the study does not fit it, or one of its arms cannot be built.
    pub fn new(plan: StudyPlan, beside: Option<&Path>, own: &OwnMethods) -> Result<Self, Error> {
        let loaded = robot::load(&plan.robot, &ChainEnds::default(), beside)?;
        let mut arms = Vec::new();
        for condition in plan.conditions() {
            let engine = Engine::parse(&condition.engine)
                .ok_or_else(|| Error::new(format!("there is no engine \"{}\"", condition.engine)))?;
            let arm = simulated_arm(&loaded, engine, plan.effects.overridden_by(&condition.effects))?;
            arm.servo(&Sensing::ideal()).map_err(|error| Error::new(format!("arm {error}")))?;
            arms.push(arm);
        }
        let first = &arms[0];
        let setup =
            StudySetup::with_methods(plan, first.robot.clone(), first.nominal.clone(), &first.truth, own.clone());
        let setup = setup.map_err(Error::new)?.with_closed_loops(armid_sim::closed_loop);
        Ok(Self { setup, arms, robot_text: loaded.text.content })
    }

    /// Is a folder free for this study?
    ///
    /// # Errors
    /// [`Error`] where it holds another one.
    pub fn check_output(&self, folder: &Path) -> Result<(), Error> {
        check_output(folder, &self.setup.plan, &self.setup.own)
    }

    pub(super) fn performance<'a>(
        &'a self,
        output: &'a Path,
        part: Part,
        observer: &'a dyn Observer,
    ) -> Performance<'a> {
        Performance {
            order: self.setup.run_order(),
            setup: &self.setup,
            arms: &self.arms,
            robot_text: &self.robot_text,
            output,
            part,
            starts: usize::MAX,
            observer,
            measured: Mutex::default(),
        }
    }
}
