//! What a study would cost, before any of it is performed.

use std::path::Path;
use std::time::Instant;

use armid::observer::Unobserved;
use armid::study::{Metric, RunId, StudyPlan};
use armid_io::Error;
use armid_io::study::{MadeDesign, Piece};

use super::part::Part;
use super::performance::Performance;
use super::prepared::PreparedStudy;
use super::processor_time::processor_seconds;
use super::team::TEAM;
use crate::counter::Latch;

/// Evaluations of a design that is made to see how long one takes.
pub const SAMPLE_EVALUATIONS: usize = 20;

/// After so many seconds no further family is tried, and no further condition; those that were not cost what the others do in
/// the mean.
const PATIENCE_S: f64 = 20.0;

/// Bytes of memory for each run that is planned: where it stands in its journal.
const HELD_OF_RUN: usize = 8;

/// Bytes of memory for each run under one condition while it is summed up: values, logarithms, copies that are sorted, draws.
const SUMMED_OF_RUN: usize = 100;

/// Bytes of memory for rows that wait to be written together, and what allocators keep of them.
const ROWS: usize = 45_000_000;

/// What a study costs, by a timed sample of it.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Forecast {
    /// Number of designs.
    pub designs: usize,
    /// Number of runs.
    pub runs: usize,
    /// Number of conditions.
    pub conditions: usize,
    /// Number of true arms.
    pub truths: usize,
    /// Processor time of the designs, at most, h.
    pub design_core_hours: f64,
    /// Processor time of the runs, h.
    pub run_core_hours: f64,
    /// Finished work, until the results are there.
    pub journal_bytes: u64,
    /// Numbers for the statistics, while the study runs.
    pub numbers_bytes: u64,
    /// What stays.
    pub results_bytes: u64,
    /// At most at any time; `None` where this machine does not say what the sample took.
    pub memory_bytes: Option<u64>,
    /// Time that the sample took, s.
    pub sample_seconds: f64,
    /// Designs in the sample.
    pub sample_designs: usize,
    /// Runs in the sample.
    pub sample_runs: usize,
    /// Conditions in the sample.
    pub sample_conditions: usize,
    /// What runs have in common, a sentence each.
    pub shared: Vec<String>,
}

/// What the runs that were tried cost, in the mean.
struct RunSample {
    /// Processor seconds of a run.
    of_run: f64,
    /// Processor seconds of what all runs on an arm share, done once for each.
    of_arm: f64,
    /// Bytes of a run in its journal.
    journal_bytes: f64,
    runs: usize,
    conditions: usize,
}

/// Times some designs and runs of a study, and says what all of it costs. Relative paths of the plan begin at `beside`.
///
/// # Errors
/// [`Error`] where the study cannot be prepared, or a run of the sample cannot be performed.
pub fn forecast(plan: &StudyPlan, beside: Option<&Path>) -> Result<Forecast, Error> {
    let sample = PreparedStudy::new(sample_plan(plan), beside)?;
    sample.performance(Path::new(""), Part::default(), &Unobserved).forecast(plan)
}

/// A plan whose designs are searched for a moment only.
fn sample_plan(plan: &StudyPlan) -> StudyPlan {
    let mut sample = plan.clone();
    for family in &mut sample.designs {
        family.evaluations = family.evaluations.min(SAMPLE_EVALUATIONS);
    }
    sample
}

