//! `armid study merge`

use std::path::PathBuf;

use armid_io::study::load_plan;
use armid_sim::Engine;
use armid_workflow::study::merge;
use miette::Result;

use super::answer::show;
use super::request::output_folder;
use crate::terminal::{Console, Ending, Watch};

/// The folders of all parts.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The folders of all parts
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
}

/// Puts parts together into the folder that the command line names, or into the plan's own.
pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let folders = &arguments.folders;
    let (plan, _) = load_plan(&folders[0].display().to_string(), &Engine::ALL.map(Engine::name))?;
    let output = output_folder(&plan, console)?;
    show(&merge(plan, Some(&folders[0]), folders, &output, &Watch::new(console))?, console)
}
