//! `armid export`

use std::path::{Path, PathBuf};

use armid::codegen::Language;
use armid::model::format::ChainEnds;
use armid_io::estimate::{self, check_robot};
use armid_io::inputs::RobotSource;
use armid_io::robot::ChainSource;
use armid_io::{Error, Inputs, LoadedRobot, Text};
use armid_workflow::LogSource;
use armid_workflow::export::{Exchange, ExportSettings, export, export_source};
use miette::Result;

use crate::answers::model_file::{model_file_text, source_text};
use crate::arguments::{ChainArguments, one_of};
use crate::terminal::{Answer, Console, Destination, Ending, Watch, report_folder};

const AFTER_HELP: &str = "\
For urdf, mjcf, toml and json a model with the terms of the format is fitted to the log, near the bodies of \
the robot file. The file must predict the log with at most 1.25 times the error of the estimate; else the \
exit status is 1 and the missing term is named.

  urdf, mjcf    a URDF or MJCF robot keeps its meshes, comments and formatting
  toml, json    all terms of the model
  c, rust       inverse and forward dynamics, gravity, mass matrix and regressor in base parameters
  isaac         actuators of Isaac Lab, beside the MJCF of the same estimate
  python        an MJCF, and a class that applies the identified friction

Examples:
  armid export E.json --to urdf -o a460.urdf
  armid export E.json --to c -o a460.c
  armid export E.json --to mjcf --into scene.xml -o identified.xml
  armid export E.json --to json --json";

/// Write the model that a file of another tool can hold, and say how well it predicts the log
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The estimate, a JSON file of `armid identify`
    estimate: PathBuf,
    /// Format of the file
    #[arg(long, value_parser = one_of(&Target::ALL, Target::name))]
    to: Target,
    /// The robot, where its file is no longer where the estimate says
    #[arg(long)]
    robot: Option<String>,
    /// Logs of the estimate, if they were moved
    #[arg(long, value_name = "LOG", num_args = 1..)]
    log: Vec<PathBuf>,
    /// Insert the numbers into this URDF or MJCF of the arm
    #[arg(long, value_name = "FILE")]
    into: Option<PathBuf>,
    #[command(flatten)]
    chain: ChainArguments,
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    /// A model of all parameters.
    Model(Exchange),
    /// Source code in base parameters.
    Source(Language),
}

impl Target {
    const ALL: [Self; 8] = [
        Self::Model(Exchange::Urdf),
        Self::Model(Exchange::Mjcf),
        Self::Model(Exchange::Toml),
        Self::Model(Exchange::Json),
        Self::Model(Exchange::Isaac),
        Self::Model(Exchange::Python),
        Self::Source(Language::C),
        Self::Source(Language::Rust),
    ];

    const fn name(self) -> &'static str {
        match self {
            Self::Model(format) => format.name(),
            Self::Source(language) => language.name(),
        }
    }

    /// How its files end.
    const fn extension(self) -> &'static str {
        match self {
            Self::Model(format) => format.extension(),
            Self::Source(language) => language.extension(),
        }
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let text = Text::read(&arguments.estimate)?;
    let estimate = estimate::parse(&text)?;
    let loaded = match Inputs::of_estimate(&text)?.map(|inputs| inputs.robot) {
        // The estimate records which file its robot came from.
        Some(RobotSource { name: Some(name), base_link, tip_link, .. }) if arguments.robot.is_none() => {
            let chain = ChainArguments {
                base_link: arguments.chain.base_link.clone().or(base_link),
                tip_link: arguments.chain.tip_link.clone().or(tip_link),
            };
            chain.load(&name).map_err(|error| error.of_an_estimate(&text.name, "--robot ROBOT says where it is now"))?
        }
        _ => arguments.chain.load(arguments.robot.as_deref().unwrap_or(&estimate.robot))?,
    };
    let searched = estimate.termination.was_successful();
    if !searched {
        console.alarm(&format!("the estimate is not what was sought: its search {}", estimate.termination));
    }
    let destination = destination(&loaded, arguments.to, console)?;
    check_robot(&estimate, &text.name, &loaded)?;
    let file = destination.path().map(Path::to_path_buf);
    let (written, json, words, sound) = match arguments.to {
        Target::Model(format) => {
            let into = arguments.into.as_deref().map(|path| template(path, format, &loaded)).transpose()?;
            let (robot, chain) = (arguments.robot.clone(), arguments.chain.ends());
            let (log, _) = LogSource { robot, chain, ..LogSource::default() }.again(&text, &arguments.log)?;
            let settings = ExportSettings { format, into, file };
            let answer = export(&estimate, &text.name, log, &settings, &Watch::new(console))?;
            (answer.text.clone(), serde_json::to_value(&answer), model_file_text(&answer), answer.is_sound())
        }
        Target::Source(language) => {
            let answer = export_source(&estimate, &text.name, &loaded, language, file)?;
            (answer.text.clone(), serde_json::to_value(&answer), source_text(&answer), answer.is_sound())
        }
    };
    console.deliver(&destination, &written)?;
    let text = format!("{destination}\n{words}");
    console.show(&Answer { text, json: json.map_err(Error::new)? })?;
    Ok(if searched && sound { Ending::Done } else { Ending::Negative })
}

/// The file that gets the numbers.
fn template(path: &Path, format: Exchange, loaded: &LoadedRobot) -> Result<ChainSource, Error> {
    if !matches!(format, Exchange::Urdf | Exchange::Mjcf) {
        let message = format!("--into is for urdf and mjcf, found --to {}", format.name());
        return Err(Error::new(message));
    }
    // Names of links need not be the same in another format.
    let ends = format.template(loaded).map_or_else(ChainEnds::default, |own| own.ends.clone());
    Ok(ChainSource { text: Text::read(path)?, ends })
}

/// Where the model goes: `-o`, or `reports/NAME-identified/NAME.ENDING`.
fn destination(loaded: &LoadedRobot, target: Target, console: &Console) -> Result<Destination> {
    console.text_or(|| {
        let name = loaded.robot.name();
        let folder = report_folder("name of the robot", &format!("{name}-identified"))?;
        Ok(folder.join(format!("{name}.{}", target.extension())))
    })
}
