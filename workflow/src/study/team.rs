//! Runs that are computed together.

use std::collections::BTreeMap;
use std::sync::Arc;

use armid::experiment::ExperimentPlan;
use armid::study::{MeasuredMotions, Outcome, RunId};
use armid_io::Error;
use armid_io::study::MadeDesign;
use armid_sim::{BatchRun, SimulatedArm};

use super::performance::Performance;
use crate::counter::Latch;

/// So many runs are computed together: the lanes of the widest processors.
const TEAM: usize = 8;

impl Performance<'_> {
    /// Runs on the same arm under the same condition, as many as are computed together; fewer where that leaves a thread
    /// without work.
    pub(super) fn teams(&self, mut runs: Vec<RunId>) -> Vec<Vec<RunId>> {
        let most = runs.len().div_ceil(rayon::current_num_threads()).clamp(1, TEAM);
        let arm = |id: &RunId| (id.condition, self.setup.plan.truth_of(id.run));
        runs.sort_by_key(arm);
        runs.chunk_by(|a, b| arm(a) == arm(b)).flat_map(|alike| alike.chunks(most)).map(<[RunId]>::to_vec).collect()
    }

    /// The outcomes of runs on one arm under one condition: of those that were finished when an observer ended the work.
    pub(super) fn perform_team(&self, team: &[RunId], designs: &[Option<MadeDesign>]) -> Result<Vec<Outcome>, Error> {
        let Some(first) = team.first() else { return Ok(Vec::new()) };
        let arm = self.arms[first.condition].with_truth(self.setup.truth(first.run));
        let mut plans: BTreeMap<usize, ExperimentPlan> = BTreeMap::new();
        for index in team.iter().flat_map(|id| self.setup.sequence(id.design)) {
            let made = designs[index].as_ref().ok_or_else(|| Error::new(format!("design {index} is not made")))?;
            plans.entry(index).or_insert_with(|| self.setup.experiment(&made.design.trajectory));
        }
        let mut runs = Vec::new();
        for id in team {
            for index in self.setup.sequence(id.design) {
                runs.push(BatchRun { plan: &plans[&index], noise: self.setup.noise_of(index, id.run) });
            }
        }
        let latch = Latch::new(self.observer);
        let measured = self.measured_motions(first, &arm, &latch)?;
        let mut performed = arm.record_all(&runs, &latch).map_err(Error::new)?.into_iter();
        let mut outcomes = Vec::new();
        for &id in team {
            let of_run = performed.by_ref().take(self.setup.sequence(id.design).len()).collect();
            if latch.has_ended() {
                break;
            }
            let outcome = self.setup.outcome(id, of_run, measured.as_deref(), &latch);
            if !latch.has_ended() {
                outcomes.push(outcome);
            }
        }
        Ok(outcomes)
    }

    /// What the arm of a run measures on fresh motions, performed once for each arm and condition; `None` where the plan
    /// asks for none, or an observer ended the work.
    fn measured_motions(
        &self,
        id: &RunId,
        simulated: &SimulatedArm,
        latch: &Latch<'_>,
    ) -> Result<Option<Arc<MeasuredMotions>>, Error> {
        let plan = &self.setup.plan;
        if plan.validation.measured == 0 {
            return Ok(None);
        }
        let arm = (id.condition, plan.truth_of(id.run));
        if let Some(known) = self.measured.lock().map_err(Error::new)?.get(&arm) {
            return Ok(Some(Arc::clone(known)));
        }
        let motions = self.setup.validation.measured.iter();
        let plans: Vec<ExperimentPlan> = motions.map(|motion| self.setup.experiment(motion)).collect();
        let seed = plan.seed.child("measured motion", arm.1 as u64);
        let runs: Vec<BatchRun<'_>> =
            plans.iter().zip(0..).map(|(plan, run)| BatchRun { plan, noise: seed.of_run(run) }).collect();
        let performed = simulated.record_all(&runs, latch).map_err(Error::new)?;
        if latch.has_ended() {
            return Ok(None);
        }
        let measured = self.setup.measured_motions(performed).map_err(|failure| {
            let name = &plan.conditions()[id.condition].name;
            Error::new(format!("a fresh motion under condition \"{name}\" cannot be measured: {}", failure.reason))
        })?;
        // Two threads may have measured the same; the second finds the same numbers.
        Ok(Some(Arc::clone(self.measured.lock().map_err(Error::new)?.entry(arm).or_insert_with(|| Arc::new(measured)))))
    }
}
