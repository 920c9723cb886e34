//! `armid campaign`

use std::path::{Path, PathBuf};

use armid::model::Columns;
use armid::signal::TorqueFilter;
use armid_io::Error;
use armid_io::estimate::read;
use armid_io::log::HeldOut;
use armid_io::recording::{check_at_rest, part_path};
use armid_workflow::campaign::{Campaign, CampaignSettings, Outcome, Round, Step, Target, experiment_table};
use armid_workflow::design::HeaviestLoad;
use miette::Result;
use toml::Value;

use super::run;
use crate::answers::campaign::{campaign_text, round_text};
use crate::arguments::{ChainArguments, LogArguments, MeshArguments, columns, one_of};
use crate::arms::ArmKind;
use crate::terminal::{Answer, Console, Ending, Watch, report_folder};

const AFTER_HELP: &str = "\
Each round is designed from the estimate by all rounds before, performed behind the guard and identified. It ends when \
every interval is within its target, when errors of the model keep one out of reach, or after --rounds. Intervals are \
for 95 % over all rounds together. Called again, it goes on where it ended.

Examples:
  armid campaign crs-a460 --until \"torque <= 1 %\" -o campaign
  armid campaign experiment.toml --until \"Fc2 <= 0.1\" --until \"Fv2 <= 5 %\"
  armid campaign experiment.toml --arm ros2 --until \"torque <= 3 %\" -o campaign
  armid campaign arm.urdf --tip-link tool0 --by-hand --until \"torque <= 3 %\" -o campaign
  armid campaign campaign --log log.csv --map \"t=time ms, q=pos_[1-6] deg, tau=torque_[1-6]\"
  armid campaign loaded.toml --without campaign/estimate.json --payload 2 --until \"payload.mass <= 1 %\"

Exit status: 0 reached or waiting for a log, 1 not reached or an arm tripped, 3 NOT CONFIRMED at rest, 130 interrupted.";

