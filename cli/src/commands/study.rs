//! `armid study`

use std::path::{Path, PathBuf};

use armid::study::{RandomTruths, StudyPlan};
use miette::Result;

use armid_io::Error;
use armid_io::study::{Journal, load_plan};
use armid_sim::Engine;

use crate::arguments::one_of;
use crate::arms::ArmKind;
use crate::study::{Prepared, Shard, in_words};
use crate::terminal::{Answer, Console, Ending};

const AFTER_HELP: &str = "\
A study designs trajectories, performs simulated experiments with each, estimates, and scores against
the truth. Equal plan and seed give the same bytes for any number of threads; wall times and dates are
in timing.parquet and provenance.json alone.

Ctrl-C and kill lose no finished run: --resume goes on with what is there.

Examples:
  armid study experiments/01-criteria             the bundled study, into reports/01-criteria/
  armid study experiments/01-criteria --runs 100  more runs of each design
  armid study 01-criteria --truths 25             every run number on an arm of its own
  armid study 01-criteria --arm analytic,mujoco   the same in two engines
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
    /// Draw this many random truths around the robot's own, in place of the plan's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    truths: Option<u32>,
    /// Threads; all cores where absent
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    jobs: Option<u32>,
    /// Go on with the finished work in the output folder
    #[arg(long)]
    resume: bool,
    /// Perform only part K of N of the runs; `armid study merge` puts the parts together
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Which simulated arms perform the experiments, in place of the plan's
    #[arg(
        long,
        value_name = "ARM,…",
        value_delimiter = ',',
        value_parser = one_of(&ArmKind::SIMULATED, ArmKind::name)
    )]
    arm: Option<Vec<ArmKind>>,
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
    let (mut plan, folder) = load_plan(arguments.study.as_deref().unwrap_or_default(), &Engine::ALL.map(Engine::name))?;
    if let Some(runs) = arguments.runs {
        plan.scale_runs(runs as usize);
    }
    if let Some(truths) = arguments.truths {
        let count = truths as usize;
        plan.truths = Some(plan.truths.map_or(RandomTruths::of(count), |spread| RandomTruths { count, ..spread }));
    }
    if let Some(arms) = &arguments.arm {
        plan.engines = arms.iter().map(|arm| arm.name().to_owned()).collect();
        plan.check().map_err(in_words)?;
    }
    let output = output_folder(&plan, console);
    let prepared = Prepared::new(plan, folder.as_deref())?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.jobs.map_or(0, |jobs| jobs as usize))
        .build()
        .map_err(in_words)?;
    threads.install(|| {
        let study = prepared.performance(&output, arguments.shard, console);
        let (journal, pieces) = study.journal(arguments.resume)?;
        if let Some(note) = journal.note() {
            console.note(note);
        }
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
    let (plan, _) = load_plan(&folders[0].display().to_string(), &Engine::ALL.map(Engine::name))?;
    let path = |folder: &Path| folder.join(Journal::NAME);
    let output = output_folder(&plan, console);
    let prepared = Prepared::new(plan, Some(&folders[0]))?;
    let study = prepared.performance(&output, None, console);
    let identity = study.identity()?;
    let mut pieces = Vec::new();
    for folder in folders {
        pieces.extend(Journal::read(&path(folder), &identity)?);
    }
    let missing = study.missing(&pieces);
    if missing > 0 {
        let message = format!("{missing} runs are in none of the folders, expected every part of the study, complete");
        return Err(Error::new(message).into());
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
