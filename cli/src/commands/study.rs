//! `armid study`

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

use armid::experiment::Sensing;
use armid::provenance::{Provenance, sha256};
use armid::seed::Seed;
use armid::study::paper::examine;
use armid::study::{Examples, Outcome, PaperResult, Stage, StudyDesign, StudyPlan, StudyStory};
use indicatif::ProgressBar;
use miette::Result;
use rayon::prelude::*;

use crate::answer::{Answer, Ending};
use crate::arms::ArmKind;
use crate::atomic_file::write_text;
use crate::console::Console;
use crate::fault::Fault;
use crate::files::journal::{Journal, Piece};
use crate::files::study_store::{plan_text, write_report, write_study, write_timing};
use crate::simulated_arm::Simulation;
use crate::{choices, interrupt, progress, study_answer, study_source};

const AFTER_HELP: &str = "\
A study designs trajectories, performs simulated experiments with each, estimates, and scores against
the truth. Equal plan and seed give the same bytes for any number of threads; wall times and dates are
in timing.parquet and provenance.json alone.

Ctrl-C and kill lose no finished run: --resume goes on with what is there.

Examples:
  armid study experiments/01-criteria             the bundled study, into reports/01-criteria/
  armid study experiments/01-criteria --runs 100  more runs of each design
  armid study my/study.toml --jobs 1 -o out --resume";

/// Run a Monte Carlo study of designs and estimators
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Option<Action>,
    /// A bundled study, a folder with a study.toml, or the file itself
    #[arg(required = true)]
    study: Option<String>,
    /// Runs of each design, in place of the plan's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    runs: Option<u32>,
    /// Threads; all cores where absent
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    jobs: Option<u32>,
    /// Go on with the finished work in the output folder
    #[arg(long)]
    resume: bool,
    /// Perform only part K of N of the runs; `armid study merge` puts the parts together
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Which simulated arm performs the experiments
    #[arg(long, default_value = "analytic", value_parser = choices::one_of(&ArmKind::SIMULATED, ArmKind::name))]
    arm: ArmKind,
}

/// What to do with studies that have been performed in parts.
#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Put the parts of a study together: folders that --shard wrote
    Merge {
        /// The folders of all parts
        #[arg(required = true, value_name = "DIR")]
        folders: Vec<PathBuf>,
    },
}

/// Part `k` of `n`, counted from one.
#[derive(Clone, Copy, Debug)]
struct Shard {
    k: usize,
    n: usize,
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((k, n)) if 1 <= k && k <= n => Ok(Self { k, n }),
            _ => Err("expected K/N with 1 ≤ K ≤ N, as 2/8".to_owned()),
        }
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    if let Some(Action::Merge { folders }) = &arguments.action {
        return merge(folders, console);
    }
    let (mut plan, folder) = study_source::load(arguments.study.as_deref().unwrap_or_default())?;
    if let Some(runs) = arguments.runs {
        plan.scale_runs(runs as usize);
    }
    let output = output_folder(&plan, console);
    let prepared = Prepared::new(plan, folder.as_deref(), arguments.arm)?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.jobs.map_or(0, |jobs| jobs as usize))
        .build()
        .map_err(in_words)?;
    threads.install(|| {
        let study = prepared.performance(&output, arguments.shard, console);
        let (journal, pieces) = study.journal(arguments.resume)?;
        match (study.perform(journal, pieces)?, arguments.shard) {
            (Some(work), None) => study.finish(work),
            (Some(_), Some(shard)) => {
                let message = format!(
                    "part {} of {} is in {}; put the parts together with armid study merge",
                    shard.k,
                    shard.n,
                    output.display()
                );
                console.show(&Answer {
                    json: serde_json::json!({ "shard": output, "k": shard.k, "n": shard.n }),
                    text: message + "\n",
                })?;
                Ok(Ending::Done)
            }
            (None, _) => {
                console.note(format!("interrupted; go on with --resume -o {}", output.display()));
                Ok(Ending::Interrupted)
            }
        }
    })
}

/// Puts parts together; every piece must be there, since a merge performs nothing.
fn merge(folders: &[PathBuf], console: &Console) -> Result<Ending> {
    let (plan, _) = study_source::load(&folders[0].display().to_string())?;
    let path = |folder: &Path| folder.join(Journal::NAME);
    let name = Journal::arm(&path(&folders[0]))?;
    let arm =
        ArmKind::parse(&name).ok_or_else(|| Fault::new(format!("the parts were performed by an arm \"{name}\"")))?;
    let output = output_folder(&plan, console);
    let prepared = Prepared::new(plan, Some(&folders[0]), arm)?;
    let study = prepared.performance(&output, None, console);
    let identity = study.identity()?;
    let mut pieces = Vec::new();
    for folder in folders {
        pieces.extend(Journal::read(&path(folder), &identity, arm.name())?);
    }
    let missing = study.missing(&pieces);
    if missing > 0 {
        let message = format!("{missing} runs are in none of the folders, expected every part of the study, complete");
        return Err(Fault::new(message).into());
    }
    let (mut journal, _) = study.journal(false)?;
    for piece in &pieces {
        journal.add(piece)?;
    }
    match study.perform(journal, pieces)? {
        Some(work) => study.finish(work),
        None => Ok(Ending::Interrupted),
    }
}

