//! `armid study`

use std::path::PathBuf;

use armid::input::size;
use armid::study::StudyPlan;
use miette::Result;

use super::overrides::Overrides;
use super::{cancel, collect, merge, status, submit};
use crate::arguments::one_of;
use crate::study::{Part, Performance, Prepared, Shard, Stage, in_words, stored_designs};
use crate::terminal::{Answer, Console, Ending, report_folder};

/// Most threads, as the parser of arguments takes it.
const THREADS: u32 = size::THREADS.most as u32;

const AFTER_HELP: &str = "\
A study designs trajectories, performs simulated experiments with each, estimates, and scores against
the truth. Equal plan and seed give the same bytes for any number of threads; wall times and dates are
in timing.parquet and provenance.json alone.

Ctrl-C and kill lose no finished run: --resume continues from them.

Examples:
  armid study experiments/01-criteria             the bundled study, into reports/01-criteria/
  armid study experiments/01-criteria --runs 100  more runs of each design
  armid study 01-criteria --truths 25             each run number on its own random arm
  armid study 01-criteria --arm analytic,mujoco   the same in two engines
  armid study my/study.toml --jobs 1 -o out --resume
  armid study submit 01-criteria --engine slurm -o /shared/01   on a cluster; then status, cancel";

/// Run a Monte Carlo study of designs and estimators
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Option<Action>,
    /// A bundled study, a folder with a study.toml, or the file itself
    #[arg(required = true)]
    study: Option<String>,
    #[command(flatten)]
    overrides: Overrides,
    /// Threads; all cores where absent
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(THREADS)))]
    jobs: Option<u32>,
    /// Resume from the finished work in the output folder
    #[arg(long)]
    resume: bool,
    /// Perform only part K of N of the runs; `armid study merge` puts the parts together
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Perform one stage alone: the designs, or the runs with designs that are there
    #[arg(long, value_name = "STAGE", value_parser = one_of(&Stage::ALL, Stage::name))]
    stage: Option<Stage>,
    /// Where the designs of --stage runs are: a folder that --stage designs wrote, or one that holds such folders
    #[arg(long, value_name = "DIR", requires = "stage")]
    designs_from: Vec<PathBuf>,
}

/// What to do with studies that are performed in parts.
#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Put the parts of a study together: folders that --shard wrote
    Merge(merge::Arguments),
    /// Hand a study to a cluster: designs, then runs, then the report
    Submit(submit::Arguments),
    /// Show how far a submitted study is
    Status(status::Arguments),
    /// End a submitted study; finished work is kept
    Cancel(cancel::Arguments),
    /// Submit again what is missing, or merge what is complete: the last job of a submission
    Collect(collect::Arguments),
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    match &arguments.action {
        None => perform(arguments, console),
        Some(Action::Merge(arguments)) => merge::run(arguments, console),
        Some(Action::Submit(arguments)) => submit::run(arguments, console),
        Some(Action::Status(arguments)) => status::run(arguments, console),
        Some(Action::Cancel(arguments)) => cancel::run(arguments, console),
        Some(Action::Collect(arguments)) => collect::run(arguments, console),
    }
}

fn perform(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let (plan, folder) = arguments.overrides.plan(arguments.study.as_deref().unwrap_or_default())?;
    let output = output_folder(&plan, console)?;
    let prepared = Prepared::new(plan, folder.as_deref())?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.jobs.map_or(0, |jobs| jobs as usize))
        .build()
        .map_err(in_words)?;
    let part = Part { stage: arguments.stage, shard: arguments.shard };
    let study = prepared.performance(&output, part, console);
    threads.install(|| match part.stage {
        Some(Stage::Designs) => design(&study, arguments.resume, console),
        Some(Stage::Runs) | None => run_part(&study, arguments, console),
    })
}

/// The designs alone, or a part of them.
fn design(study: &Performance<'_>, resume: bool, console: &Console) -> Result<Ending> {
    let (journal, pieces) = study.journal(resume)?;
    if study.perform_designs(journal, pieces)? { part_is_there(study, console) } else { interrupted(study, console) }
}

/// The runs, or a part of them, and the whole study where it is no part.
fn run_part(study: &Performance<'_>, arguments: &Arguments, console: &Console) -> Result<Ending> {
    // Before a journal is begun: a mistaken folder is found while nothing is written yet.
    let designs = stored_designs(&arguments.designs_from, &study.identity()?)?;
    let (journal, mut pieces) = study.journal(arguments.resume)?;
    if let Some(note) = journal.note() {
        console.note(note);
    }
    pieces.extend(designs);
    match study.perform(journal, pieces)? {
        Some(work) if study.part().is_whole() => study.finish(work),
        Some(_) => part_is_there(study, console),
        None => interrupted(study, console),
    }
}

fn part_is_there(study: &Performance<'_>, console: &Console) -> Result<Ending> {
    let (part, output) = (study.part(), study.output());
    let (k, n) = part.shard.map_or((1, 1), |shard| (shard.k, shard.n));
    let what = part.stage.map_or(String::new(), |stage| format!(" of the {}", stage.name()));
    let message =
        format!("part {k} of {n}{what} is in {}; put the parts together with armid study merge\n", output.display());
    console.show(&Answer {
        json: serde_json::json!({ "shard": output, "k": k, "n": n, "stage": part.stage.map(Stage::name) }),
        text: message,
    })?;
    Ok(Ending::Done)
}

fn interrupted(study: &Performance<'_>, console: &Console) -> Result<Ending> {
    console.note(format!("interrupted; go on with --resume -o {}", study.output().display()));
    Ok(Ending::Interrupted)
}

pub(super) fn output_folder(plan: &StudyPlan, console: &Console) -> Result<PathBuf> {
    Ok(console.output().map_or_else(|| report_folder("name", &plan.name), |path| Ok(path.to_path_buf()))?)
}