impl Performance<'_> {
    /// Times some designs and runs of this study, which is that of [`sample_plan`], and says what `plan` costs.
    fn forecast(&self, plan: &StudyPlan) -> Result<Forecast, Error> {
        let begin = Instant::now();
        let (design_seconds, designs, sample_designs) = self.time_designs(plan)?;
        let sample = self.time_runs(&designs)?;
        let truths = self.setup.scorer().truths().len().saturating_sub(1).max(1);
        let runs = self.order.len();
        let rows = plan.identification.estimators.len();
        let (b, n) = (self.setup.base().rank(), self.setup.robot().dof());
        // Estimate, standard deviation and half width of each parameter, metrics and residuals of each run, its wall time.
        let metrics = Metric::ALL.iter().filter(|metric| !metric.is_logarithmic()).count();
        let of_run = rows * 8 * (3 * b + metrics + n) + 8;
        let of_condition = runs / self.order.conditions();
        let held = (ROWS + HELD_OF_RUN * runs + SUMMED_OF_RUN * of_condition) as u64;
        Ok(Forecast {
            designs: self.order.designs(),
            runs,
            conditions: self.order.conditions(),
            truths,
            design_core_hours: design_seconds / 3600.0,
            run_core_hours: (sample.of_run * runs as f64 + sample.of_arm * (self.order.conditions() * truths) as f64)
                / 3600.0,
            journal_bytes: (sample.journal_bytes * runs as f64) as u64,
            numbers_bytes: (self.setup.run_numbers().len() * 8 * runs) as u64,
            results_bytes: (of_run * runs) as u64,
            memory_bytes: most_memory().map(|sample| sample + held),
            sample_seconds: begin.elapsed().as_secs_f64(),
            sample_designs,
            sample_runs: sample.runs,
            sample_conditions: sample.conditions,
            shared: self.shared(),
        })
    }

    /// Times a team of runs under each condition, as long as patience lasts.
    fn time_runs(&self, designs: &[Option<MadeDesign>]) -> Result<RunSample, Error> {
        let (mut of_runs, mut of_arms, mut journal, mut runs, mut conditions) = (0.0, 0.0, 0.0, 0, 0);
        for condition in self.spread_conditions() {
            let team = self.sample_team(condition, designs);
            let Some(first) = team.first().filter(|_| of_runs + of_arms < PATIENCE_S) else { break };
            let begin = processor_seconds();
            let arm = self.arms[condition].made_of(self.setup.truth(first.run));
            self.measured_motions(first, &arm, &Latch::new(self.observer))?;
            let shared = processor_seconds() - begin;
            let begin = processor_seconds();
            let mut outcomes = Vec::new();
            // Teams as they are performed: a study of many truths has few runs on each arm.
            for team in self.teams(team.clone()) {
                outcomes.extend(self.perform_team(&team, designs)?);
            }
            let spent = processor_seconds() - begin;
            for outcome in outcomes {
                let piece = Piece::Run { outcome: Box::new(outcome), seconds: spent };
                journal += serde_json::to_string(&piece).map_err(Error::of)?.len() as f64;
            }
            (of_runs, of_arms) = (of_runs + spent, of_arms + shared);
            (runs, conditions) = (runs + team.len(), conditions + 1);
        }
        let (tried, arms) = (runs.max(1) as f64, conditions.max(1) as f64);
        Ok(RunSample {
            of_run: of_runs / tried,
            of_arm: of_arms / arms,
            journal_bytes: journal / tried,
            runs,
            conditions,
        })
    }

    /// The conditions, those next to each other, which are often alike, far apart: 0, 1/2, 1/4, 3/4, 1/8, … of the way.
    fn spread_conditions(&self) -> Vec<usize> {
        let count = self.order.conditions();
        let bits = usize::BITS - count.saturating_sub(1).leading_zeros();
        let mirrored = |index: usize| index.reverse_bits().checked_shr(usize::BITS - bits).unwrap_or(0);
        (0..1_usize << bits).map(mirrored).filter(|&condition| condition < count).collect()
    }

    /// Runs under a condition, one of each design that was made, and the next of each, as many as are computed together.
    fn sample_team(&self, condition: usize, designs: &[Option<MadeDesign>]) -> Vec<RunId> {
        let most = designs.iter().enumerate().filter(|(_, made)| made.is_some()).map(|(i, _)| self.order.runs(i)).max();
        let of_run = |run| {
            let made = designs.iter().enumerate().filter(|(_, made)| made.is_some()).map(|(design, _)| design);
            made.filter(move |&design| run < self.order.runs(design) as u64).map(move |design| RunId {
                design,
                condition,
                run,
            })
        };
        (0..most.unwrap_or(0) as u64).flat_map(of_run).take(TEAM).collect()
    }

    /// Processor seconds of all designs of `plan`, a design for each place to try runs with, and how many were made.
    fn time_designs(&self, plan: &StudyPlan) -> Result<(f64, Vec<Option<MadeDesign>>, usize), Error> {
        let (planned, begin) = (self.setup.designs(), Instant::now());
        let mut of_families: Vec<Option<(f64, MadeDesign)>> = vec![None; plan.designs.len()];
        let mut tried = Vec::new();
        for (family, of_family) in of_families.iter_mut().enumerate() {
            if begin.elapsed().as_secs_f64() > PATIENCE_S {
                break;
            }
            let begin = processor_seconds();
            let mut sequence = self.setup.designs_of_sequence(family, 0, self.observer).map_err(Error::of)?;
            let used: usize = sequence.iter().map(|design| design.evaluations).sum();
            let searched = processor_seconds() - begin;
            let bound = self.bound(&sequence)?;
            let bounded = processor_seconds() - begin - searched;
            let design = sequence.pop().ok_or_else(|| Error::new("a sequence without designs"))?;
            let of_evaluation = searched / used.max(1) as f64;
            let seconds = of_evaluation * plan.designs[family].evaluations.max(1) as f64 + bounded;
            tried.push((of_evaluation, bounded));
            *of_family = Some((seconds, MadeDesign { design, bound, seconds }));
        }
        let count = tried.len().max(1) as f64;
        let of_evaluation = tried.iter().map(|(seconds, _)| seconds).sum::<f64>() / count;
        let bounded = tried.iter().map(|(_, seconds)| seconds).sum::<f64>() / count;
        let seconds = planned.iter().map(|&(family, _)| match &of_families[family] {
            Some((seconds, _)) => *seconds,
            None => of_evaluation * plan.designs[family].evaluations as f64 + bounded,
        });
        let designs = planned.iter().map(|&(family, _)| of_families[family].clone().map(|(_, made)| made));
        Ok((seconds.sum(), designs.collect(), tried.len()))
    }

    /// What runs have in common.
    fn shared(&self) -> Vec<String> {
        let plan = self.setup.plan();
        let mut shared = vec![
            format!("each design is made once, for all of its runs ({})", runs_of(plan)),
            "start k of every family begins at the same first guess".to_owned(),
            format!("{} validation motions of each of four kinds score every estimate", plan.validation.trajectories),
        ];
        if self.order.conditions() > 1 {
            shared.push("a run has the same noise under every condition".to_owned());
        }
        if let Some(truths) = &plan.truths {
            shared.push(format!("run r of every design is on arm r modulo {}", truths.count));
        }
        if plan.identification.estimators.len() > 1 {
            shared.push("all estimators read the same recording, factorised once".to_owned());
        }
        shared
    }
}

fn runs_of(plan: &StudyPlan) -> String {
    let runs = (0..plan.designs.len()).map(|family| plan.runs_of(family));
    match (runs.clone().min(), runs.max()) {
        (Some(least), Some(most)) if least != most => format!("{least} to {most}"),
        (least, _) => least.unwrap_or(0).to_string(),
    }
}

/// The most memory that this process has held, bytes, where the system says so.
fn most_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

impl Forecast {
    /// Of designs, at most, and runs.
    #[must_use]
    pub const fn core_hours(&self) -> f64 {
        self.design_core_hours + self.run_core_hours
    }
}
