//! A study being performed: designs and runs on all cores, each kept in a journal as soon as it is finished.

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use armid::experiment::{ExperimentPlan, Sensing};
use armid::provenance::{Provenance, sha256};
use armid::seed::Seed;
use armid::study::radkhah2007::{Reproduction, evaluate_claims};
use armid::study::{Examples, MeasuredMotions, Outcome, ReportInput, RunId, StudyDesign, StudyPlan, StudySetup};
use indicatif::ProgressBar;
use miette::Result;
use rayon::prelude::*;

use armid::model::format::ChainEnds;
use armid_io::output::write_text;
use armid_io::study::{Journal, Piece, plan_text, write_study, write_timing};
use armid_io::{Error, robot};
use armid_sim::BatchRun;

use super::part::{Part, Stage};
use super::report::write_report;
use crate::answers::study as study_answer;
use crate::arms::{ArmKind, Simulation};
use crate::interrupt;
use crate::terminal::{Console, Ending, progress};

/// So many runs are computed together: the lanes of the widest processors.
const TEAM: usize = 8;

/// So many families of a study are shown against their limits.
const SHOWN_FAMILIES: usize = 8;

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
        Ok(Self { setup, simulations })
    }

    pub(crate) fn performance<'a>(&'a self, output: &'a Path, part: Part, console: &'a Console) -> Performance<'a> {
        Performance {
            setup: &self.setup,
            simulations: &self.simulations,
            output,
            part,
            console,
            measured: Mutex::default(),
        }
    }
}

pub(crate) fn in_words(error: impl std::fmt::Display) -> Error {
    Error::new(error.to_string())
}

/// One study being performed.
pub(crate) struct Performance<'a> {
    setup: &'a StudySetup,
    simulations: &'a [Simulation],
    output: &'a Path,
    part: Part,
    console: &'a Console,
    /// What the arm of each condition and truth measures on fresh motions.
    measured: Mutex<BTreeMap<(usize, usize), Arc<MeasuredMotions>>>,
}

/// A design with its bound and the seconds that it took.
type Made = (StudyDesign, Vec<f64>, f64);

/// All finished work.
pub(crate) struct Work {
    designs: Vec<Made>,
    outcomes: Vec<(Outcome, f64)>,
    journal: Journal,
}

