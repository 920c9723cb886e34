//! `armid study`

use std::path::PathBuf;

use armid::input::size;
use armid_workflow::study::{self, Part, Shard, Stage, StudySettings};
use miette::Result;

use super::answer::show;
use super::overrides::Overrides;
use super::{merge, plan, submit};
use crate::arguments::one_of;
use crate::terminal::{Console, Ending, Watch};

/// Most threads, as the parser of arguments takes it.
const THREADS: u32 = size::THREADS.most as u32;

const AFTER_HELP: &str = "\
A study designs trajectories, simulates experiments with each, estimates, and scores against the true \
parameters. Equal plan and seed give the same bytes for any number of threads; only timing.parquet and \
provenance.json hold times.

Ctrl-C and kill lose no finished run: --resume continues. A folder with results of another plan is refused.

Examples:
  armid study experiments/01-criteria             a bundled study
  armid study experiments/01-criteria --runs 100  more runs of each design
  armid study 01-criteria --truths 25             each run number on its own random arm
  armid study 01-criteria --arm analytic,mujoco   the same in two engines
  armid study my/study.toml --jobs 1 -o out --resume
  armid study my/study.toml --robot puma-560      one of its robots
  armid study 01-criteria --until 'ratio(condition, d-optimal).prediction < 5 %'
  armid study plan pilot --until 'ratio(condition, d-optimal).prediction < 2 %'
  armid study submit 01-criteria --engine slurm -o /shared/01   on a cluster";

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
    /// Perform part K of N; `armid study merge` joins them
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Perform one stage: the designs, or the runs of stored designs
    #[arg(long, value_name = "STAGE", value_parser = one_of(&Stage::ALL, Stage::name))]
    stage: Option<Stage>,
    /// Folders with the designs for --stage runs
    #[arg(long, value_name = "DIR", requires = "stage")]
    designs_from: Vec<PathBuf>,
    /// End when an interval is narrow: "ratio(condition, d-optimal).prediction < 5 %"
    #[arg(long, value_name = "RULE", conflicts_with_all = ["shard", "stage"])]
    until: Option<String>,
}

/// What to do with studies that are performed in parts.
#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Put the parts of a study together: folders that --shard wrote
    Merge(merge::Arguments),
    /// Say how many starts, arms and runs a wanted interval needs, from a study that was performed
    Plan(plan::Arguments),
    /// Hand a study to a cluster: designs, then runs, then the report
    Submit(submit::Arguments),
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    match &arguments.action {
        None => perform(arguments, console),
        Some(Action::Merge(arguments)) => merge::run(arguments, console),
        Some(Action::Plan(arguments)) => plan::run(arguments, console),
        Some(Action::Submit(arguments)) => submit::run(arguments, console),
    }
}

fn perform(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let request = arguments.overrides.request(arguments.study.as_deref().unwrap_or_default())?;
    let in_parts = arguments.part_words();
    if !in_parts.is_empty() {
        request.single_plan(&format!("STUDY {in_parts}"))?;
    }
    let settings = StudySettings {
        output: request.output(console)?,
        beside: request.beside,
        threads: arguments.jobs.map_or(0, |jobs| jobs as usize),
        resume: arguments.resume,
        part: Part { stage: arguments.stage, shard: arguments.shard },
        designs_from: arguments.designs_from.clone(),
        until: arguments.until.clone(),
        ..StudySettings::default()
    };
    show(&study::perform(&request.plans, &settings, &Watch::new(console))?, console)
}

impl Arguments {
    /// The arguments that ask for a part of a study or for an early end, as words of a command line.
    fn part_words(&self) -> String {
        let mut words = Vec::new();
        if let Some(stage) = self.stage {
            words.push(format!("--stage {}", stage.name()));
        }
        if let Some(Shard { k, n }) = self.shard {
            words.push(format!("--shard {k}/{n}"));
        }
        if let Some(rule) = &self.until {
            words.push(format!("--until '{rule}'"));
        }
        words.join(" ")
    }
}