/// Design, perform and identify, round by round, until targets are met
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// A robot, an experiment, or the folder of a campaign
    #[arg(value_name = "ROBOT|EXPERIMENT|DIR")]
    what: String,
    #[command(flatten)]
    chain: ChainArguments,
    /// Target, such as "Fc2 <= 0.1" or "torque <= 3 %"
    #[arg(long, value_name = "TARGET")]
    until: Vec<Target>,
    /// Rounds, at most [default: 8]
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// Recorded periods of a round [default: 4, or the experiment's]
    #[arg(long, value_name = "N")]
    periods: Option<u32>,
    /// Period of the motions, s [default: 10]
    #[arg(long, value_name = "S")]
    period: Option<f64>,
    /// Share of the designed speed in the first round [default: 0.5]
    #[arg(long, value_name = "SHARE")]
    first_speed: Option<f64>,
    /// Repeat the first motion instead of a new design
    #[arg(long)]
    repeat: bool,
    /// Columns of the model [default: rigid+rotor+friction, and what logs show]
    #[arg(long, value_parser = columns)]
    columns: Option<Columns>,
    /// Low pass on both sides of the equations [default: none]
    #[arg(long, value_parser = one_of(&TorqueFilter::ALL, TorqueFilter::name))]
    torque_filter: Option<TorqueFilter>,
    /// Independent starts of each design [default: 3]
    #[arg(long, value_name = "N")]
    starts: Option<u64>,
    /// Evaluations of each start [default: 150]
    #[arg(long, value_name = "N")]
    evaluations: Option<usize>,
    /// Seed of every random number [default: 1]
    #[arg(long, value_name = "K")]
    seed: Option<u64>,
    /// Arm that performs, instead of the experiment's
    #[arg(long, value_parser = one_of(&ArmKind::ALL, ArmKind::name), conflicts_with = "by_hand")]
    arm: Option<ArmKind>,
    /// Estimate of the arm without its payload
    #[arg(long, value_name = "E.json", requires = "payload", help_heading = "Payload")]
    without: Option<PathBuf>,
    /// Mass of the heaviest payload that motions are designed for
    #[arg(long, value_name = "KG", requires = "without", help_heading = "Payload")]
    payload: Option<f64>,
    /// Write each motion, and end until its log is brought
    #[arg(long, help_heading = "By hand")]
    by_hand: bool,
    /// Log of the round that was written last
    #[arg(long, value_name = "LOG", num_args = 1.., help_heading = "By hand")]
    log: Vec<PathBuf>,
    /// Columns and units of the log; see `armid help map`
    #[arg(long, value_name = "COLUMNS", requires = "log", help_heading = "By hand")]
    map: Option<String>,
    /// Rows per second of a log without a column of times
    #[arg(long, value_name = "HZ", requires = "log", help_heading = "By hand")]
    rate: Option<f64>,
    #[command(flatten)]
    meshes: MeshArguments,
    /// Confirm: emergency stop works, arm is homed, nobody is near
    #[arg(long)]
    yes_the_estop_works: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let mut campaign = arguments.open(console)?;
    let watch = Watch::new(console);
    let mut brought = !arguments.log.is_empty();
    if brought && !campaign.settings().by_hand {
        return Err(Error::new("--log with a campaign that is not by hand, expected --by-hand at its beginning").into());
    }
    loop {
        let round = match campaign.next(&watch)? {
            Step::Ended => break,
            Step::Interrupted => return show(&campaign, None, Ending::Interrupted, console),
            Step::Perform(round) => round,
        };
        if campaign.settings().by_hand {
            if !brought {
                round.write_points()?;
                return show(&campaign, Some(&round), Ending::Done, console);
            }
            brought = false;
            arguments.take(&mut campaign, &arguments.log, &watch)?;
        } else {
            let ending = arguments.perform(&campaign, &round, console)?;
            if ending != Ending::Done {
                show(&campaign, Some(&round), ending, console)?;
                run::warn(ending, console);
                return Ok(ending);
            }
            arguments.take(&mut campaign, &[round.recording()], &watch)?;
        }
        console.note(format!("round {} is identified", round.number));
    }
    if brought {
        return Err(Error::new("--log with a campaign that has ended, expected one that waits for a log").into());
    }
    let reached = campaign.answer()?.outcome == Outcome::Reached;
    show(&campaign, None, if reached { Ending::Done } else { Ending::Negative }, console)
}

/// Shows how a campaign stands, and the round that is to be performed.
fn show(campaign: &Campaign, round: Option<&Round>, ending: Ending, console: &Console) -> Result<Ending> {
    let answer = campaign.answer()?;
    let mut json = serde_json::to_value(&answer).map_err(Error::new)?;
    json["next"] = serde_json::json!(round);
    let mut text = campaign_text(&answer);
    if let Some(round) = round.filter(|_| campaign.settings().by_hand) {
        text.push_str(&round_text(round, campaign.folder()));
    }
    console.show(&Answer { text, json })?;
    Ok(ending)
}

impl Arguments {
    fn open(&self, console: &Console) -> Result<Campaign> {
        let here = Path::new(&self.what);
        if let Some(campaign) = Campaign::of_folder(here)? {
            if self.states_settings() {
                let message = format!("{} has its settings, found others beside it", here.display());
                return Err(Error::new(message).help("leave them out: campaign.toml in the folder keeps them").into());
            }
            return Ok(campaign);
        }
        let settings = self.settings()?;
        let robot = settings.experiment.get("robot").and_then(Value::as_str).unwrap_or_default();
        let stem = Path::new(robot).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let folder = console.output_or(|| report_folder("name of the robot", &format!("{stem}-campaign")))?;
        Ok(Campaign::begin(settings, &folder)?)
    }