impl Performance<'_> {
    /// The arm of the first condition, which single cases and bounds are taken from.
    fn first(&self) -> &Simulation {
        &self.simulations[0]
    }

    /// What decides the rows: stored work with another identity belongs to another study.
    pub(crate) fn identity(&self) -> Result<String, Error> {
        Ok(sha256(&plan_text(self.setup.plan())?))
    }

    /// The journal in the output folder, and what it holds already; the plan stands beside it.
    pub(crate) fn journal(&self, resume: bool) -> Result<(Journal, Vec<Piece>)> {
        let opened = Journal::open(self.output, &self.identity()?, resume)?;
        self.check(&opened.1)?;
        write_text(&self.output.join("study.toml"), &plan_text(self.setup.plan())?)?;
        Ok(opened)
    }

    /// Every run of the study, or of its part.
    fn planned(&self) -> Vec<RunId> {
        let all = self.setup.run_ids().into_iter().enumerate();
        all.filter(|(position, _)| self.part.holds(*position)).map(|(_, id)| id).collect()
    }

    /// Which part this is.
    pub(crate) fn part(&self) -> Part {
        self.part
    }

    /// Where it is stored.
    pub(crate) fn output(&self) -> &Path {
        self.output
    }

    /// How many designs belong to this part.
    pub(crate) fn planned_designs(&self) -> usize {
        (0..self.setup.designs().len()).filter(|&index| self.part.holds(index)).count()
    }

    /// How many runs belong to this part.
    pub(crate) fn planned_runs(&self) -> usize {
        self.planned().len()
    }

    /// Every piece is one of this study.
    pub(crate) fn check(&self, pieces: &[Piece]) -> Result<()> {
        for piece in pieces {
            piece.check(self.setup).map_err(|error| Error::new(format!("{}: {error}", Journal::NAME)))?;
        }
        Ok(())
    }

    /// How many planned runs are not among the pieces.
    pub(crate) fn missing(&self, pieces: &[Piece]) -> usize {
        let have: HashSet<RunId> = pieces
            .iter()
            .filter_map(|piece| match piece {
                Piece::Run { outcome, .. } => Some(outcome.id()),
                Piece::Design { .. } => None,
            })
            .collect();
        self.planned().iter().filter(|key| !have.contains(key)).count()
    }

    /// How many designs of this part are not among the pieces.
    pub(crate) fn missing_designs(&self, pieces: &[Piece]) -> usize {
        let have: HashSet<usize> = pieces
            .iter()
            .filter_map(|piece| match piece {
                Piece::Design { index, .. } => Some(*index),
                Piece::Run { .. } => None,
            })
            .collect();
        (0..self.setup.designs().len()).filter(|index| self.part.holds(*index) && !have.contains(index)).count()
    }

    /// Makes the designs of this part that are not among the pieces yet, and says whether all are there.
    pub(crate) fn perform_designs(&self, journal: Journal, pieces: Vec<Piece>) -> Result<bool> {
        let (mut designs, _) = self.sorted(pieces);
        let mine = (0..designs.len()).filter(|&index| self.part.holds(index) && designs[index].is_none()).collect();
        self.make_designs(mine, &mut designs, &Mutex::new(journal))?;
        Ok((0..designs.len()).all(|index| !self.part.holds(index) || designs[index].is_some()))
    }

    /// Makes the designs, where it is not the stage of the runs alone, and performs the runs that are not among the pieces
    /// yet; `None` where interrupted.
    pub(crate) fn perform(&self, journal: Journal, pieces: Vec<Piece>) -> Result<Option<Work>> {
        let (mut designs, mut outcomes) = self.sorted(pieces);
        let missing: Vec<usize> = (0..designs.len()).filter(|&index| designs[index].is_none()).collect();
        if self.part.stage == Some(Stage::Runs) && !missing.is_empty() {
            let message = format!(
                "{} of {} designs are not there, expected all of them where --designs-from points",
                missing.len(),
                designs.len()
            );
            return Err(Error::new(message).into());
        }
        let journal = Mutex::new(journal);
        self.make_designs(missing, &mut designs, &journal)?;
        let Some(designs) = designs.into_iter().collect::<Option<Vec<Made>>>() else { return Ok(None) };
        let complete = self.perform_runs(&designs, &mut outcomes, &journal)?;
        let journal = journal.into_inner().map_err(in_words)?;
        Ok(complete.then_some(Work { designs, outcomes, journal }))
    }

    /// The designs by their place, and the outcomes.
    fn sorted(&self, pieces: Vec<Piece>) -> (Vec<Option<Made>>, Vec<(Outcome, f64)>) {
        let mut designs: Vec<Option<Made>> = vec![None; self.setup.designs().len()];
        let mut outcomes: Vec<(Outcome, f64)> = Vec::new();
        for piece in pieces {
            match piece {
                Piece::Design { index, design, bound, seconds } => {
                    let bound = bound.into_iter().map(|std| std.unwrap_or(f64::INFINITY)).collect();
                    designs[index] = Some((*design, bound, seconds));
                }
                Piece::Run { outcome, seconds } => outcomes.push((*outcome, seconds)),
            }
        }
        (designs, outcomes)
    }

    /// Makes the designs at these places.
    fn make_designs(&self, missing: Vec<usize>, designs: &mut [Option<Made>], journal: &Mutex<Journal>) -> Result<()> {
        let planned = self.setup.designs();
        let bar = progress::bar(self.console, missing.len() as u64, "designs");
        let made = missing
            .into_par_iter()
            .filter(|_| !interrupt::asked())
            .map(|index| {
                let begin = Instant::now();
                let (family, start) = planned[index];
                let mut sequence = self.setup.designs_of_sequence(family, start).map_err(in_words)?;
                let bound = self.bound(&sequence)?;
                let design = sequence.pop().ok_or_else(|| Error::new("a sequence without designs"))?;
                let made = (design, bound, begin.elapsed().as_secs_f64());
                let (design, bound, seconds) = made.clone();
                let bound = bound.into_iter().map(|std| std.is_finite().then_some(std)).collect();
                keep(journal, &bar, &Piece::Design { index, design: Box::new(design), bound, seconds })?;
                Ok((index, made))
            })
            .collect::<Result<Vec<_>>>()?;
        bar.finish_and_clear();
        for (index, made) in made {
            designs[index] = Some(made);
        }
        Ok(())
    }

    /// The bound after the experiments of all designs of a sequence.
    fn bound(&self, sequence: &[StudyDesign]) -> Result<Vec<f64>> {
        let mut exact = Vec::new();
        for design in sequence {
            let plan = self.setup.experiment(&design.trajectory);
            match self.first().exact_period(&plan) {
                Ok(states) => exact.push(states),
                // A motion that runs away has no bound; its runs say why.
                Err(_) => return Ok(vec![f64::INFINITY; self.setup.base().rank()]),
            }
        }
        Ok(self.setup.bound_of_sequence(&exact))
    }

    /// Whether all runs are there.
    fn perform_runs(
        &self,
        designs: &[Made],
        outcomes: &mut Vec<(Outcome, f64)>,
        journal: &Mutex<Journal>,
    ) -> Result<bool> {
        let have: HashSet<RunId> = outcomes.iter().map(|(outcome, _)| outcome.id()).collect();
        let planned: Vec<RunId> = self.planned().into_iter().filter(|key| !have.contains(key)).collect();
        let count = planned.len();
        let bar = progress::bar(self.console, count as u64, "runs");
        let performed = self
            .teams(planned)
            .into_par_iter()
            .filter(|_| !interrupt::asked())
            .map(|team| {
                let begin = Instant::now();
                let outcomes = self.perform_team(&team, designs)?;
                // Runs that are computed together share their time.
                let seconds = begin.elapsed().as_secs_f64() / outcomes.len() as f64;
                for outcome in &outcomes {
                    keep(journal, &bar, &Piece::Run { outcome: Box::new(outcome.clone()), seconds })?;
                }
                Ok(outcomes.into_iter().map(|outcome| (outcome, seconds)).collect::<Vec<_>>())
            })
            .collect::<Result<Vec<_>>>()?;
        let performed: Vec<(Outcome, f64)> = performed.into_iter().flatten().collect();
        bar.finish_and_clear();
        let complete = performed.len() == count;
        outcomes.extend(performed);
        outcomes.sort_by_key(|(outcome, _)| outcome.id());
        outcomes.dedup_by_key(|(outcome, _)| outcome.id());
        Ok(complete)
    }

    /// Runs on the same arm under the same condition, as many as are computed together; fewer where that leaves a thread
    /// without work.
    fn teams(&self, mut runs: Vec<RunId>) -> Vec<Vec<RunId>> {
        let most = runs.len().div_ceil(rayon::current_num_threads()).clamp(1, TEAM);
        let arm = |id: &RunId| (id.condition, self.setup.plan().truth_of(id.run));
        runs.sort_by_key(arm);
        runs.chunk_by(|a, b| arm(a) == arm(b)).flat_map(|alike| alike.chunks(most)).map(<[RunId]>::to_vec).collect()
    }

    /// The outcomes of runs on one arm under one condition.
    fn perform_team(&self, team: &[RunId], designs: &[Made]) -> Result<Vec<Outcome>> {
        let Some(first) = team.first() else { return Ok(Vec::new()) };
        let simulation = self.simulations[first.condition].made_of(self.setup.truth(first.run));
        let plans: BTreeMap<usize, ExperimentPlan> = team
            .iter()
            .flat_map(|id| self.setup.sequence(id.design))
            .map(|index| (index, self.setup.experiment(&designs[index].0.trajectory)))
            .collect();
        let mut runs = Vec::new();
        for id in team {
            for index in self.setup.sequence(id.design) {
                let (seed, run) = self.setup.stream(index, id.run);
                runs.push(BatchRun { plan: &plans[&index], seed, run });
            }
        }
        let measured = self.measured_motions(first, &simulation)?;
        let mut performed = simulation.record_all(&runs).map_err(in_words)?.into_iter();
        let outcome = |&id: &RunId| {
            let of_run = performed.by_ref().take(self.setup.sequence(id.design).len()).collect();
            self.setup.outcome(id, of_run, measured.as_deref())
        };
        Ok(team.iter().map(outcome).collect())
    }

    /// What the arm of a run measures on fresh motions, performed once for each arm and condition; `None` where the plan
    /// asks for none.
    fn measured_motions(&self, id: &RunId, simulation: &Simulation) -> Result<Option<Arc<MeasuredMotions>>> {
        let plan = self.setup.plan();
        if plan.validation.measured == 0 {
            return Ok(None);
        }
        let arm = (id.condition, plan.truth_of(id.run));
        if let Some(known) = self.measured.lock().map_err(in_words)?.get(&arm) {
            return Ok(Some(Arc::clone(known)));
        }
        let plans = (0..plan.validation.measured as u64)
            .map(|index| Ok(self.setup.experiment(&self.setup.validation_trajectory(index).map_err(in_words)?)))
            .collect::<Result<Vec<ExperimentPlan>>>()?;
        let seed = plan.seed.child("measured motion", arm.1 as u64);
        let runs: Vec<BatchRun<'_>> = plans.iter().zip(0..).map(|(plan, run)| BatchRun { plan, seed, run }).collect();
        let performed = simulation.record_all(&runs).map_err(in_words)?;
        let measured = self.setup.measured_motions(performed).map_err(|failure| {
            let name = &plan.conditions()[id.condition].name;
            Error::new(format!("a fresh motion under condition \"{name}\" cannot be measured: {}", failure.reason))
        })?;
        // Two threads may have measured the same; the second finds the same numbers.
        Ok(Some(Arc::clone(self.measured.lock().map_err(in_words)?.entry(arm).or_insert_with(|| Arc::new(measured)))))
    }

    /// Sums up, stores everything, and writes the report.
    pub(crate) fn finish(&self, work: Work) -> Result<Ending> {
        self.console.note("summing up");
        let Work { designs, outcomes, journal } = work;
        let design_seconds: Vec<f64> = designs.iter().map(|(_, _, seconds)| *seconds).collect();
        let (designs, bounds): (Vec<StudyDesign>, Vec<Vec<f64>>) =
            designs.into_iter().map(|(design, bound, _)| (design, bound)).unzip();
        let (outcomes, run_seconds): (Vec<Outcome>, Vec<f64>) = outcomes.into_iter().unzip();
        let conditions = self.setup.conditions(&designs, &bounds, &outcomes);
        let effect_sensitivity = self.setup.effect_sensitivity(&designs, &conditions, &outcomes);
        let radkhah2007 = if self.setup.plan().radkhah2007_claims {
            let arm = |sensing: &Sensing, seed: Seed, run: u64| self.first().arm(sensing, seed, run);
            let (claims, table) =
                evaluate_claims(self.setup, &self.first().truth, &designs, &conditions[0].findings, &arm)
                    .map_err(in_words)?;
            Some(Reproduction { claims, table })
        } else {
            None
        };
        let examples = self.examples(&designs, &outcomes)?;
        let seed = self.setup.plan().seed;
        let provenance = Provenance::new(self.setup.robot().name(), &self.first().loaded.text.content, Some(seed));
        let result = self.setup.result(provenance, designs, bounds, (conditions, effect_sensitivity), radkhah2007);
        let input = ReportInput { result, examples };
        write_study(self.output, &input, &outcomes)?;
        write_timing(self.output, &design_seconds, &outcomes, &run_seconds, rayon::current_num_threads())?;
        let failed = outcomes.iter().filter(|outcome| outcome.failure.is_some()).count();
        // Where every run failed there is nothing to draw; the rows and the summary say how each ended.
        let report: Option<PathBuf> =
            if failed < outcomes.len() { Some(write_report(&self.output.join("report"), &input)?) } else { None };
        journal.remove()?;
        self.console.show(&study_answer::answer(&input.result, outcomes.len(), failed, report.as_deref()))?;
        Ok(if failed == outcomes.len() { Ending::Negative } else { Ending::Done })
    }

    /// The best design of each family against its limits, and the first validation experiment against what a median
    /// run of the best one predicts.
    fn examples(&self, designs: &[StudyDesign], outcomes: &[Outcome]) -> Result<Examples> {
        let best = |family: usize| {
            let of_family = designs.iter().enumerate().filter(|(_, design)| design.family == family);
            of_family.min_by(|(_, a), (_, b)| a.own_value().total_cmp(&b.own_value()))
        };
        let families = self.setup.plan().designs.len().min(SHOWN_FAMILIES);
        let limits =
            (0..families).filter_map(best).map(|(index, design)| self.setup.limit_example(index, design)).collect();
        let shown = best(0).and_then(|(index, design)| {
            let outcome = outcomes.iter().find(|o| (o.design, o.condition) == (index, 0) && o.failure.is_none())?;
            Some((design, outcome.run, outcome.estimates.iter().rev().find(|estimate| estimate.score.is_some())?))
        });
        let prediction = match shown {
            Some((design, run, estimate)) => {
                let seed = self.setup.plan().seed.child("validation experiment", 0);
                let simulation = self.first().made_of(self.setup.truth(run));
                let mut arm = simulation.arm(&Sensing::default(), seed, 0).map_err(in_words)?;
                let trajectory = self.setup.validation_trajectory(0).map_err(in_words)?;
                let samples = self.setup.samples(&trajectory, &mut *arm).ok();
                samples.map(|samples| self.setup.prediction_example(design, estimate, &samples))
            }
            None => None,
        };
        Ok(Examples { limits, prediction })
    }
}

fn keep(journal: &Mutex<Journal>, bar: &ProgressBar, piece: &Piece) -> Result<()> {
    journal.lock().map_err(in_words)?.add(piece)?;
    bar.inc(1);
    Ok(())
}
