//! `armid init`

use std::path::PathBuf;

use armid::input::check_file_name;
use armid::model::format::ChainEnds;
use armid_io::Error;
use armid_io::starter::Starter;
use miette::Result;
use serde_json::json;

use crate::arguments::ChainArguments;
use crate::terminal::{Answer, Console, Ending};

const AFTER_HELP: &str = "\
The folder gets a copy of the URDF, a robot.toml with every gap marked, an experiment, the columns of a log, \
and a README with the next commands. Existing files are kept.

Examples:
  armid init arm.urdf                       makes the folder arm
  armid init tree.urdf --tip-link tool0 -o lab/left-arm";

/// Make a folder ready to identify the arm of a URDF
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The URDF
    urdf: PathBuf,
    #[command(flatten)]
    chain: ChainArguments,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let ends = ChainEnds { base: arguments.chain.base_link.clone(), tip: arguments.chain.tip_link.clone() };
    let folder = match console.output() {
        Some(folder) => folder.to_path_buf(),
        None => {
            let stem = arguments.urdf.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            check_file_name("name of the URDF", &stem)
                .map_err(|error| Error::new(error).help("-o chooses the folder"))?;
            PathBuf::from(stem)
        }
    };
    let written = Starter::of_urdf(&arguments.urdf, &ends)?.write(&folder)?;
    let files: Vec<String> = written.iter().map(|place| place.display().to_string()).collect();
    let [robot, readme] = ["robot.toml", "README.md"].map(|file| folder.join(file).display().to_string());
    let next =
        format!("next: fill in the gaps that matter, then `armid robot {robot}`; {readme} has the order of work");
    let text = format!("{}\n{next}\n", files.join("\n"));
    console.show(&Answer { text, json: json!({ "folder": folder.display().to_string(), "files": files }) })?;
    Ok(Ending::Done)
}