fn output_folder(plan: &StudyPlan, console: &Console) -> PathBuf {
    console.output().map_or_else(|| Path::new("reports").join(&plan.name), Path::to_path_buf)
}

/// A study and the arm that it is performed on.
struct Prepared {
    stage: Stage,
    simulation: Simulation,
}

impl Prepared {
    fn new(plan: StudyPlan, beside: Option<&Path>, arm: ArmKind) -> Result<Self> {
        let simulation = Simulation::load(&plan.robot, beside, arm)?;
        let (robot, nominal) = (simulation.robot().clone(), simulation.nominal.clone());
        let stage = Stage::new(plan, robot, nominal, &simulation.truth).map_err(in_words)?;
        Ok(Self { stage, simulation })
    }

    fn performance<'a>(&'a self, output: &'a Path, shard: Option<Shard>, console: &'a Console) -> Performance<'a> {
        Performance { stage: &self.stage, simulation: &self.simulation, output, shard, console }
    }
}

fn in_words(error: impl std::fmt::Display) -> Fault {
    Fault::new(error.to_string())
}

/// One study being performed.
struct Performance<'a> {
    stage: &'a Stage,
    simulation: &'a Simulation,
    output: &'a Path,
    shard: Option<Shard>,
    console: &'a Console,
}

/// A design with its bound and the seconds that it took.
type Made = (StudyDesign, Vec<f64>, f64);

/// All finished work.
struct Work {
    designs: Vec<Made>,
    outcomes: Vec<(Outcome, f64)>,
    journal: Journal,
}