    /// Whether anything is said that a folder keeps.
    fn states_settings(&self) -> bool {
        let said = [
            self.chain.base_link.is_some(),
            self.chain.tip_link.is_some(),
            !self.until.is_empty(),
            self.rounds.is_some(),
            self.periods.is_some(),
            self.period.is_some(),
            self.first_speed.is_some(),
            self.repeat,
            self.columns.is_some(),
            self.torque_filter.is_some(),
            self.starts.is_some(),
            self.evaluations.is_some(),
            self.seed.is_some(),
            self.arm.is_some(),
            self.without.is_some(),
            self.by_hand,
        ];
        said.contains(&true)
    }

    fn settings(&self) -> Result<CampaignSettings, Error> {
        let mut experiment = experiment_table(&self.what, &self.chain.ends())?;
        let mut state = |key: &str, value: Option<Value>| {
            value.and_then(|value| experiment.insert(key.to_owned(), value));
        };
        state("arm", self.arm.map(|arm| Value::String(arm.name().to_owned())));
        state("periods", self.periods.map(|periods| Value::Integer(periods.into())));
        let load = self.payload.map(|mass_kg| HeaviestLoad { mass_kg, centre_m: [0.0; 3] });
        let usual = CampaignSettings::new(experiment, self.until.clone());
        // A load is found by two estimates with the same columns.
        let of_arm = self.without.as_deref().map(read).transpose()?.map(|of| of.columns);
        Ok(CampaignSettings {
            most_rounds: self.rounds.unwrap_or(usual.most_rounds),
            repeats: self.repeat,
            by_hand: self.by_hand,
            first_speed: self.first_speed.unwrap_or(usual.first_speed),
            columns: self.columns.map(|columns| columns.to_string()).or(of_arm).unwrap_or(usual.columns),
            adds_terms: self.columns.is_none(),
            torque_filter: self.torque_filter.unwrap_or(usual.torque_filter),
            period_s: self.period.unwrap_or(usual.period_s),
            starts: self.starts.unwrap_or(usual.starts),
            evaluations: self.evaluations.unwrap_or(usual.evaluations),
            seed: self.seed.unwrap_or(usual.seed),
            without: self.without.clone(),
            load,
            ..usual
        })
    }

    /// Performs a round as `armid run` does, unless its recording is there.
    fn perform(&self, campaign: &Campaign, round: &Round, console: &Console) -> Result<Ending> {
        let (place, arm) = (round.recording(), campaign.settings().experiment.get("arm").and_then(Value::as_str));
        if place.is_file() {
            return Ok(Ending::Done);
        }
        let is_real = arm == Some(ArmKind::Ros2.name());
        let part = part_path(&place);
        if part.is_file() && !is_real {
            // A simulated arm begins again, with the noise that it has in one piece.
            check_at_rest(&part)?;
            std::fs::remove_file(&part).map_err(|error| Error::unwritable(&part, &error))?;
        }
        let experiment = round.experiment().display().to_string();
        let arguments = run::Arguments::guarded(experiment, is_real, self.yes_the_estop_works, self.meshes.clone());
        let (answer, ending) = run::run_at(&arguments, Some(place), console)?;
        if ending != Ending::Done {
            console.alarm(answer.text.trim_end());
        }
        Ok(ending)
    }

    fn take(&self, campaign: &mut Campaign, logs: &[PathBuf], watch: &Watch<'_>) -> Result<()> {
        let (log, inputs) = self.log_of(campaign).process(logs, None, HeldOut::Nothing)?;
        Ok(campaign.take(log, &inputs, watch)?)
    }

    /// How logs are read: those of armid say it themselves.
    fn log_of(&self, campaign: &Campaign) -> LogArguments {
        let logs = if campaign.settings().by_hand {
            let robot = campaign.settings().experiment.get("robot").and_then(Value::as_str).unwrap_or_default();
            LogArguments::of_table(robot.to_owned(), self.map.clone(), self.rate)
        } else {
            LogArguments::default()
        };
        logs.with_torque_filter(campaign.settings().torque_filter)
    }
}
