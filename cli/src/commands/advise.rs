//! `armid advise`

use std::path::PathBuf;

use armid::model::DriveKind;
use armid::study::Purpose;
use armid_io::Error;
use armid_io::log::HeldOut;
use armid_workflow::advice::{AdviceSettings, EarlierLog, advise};
use armid_workflow::identification::{IdentifySettings, identify};
use miette::Result;

use crate::answers::advice::advice_text;
use crate::arguments::{LogArguments, one_of};
use crate::terminal::{Answer, Console, Ending, Watch, report_folder};

/// Longest time on the robot, minutes.
const MOST_MINUTES: f64 = 120.0;

const AFTER_HELP: &str = "\
A study compares designs and estimators on arms around the nominal one. They have the effects of such drives, up to \
twice the realistic size, and an unforeseen one. The folder gets the study with its page, the best motion, and an \
experiment that performs it. What a URDF does not state is assumed and listed.

Examples:
  armid advise crs-a460
  armid advise arm.urdf --tip-link tool0 --drive planetary --minutes 3 -o advice
  armid advise lab/robot.toml --for point-to-point
  armid advise lab/robot.toml --log old.csv --period 10     # log options are those of `armid identify`";

/// Find the motion and the estimator for an arm before it moves
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP, mut_arg("robot", |arg| arg.hide(true)), mut_group("LogArguments", |group| group.requires("logs")))]
pub(crate) struct Arguments {
    /// A bundled name (`armid robot` lists them), robot.toml, URDF or MJCF
    #[arg(value_name = "ROBOT")]
    arm: String,
    /// Drives of the arm [default: as the robot file states, or harmonic]
    #[arg(long, value_parser = one_of(&DriveKind::ALL, DriveKind::name))]
    drive: Option<DriveKind>,
    /// What the model is for
    #[arg(long = "for", value_name = "PURPOSE", default_value = "torque", value_parser = one_of(&Purpose::ALL, Purpose::name))]
    purpose: Purpose,
    /// Time on the robot, minutes
    #[arg(long, value_name = "MIN", default_value_t = 1.0)]
    minutes: f64,
    /// Arms drawn around the nominal one
    #[arg(long, value_name = "N", default_value_t = 6)]
    arms: u32,
    /// Seed of every random number
    #[arg(long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Resume from the finished work in the output folder
    #[arg(long)]
    resume: bool,
    /// Earlier log of the arm: its noise and effects replace those assumed
    #[arg(long = "log", value_name = "LOG")]
    logs: Vec<PathBuf>,
    #[command(flatten)]
    log: LogArguments,
}

impl Arguments {
    /// What the earlier logs show of the arm.
    fn earlier(&self, console: &Console) -> Result<Option<EarlierLog>, Error> {
        if self.logs.is_empty() {
            return Ok(None);
        }
        let log = self.log.clone().with_robot(&self.arm);
        let (log, inputs) = log.process(&self.logs, None, HeldOut::Nothing)?;
        let answer = identify(log, Some(inputs), &IdentifySettings::default(), &Watch::new(console))?;
        Ok(Some(EarlierLog::new(&answer)))
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    if !(arguments.minutes > 0.0 && arguments.minutes <= MOST_MINUTES) {
        let message = format!("--minutes is {}, expected more than 0 and at most {MOST_MINUTES}", arguments.minutes);
        return Err(Error::new(message).into());
    }
    if arguments.arms == 0 {
        return Err(Error::new("--arms is 0, expected at least 1").into());
    }
    let loaded = arguments.log.model(&arguments.arm)?;
    let name = format!("{}-advice", loaded.robot.name());
    let output = console.output_or(|| report_folder("name of the robot", &name))?;
    let settings = AdviceSettings {
        ends: arguments.log.chain.ends(),
        log: arguments.earlier(console)?,
        drive: arguments.drive,
        purpose: arguments.purpose,
        minutes: arguments.minutes,
        arms: arguments.arms as usize,
        seed: arguments.seed,
        resume: arguments.resume,
        ..AdviceSettings::new(arguments.arm.clone(), output)
    };
    let Some(answer) = advise(&settings, &Watch::new(console))? else { return Ok(Ending::Interrupted) };
    let json = serde_json::to_value(&answer).map_err(Error::new)?;
    console.show(&Answer { text: advice_text(&answer), json })?;
    Ok(if answer.limits_kept { Ending::Done } else { Ending::Negative })
}