impl Performance<'_> {
    /// What decides the rows: stored work with another identity belongs to another study.
    fn identity(&self) -> Result<String> {
        Ok(sha256(&plan_text(self.stage.plan())?))
    }

    /// The journal in the output folder, and what it holds already; the plan stands beside it.
    fn journal(&self, resume: bool) -> Result<(Journal, Vec<Piece>)> {
        let opened = Journal::open(self.output, &self.identity()?, self.simulation.arm.name(), resume)?;
        write_text(&self.output.join("study.toml"), &plan_text(self.stage.plan())?)?;
        Ok(opened)
    }

    /// Every run of the study, or of its part, as (design, run).
    fn planned(&self) -> Vec<(usize, u64)> {
        let plan = self.stage.plan();
        let slots = self.stage.designs();
        let all = slots
            .iter()
            .enumerate()
            .flat_map(|(index, &(family, _))| (0..plan.runs_of(family) as u64).map(move |run| (index, run)));
        let mine = |position: usize| self.shard.is_none_or(|shard| position % shard.n == shard.k - 1);
        all.enumerate().filter(|(position, _)| mine(*position)).map(|(_, key)| key).collect()
    }

    /// How many planned runs are not among the pieces.
    fn missing(&self, pieces: &[Piece]) -> usize {
        let have: HashSet<(usize, u64)> = pieces
            .iter()
            .filter_map(|piece| match piece {
                Piece::Run { outcome, .. } => Some((outcome.design, outcome.run)),
                Piece::Design { .. } => None,
            })
            .collect();
        self.planned().iter().filter(|key| !have.contains(key)).count()
    }

    /// Makes the designs and performs the runs that are not among the pieces yet; `None` where interrupted.
    fn perform(&self, journal: Journal, pieces: Vec<Piece>) -> Result<Option<Work>> {
        let slots = self.stage.designs();
        let mut designs: Vec<Option<Made>> = vec![None; slots.len()];
        let mut outcomes: Vec<(Outcome, f64)> = Vec::new();
        for piece in pieces {
            match piece {
                Piece::Design { index, design, bound, seconds } => designs[index] = Some((*design, bound, seconds)),
                Piece::Run { outcome, seconds } => outcomes.push((*outcome, seconds)),
            }
        }
        let journal = Mutex::new(journal);
        self.make_designs(&slots, &mut designs, &journal)?;
        let Some(designs) = designs.into_iter().collect::<Option<Vec<Made>>>() else { return Ok(None) };
        let complete = self.perform_runs(&designs, &mut outcomes, &journal)?;
        let journal = journal.into_inner().map_err(in_words)?;
        Ok(complete.then_some(Work { designs, outcomes, journal }))
    }

    fn make_designs(
        &self,
        slots: &[(usize, usize)],
        designs: &mut [Option<Made>],
        journal: &Mutex<Journal>,
    ) -> Result<()> {
        let missing: Vec<usize> = (0..slots.len()).filter(|&index| designs[index].is_none()).collect();
        let bar = progress::bar(self.console, missing.len() as u64, "designs");
        let made = missing
            .into_par_iter()
            .filter(|_| !interrupt::asked())
            .map(|index| {
                let begin = Instant::now();
                let (family, start) = slots[index];
                let design = self.stage.design(family, start).map_err(in_words)?;
                let plan = self.stage.experiment(&design.trajectory);
                let bound = self.stage.bound(&self.simulation.exact_period(&plan).map_err(in_words)?);
                let made = (design, bound, begin.elapsed().as_secs_f64());
                let (design, bound, seconds) = made.clone();
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

    /// Whether all runs are there.
    fn perform_runs(
        &self,
        designs: &[Made],
        outcomes: &mut Vec<(Outcome, f64)>,
        journal: &Mutex<Journal>,
    ) -> Result<bool> {
        let have: HashSet<(usize, u64)> = outcomes.iter().map(|(o, _)| (o.design, o.run)).collect();
        let planned: Vec<(usize, u64)> = self.planned().into_iter().filter(|key| !have.contains(key)).collect();
        let count = planned.len();
        let bar = progress::bar(self.console, count as u64, "runs");
        let performed = planned
            .into_par_iter()
            .filter(|_| !interrupt::asked())
            .map(|(index, run)| {
                let begin = Instant::now();
                let (seed, stream) = self.stage.stream(index, run);
                let mut arm = self.simulation.arm(&Sensing::default(), seed, stream).map_err(in_words)?;
                let outcome = self.stage.trial(index, &designs[index].0, run, &mut *arm);
                let seconds = begin.elapsed().as_secs_f64();
                keep(journal, &bar, &Piece::Run { outcome: Box::new(outcome.clone()), seconds })?;
                Ok((outcome, seconds))
            })
            .collect::<Result<Vec<_>>>()?;
        bar.finish_and_clear();
        let complete = performed.len() == count;
        outcomes.extend(performed);
        outcomes.sort_by_key(|(outcome, _)| (outcome.design, outcome.run));
        outcomes.dedup_by_key(|(outcome, _)| (outcome.design, outcome.run));
        Ok(complete)
    }

    /// Sums up, stores everything, and writes the report.
    fn finish(&self, work: Work) -> Result<Ending> {
        self.console.note("summing up");
        let Work { designs, outcomes, journal } = work;
        let design_seconds: Vec<f64> = designs.iter().map(|(_, _, seconds)| *seconds).collect();
        let (designs, bounds): (Vec<StudyDesign>, Vec<Vec<f64>>) =
            designs.into_iter().map(|(design, bound, _)| (design, bound)).unzip();
        let (outcomes, run_seconds): (Vec<Outcome>, Vec<f64>) = outcomes.into_iter().unzip();
        let findings = self.stage.findings(&designs, &bounds, &outcomes);
        let paper = if self.stage.plan().paper_claims {
            let arm = |sensing: &Sensing, seed: Seed, run: u64| self.simulation.arm(sensing, seed, run);
            let (claims, table) =
                examine(self.stage, &self.simulation.truth, &designs, &findings, &arm).map_err(in_words)?;
            Some(PaperResult { claims, table })
        } else {
            None
        };
        let examples = self.examples(&designs, &outcomes)?;
        let seed = self.stage.plan().seed;
        let provenance = Provenance::new(self.stage.robot().name(), &self.simulation.loaded.text.content, Some(seed));
        let result = self.stage.result(self.simulation.arm.name(), provenance, designs, bounds, findings, paper);
        let story = StudyStory { result, examples };
        write_study(self.output, &story, &outcomes)?;
        write_timing(self.output, &design_seconds, &outcomes, &run_seconds)?;
        let report: PathBuf = write_report(&self.output.join("report"), &story)?;
        journal.remove()?;
        let failed = outcomes.iter().filter(|outcome| outcome.failure.is_some()).count();
        self.console.show(&study_answer::answer(&story.result, outcomes.len(), failed, &report))?;
        Ok(if failed == outcomes.len() { Ending::Negative } else { Ending::Done })
    }

    /// The best design of each family against its limits, and the first validation experiment against what a median
    /// run of the best one predicts.
    fn examples(&self, designs: &[StudyDesign], outcomes: &[Outcome]) -> Result<Examples> {
        let best = |family: usize| {
            let of_family = designs.iter().enumerate().filter(|(_, design)| design.family == family);
            of_family.min_by(|(_, a), (_, b)| a.own_value().total_cmp(&b.own_value()))
        };
        let families = self.stage.plan().designs.len();
        let limits =
            (0..families).filter_map(best).map(|(index, design)| self.stage.limit_example(index, design)).collect();
        let shown = best(0).and_then(|(index, design)| {
            let outcome = outcomes.iter().find(|o| o.design == index && o.failure.is_none())?;
            Some((design, outcome.estimates.iter().rev().find(|estimate| estimate.score.is_some())?))
        });
        let prediction = match shown {
            Some((design, estimate)) => {
                let seed = self.stage.plan().seed.child("validation experiment", 0);
                let mut arm = self.simulation.arm(&Sensing::default(), seed, 0).map_err(in_words)?;
                let trajectory = self.stage.validation_trajectory(0).map_err(in_words)?;
                let samples = self.stage.samples(&trajectory, &mut *arm).map_err(in_words)?;
                Some(self.stage.prediction_example(design, estimate, &samples))
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
