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
urdf, mjcf, toml and json need the mass, centre of mass and inertia of each link; torque shows sums of
them. The log of the estimate is read again, and a model with the terms of the format is fitted to it,
near the bodies of the robot file: every body is one, with at least a thousandth of the spread of its
guess, and friction and rotor inertia are not negative. How much the guess counts is chosen by
cross-validation over blocks of the log. The file is read back and predicts the log; the answer, the
file and --json have the error. Exit status 1 where it is more than 1.25 times that of the estimate:
the answer then says which term is missing, and how much torque it carries.

A robot that came as a URDF or MJCF is written as that file with other inertias, damping and friction,
and in MJCF with armature and force range; names, meshes, geoms, actuators, comments and formatting
stay. --into does the same to another file of the same arm. Right angles of a URDF that are written
with few digits stay as they are in the file; the answer says by how much its torque differs for that.

c and rust are source code of inverse dynamics, gravity torque and mass matrix in the base parameters
as estimated, with the operations that they need and no others; it needs a compiler alone, and no log.
Its operations are compared with the regressor times the estimate.

isaac and python are files of Python for simulators. isaac, beside the MJCF of the same estimate, has
the actuators of Isaac Lab: rotor inertia, friction and limits of each joint, for gains of yours.
python has an MJCF without friction, and a class that applies the friction of every identified law in
each step of MuJoCo, which has viscous and dry friction alone.

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
    /// The logs of the estimate, where they are no longer where it says
    #[arg(long, value_name = "LOG", num_args = 1..)]
    log: Vec<PathBuf>,
    /// A URDF or MJCF of the same arm that gets the numbers, in place of the robot's own file
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
            let answer = export((&estimate, &text.name), log, &settings, &Watch::new(console))?;
            (answer.text.clone(), serde_json::to_value(&answer), model_file_text(&answer), answer.is_sound())
        }
        Target::Source(language) => {
            let answer = export_source((&estimate, &text.name), &loaded, language, file)?;
            (answer.text.clone(), serde_json::to_value(&answer), source_text(&answer), answer.is_sound())
        }
    };
    console.deliver(&destination, &written)?;
    let text = format!("{destination}\n{words}");
    console.show(&Answer { text, json: json.map_err(Error::of)? })?;
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
