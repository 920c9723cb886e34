//! A study and its arms, before anything is performed.

use std::path::Path;
use std::sync::Mutex;

use armid::experiment::Sensing;
use armid::model::format::ChainEnds;
use armid::study::{StudyPlan, StudySetup};
use armid_io::{Error, robot};
use miette::Result;

use super::in_words;
use super::part::Part;
use super::performance::Performance;
use crate::arms::{ArmKind, Simulation};
use crate::terminal::Console;

/// A study and the arms that it is performed on, one per condition.
pub(crate) struct Prepared {
    setup: StudySetup,
    simulations: Vec<Simulation>,
}

impl Prepared {
    /// Everything that a study needs before its first design; an arm that cannot be built is found here.
    pub(crate) fn new(plan: StudyPlan, beside: Option<&Path>) -> Result<Self> {
        let loaded = robot::load(&plan.robot, &ChainEnds::default(), beside)?;
        let simulations = plan
            .conditions()
            .iter()
            .map(|condition| {
                let arm = ArmKind::parse(&condition.engine)
                    .ok_or_else(|| Error::new(format!("there is no engine \"{}\"", condition.engine)))?;
                let simulation =
                    Simulation::of(loaded.clone(), arm)?.with_effects(plan.effects.and(&condition.effects));
                simulation.servo(&Sensing::ideal()).map_err(|error| Error::new(format!("arm {error}")))?;
                Ok(simulation)
            })
            .collect::<Result<Vec<_>>>()?;
        let first = &simulations[0];
        let (robot, nominal) = (first.robot().clone(), first.nominal.clone());
        let setup = StudySetup::new(plan, robot, nominal, &first.truth).map_err(in_words)?;
        let setup = setup.with_closed_loops(armid_sim::closed_loop);
        Ok(Self { setup, simulations })
    }

    pub(crate) fn performance<'a>(&'a self, output: &'a Path, part: Part, console: &'a Console) -> Performance<'a> {
        Performance {
            order: self.setup.run_order(),
            setup: &self.setup,
            simulations: &self.simulations,
            output,
            part,
            starts: usize::MAX,
            console,
            measured: Mutex::default(),
        }
    }
}
