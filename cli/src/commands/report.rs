//! `armid report`

use std::path::PathBuf;

use miette::Result;
use serde_json::json;

use crate::answer::{Answer, Ending};
use crate::console::Console;
use crate::fault::Fault;
use crate::files::study_store::{read_study, write_report};

const AFTER_HELP: &str = "\
Everything that a report shows is stored by `armid study`; this draws it again and computes nothing.

Examples:
  armid report reports/01-criteria
  armid report reports/01-criteria -o /tmp/page";

/// Draw the figures and the page of a stored study again
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// Folders that `armid study` wrote
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let mut pages = Vec::new();
    for folder in &arguments.folders {
        if !folder.is_dir() {
            return Err(Fault::new(format!(
                "{} is no folder, expected one that `armid study` wrote",
                folder.display()
            ))
            .into());
        }
        let story = read_study(folder)?;
        let output = match console.output() {
            Some(output) if arguments.folders.len() > 1 => output.join(&story.result.plan.name),
            Some(output) => output.to_path_buf(),
            None => folder.join("report"),
        };
        pages.push(write_report(&output, &story)?);
    }
    let lines: Vec<String> = pages.iter().map(|page: &PathBuf| page.display().to_string()).collect();
    console.show(&Answer { text: lines.join("\n") + "\n", json: json!({ "pages": lines }) })?;
    Ok(Ending::Done)
}
