//! A campaign, round by round.

use std::path::{Path, PathBuf};

use armid::base::{Method, reduce};
use armid::estimation::{Estimate, EstimatorKind, Pooled, Termination, Together, pool};
use armid::model::Columns;
use armid::model::format::ChainEnds;
use armid::observer::Observer;
use armid::remedy::{Remedy, Setting};
use armid::seed::Seed;
use armid::signal::{NoiseModel, Samples};
use armid_io::estimate::{check_robot, read};
use armid_io::inputs::RobotSource;
use armid_io::output::{pretty, write_text};
use armid_io::{Error, Inputs, LoadedRobot, ProcessedLog, Text, robot};
use serde_json::json;
use toml::Value;

use super::aim::Aim;
use super::answer::{CampaignAnswer, RoundAnswer};
use super::figure;
use super::folder::{Round, SETTINGS, beginning_in, joined, read_settings, stated_inputs};
use super::motion::Motion;
use super::settings::CampaignSettings;
use super::stopping::{Obstacle, Outcome, Width, chance_of_a_look, is_model_error_shown, is_out_of_reach, outcome};
use crate::identification::advice;
use crate::log_source::LogSource;

/// A campaign, with the rounds that are finished.
#[derive(Debug)]
pub struct Campaign {
    folder: PathBuf,
    settings: CampaignSettings,
    loaded: LoadedRobot,
    columns: Columns,
    aims: Vec<Aim>,
    rounds: Vec<Round>,
    estimates: Vec<Estimate>,
    /// The logs that were taken; of a campaign that goes on they are read again.
    logs: Vec<Option<ProcessedLog>>,
    /// After each round, by it and all before.
    pooled: Vec<Pooled>,
    /// Target by target, after each round.
    widths: Vec<Vec<Width>>,
}

/// What comes next.
#[derive(Clone, Debug)]
pub enum Step {
    /// A round, whose log is then [taken](Campaign::take).
    Perform(Round),
    /// Nothing: the campaign has ended.
    Ended,
    /// The observer ended the search of a motion, which begins again at the next call.
    Interrupted,
}

impl Campaign {
    /// Begins a campaign in a folder, or goes on with it.
    ///
    /// # Errors
    /// [`Error`] where a setting is impossible, a target is of nothing that the arm has, or the folder holds another campaign.
    pub fn begin(settings: CampaignSettings, folder: &Path) -> Result<Self, Error> {
        let help = || Remedy::default().setting(Setting::Output).say(" chooses another folder");
        let place = folder.join(SETTINGS);
        match read_settings(folder)? {
            Some(there) if there != settings => {
                let message = format!("{} is of another campaign, expected the settings of this one", place.display());
                return Err(Error::mismatch(message).help(help()));
            }
            None if folder.join("rounds").exists() => {
                let message = format!("{} has rounds without {SETTINGS}, expected a new folder", folder.display());
                return Err(Error::mismatch(message).help(help()));
            }
            Some(_) | None => {}
        }
        let campaign = Self::of(settings, folder)?;
        if !place.is_file() {
            write_text(&place, &toml::to_string(&campaign.settings).map_err(Error::new)?)?;
        }
        Ok(campaign)
    }

    /// Goes on with the campaign of a folder; `None` where it holds none.
    ///
    /// # Errors
    /// As [`Self::begin`].
    pub fn of_folder(folder: &Path) -> Result<Option<Self>, Error> {
        read_settings(folder)?.map(|settings| Self::of(settings, folder)).transpose()
    }

    fn of(settings: CampaignSettings, folder: &Path) -> Result<Self, Error> {
        settings.check()?;
        let text = |key: &str| settings.experiment.get(key).and_then(Value::as_str).map(str::to_owned);
        let ends = ChainEnds { base: text("base_link"), tip: text("tip_link") };
        let named =
            text("robot").ok_or_else(|| Error::new("the experiment of a campaign names no robot, expected one"))?;
        let loaded = robot::load(&named, &ends, Some(folder))?;
        let columns = Columns::parse_estimable(&settings.columns).map_err(Error::new)?;
        let base = reduce(&loaded.robot, columns, Method::Structural, Seed::new(0))
            .map_err(|error| Error::new(format!("robot \"{}\": {error}", loaded.robot.name())))?;
        let without = settings.without.as_deref().map(read).transpose()?;
        if let (Some(without), Some(path)) = (&without, &settings.without) {
            check_robot(without, &path.display().to_string(), &loaded)?;
        }
        let targets = settings.until.iter().cloned();
        let aims = targets.map(|target| Aim::of(target, &loaded, (&base, columns), without.as_ref()));
        let aims = aims.collect::<Result<Vec<_>, Error>>()?;
        let mut campaign = Self {
            folder: folder.to_path_buf(),
            widths: vec![Vec::new(); aims.len()],
            settings,
            loaded,
            columns,
            aims,
            rounds: Vec::new(),
            estimates: Vec::new(),
            logs: Vec::new(),
            pooled: Vec::new(),
        };
        loop {
            let round = Round::of(folder, campaign.rounds.len() + 1)?;
            if !round.estimate().is_file() {
                return Ok(campaign);
            }
            let estimate = read(&round.estimate())?;
            check_robot(&estimate, &round.estimate().display().to_string(), &campaign.loaded)?;
            let together = read(&round.together())?;
            campaign.add(round, estimate, &together)?;
            campaign.logs.push(None);
        }
    }

    /// Adds a finished round.
    fn add(&mut self, round: Round, estimate: Estimate, together: &Estimate) -> Result<(), Error> {
        self.estimates.push(estimate);
        let all: Vec<&Estimate> = self.estimates.iter().collect();
        let together = Together { estimate: together, do_motions_differ: !self.settings.repeats };
        let pooled = pool(&all, Some(together))
            .map_err(|error| Error::new(format!("{}: {error}", round.estimate().display())))?;
        let chance = chance_of_a_look(self.settings.most_rounds);
        for (aim, widths) in self.aims.iter().zip(&mut self.widths) {
            widths.push(aim.width(&pooled.estimate, chance)?);
        }
        self.rounds.push(round);
        self.pooled.push(pooled);
        Ok(())
    }

    /// Where its files are.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What its folder keeps of how it was asked for.
    pub const fn settings(&self) -> &CampaignSettings {
        &self.settings
    }

    /// What comes next. A round has its files when it is returned: motion, and experiment to perform.
    ///
    /// # Errors
    /// [`Error`] where no motion is found within the limits of the arm, or a file cannot be written.
    pub fn next(&self, observer: &dyn Observer) -> Result<Step, Error> {
        if self.outcome() != Outcome::Unfinished {
            return Ok(Step::Ended);
        }
        let number = self.rounds.len() + 1;
        let mut round = Round::of(&self.folder, number)?;
        if !round.experiment().is_file() {
            if !round.trajectory().is_file() && !self.motion().write(&round, observer)? {
                return Ok(Step::Interrupted);
            }
            let speed = if number == 1 { self.settings.first_speed } else { 1.0 };
            round.write_experiment(&self.settings, speed)?;
        }
        Ok(Step::Perform(round))
    }

    fn motion(&self) -> Motion<'_> {
        let targets = self.aims.iter().zip(&self.widths);
        let is_open = |widths: &[Width], limit: f64| widths.last().is_none_or(|last| last.half_width > limit);
        let open = targets.filter(|(aim, widths)| is_open(widths, aim.target.limit())).map(|(aim, _)| aim).collect();
        let before = self.pooled.last().map(|pooled| (&self.rounds[..], &pooled.estimate));
        let Self { settings, columns, loaded, .. } = self;
        Motion { settings, columns: *columns, loaded, aims: open, before }
    }

    /// Takes the log of the round that comes next: estimates from it, and writes the estimate.
    ///
    /// # Errors
    /// [`Error`] where the log is of another robot or shows a mistake in how it was made, or the motion in it does not show the
    /// parameters; of [`armid_io::ErrorKind::Interrupted`] where the observer ended the work.
    pub fn take(&mut self, log: ProcessedLog, inputs: &Inputs, observer: &dyn Observer) -> Result<(), Error> {
        let round = Round::of(&self.folder, self.rounds.len() + 1)?;
        let name = log.name();
        if let Some(mistake) = log.suspicions(self.columns)?.first() {
            let message = format!("{name}: {}", mistake.mistake);
            return Err(Error::new(message).help(advice(mistake, &log)));
        }
        let estimate = self.estimate(&log, observer)?;
        check_robot(&estimate, &name, &self.loaded)?;
        let (all, inputs_of_all) = self.together(&log, inputs)?;
        let together = self.estimate(&all, observer)?;
        let with_inputs = |estimate: &Estimate, inputs: Inputs| {
            let mut value = json!(estimate);
            value["inputs"] = json!(inputs);
            pretty(&value)
        };
        write_text(&round.together(), &with_inputs(&together, beginning_in(&self.folder, inputs_of_all)))?;
        write_text(&round.estimate(), &with_inputs(&estimate, beginning_in(&round.folder, inputs.clone())))?;
        self.logs.push(Some(log));
        self.add(round, estimate, &together)
    }

    fn estimate(&self, log: &ProcessedLog, observer: &dyn Observer) -> Result<Estimate, Error> {
        let estimators = [EstimatorKind::Wls.estimator()];
        let made = match self.settings.without {
            // What the arm and the arm with its load have in common is in neither.
            Some(_) => log.identify_for_difference(self.columns, &estimators, observer)?,
            None => log.identify_watched(self.columns, &estimators, observer)?,
        };
        let ended = |of: &Estimate| matches!(of.termination, Termination::Interrupted { .. });
        made.into_iter().next().filter(|of| !ended(of)).ok_or_else(|| Error::interrupted(&log.name()))
    }

    /// All logs so far that are sampled as the last one, as one without periods: what they say together of the laws that the model omits.
    fn together(&mut self, last: &ProcessedLog, inputs: &Inputs) -> Result<(ProcessedLog, Inputs), Error> {
        let is_alike = |log: &ProcessedLog| {
            let (samples, of_last) = (&log.samples, &last.samples);
            samples.block == of_last.block && samples.rate_hz.to_bits() == of_last.rate_hz.to_bits()
        };
        let (mut alike, mut of_alike) = (Vec::new(), Vec::new());
        for (log, round) in self.logs.iter_mut().zip(&self.rounds) {
            let file = Text::read(&round.estimate())?;
            if log.is_none() {
                *log = Some(LogSource::default().again(&file, &[])?.0);
            }
            if let Some(log) = log.clone().filter(is_alike) {
                alike.push(log);
                of_alike.extend(Inputs::of_estimate(&file)?);
            }
        }
        alike.push(last.clone());
        of_alike.push(inputs.clone());
        let parts: Vec<&Samples> = alike.iter().map(|log| &log.samples).collect();
        // Scatter over the periods of each; without it the residual says what noise is.
        let noise =
            parts.iter().filter(|of| !of.is_noise_free()).filter_map(|of| Some((of.noise.as_ref()?, of.blocks())));
        let noise = Some(noise.collect::<Vec<_>>()).filter(|each| each.len() == parts.len());
        let noise = noise.and_then(|each| NoiseModel::mean(&each));
        let periods = parts.iter().map(|of| of.periods).min().unwrap_or(1);
        let mut all = ProcessedLog::join(alike)?;
        (all.samples.noise, all.samples.torque_covariance, all.samples.periods) = (noise, None, periods);
        // A recording holds its robot, and does not say what it was called.
        let text = |key: &str| self.settings.experiment.get(key).and_then(Value::as_str).map(str::to_owned);
        let [name, base_link, tip_link] = ["robot", "base_link", "tip_link"].map(text);
        let robot = RobotSource { name, base_link, tip_link, sha256: inputs.robot.sha256.clone() };
        Ok((all, joined(of_alike, Inputs { robot, ..inputs.clone() })))
    }

    fn outcome(&self) -> Outcome {
        let targets = self.aims.iter().zip(&self.widths).map(|(aim, widths)| (aim.target.limit(), widths.clone()));
        outcome(&targets.collect::<Vec<_>>(), self.settings.most_rounds, self.is_model_error_shown())
    }

    fn is_model_error_shown(&self) -> bool {
        let chance = chance_of_a_look(self.settings.most_rounds);
        self.pooled.last().is_some_and(|last| is_model_error_shown(&last.estimate, chance))
    }

    /// How it stands, with its estimate and its figure in the folder.
    ///
    /// # Errors
    /// [`Error`] where one of them cannot be written.
    pub fn answer(&self) -> Result<CampaignAnswer, Error> {
        let mut total_s = 0.0;
        let rounds = self.rounds.iter().zip(&self.pooled).enumerate().map(|(k, (round, pooled))| {
            total_s += round.seconds;
            RoundAnswer {
                number: round.number,
                seconds: round.seconds,
                total_s,
                widened_by: pooled.widened_by,
                widths: self.widths.iter().map(|widths| widths[k]).collect(),
            }
        });
        let rounds = rounds.collect();
        let targets = || self.aims.iter().zip(&self.widths);
        let is_met = |(aim, widths): (&Aim, &Vec<Width>)| {
            widths.last().is_some_and(|last| last.half_width <= aim.target.limit())
        };
        let obstacles = self.pooled.last().filter(|_| self.is_model_error_shown()).map_or_else(Vec::new, |last| {
            let blocked = targets().filter(|(aim, widths)| is_out_of_reach(aim.target.limit(), widths));
            blocked.map(|(aim, _)| Obstacle::of(&aim.target, &last.estimate)).collect()
        });
        let mut answer = CampaignAnswer {
            robot: self.loaded.robot.name().to_owned(),
            outcome: self.outcome(),
            targets: self.settings.until.clone(),
            units: self.aims.iter().map(|aim| aim.unit.clone()).collect(),
            met: targets().map(is_met).collect(),
            obstacles,
            most_rounds: self.settings.most_rounds,
            rounds,
            estimate: None,
            figure: None,
        };
        if let Some(pooled) = self.pooled.last() {
            let place = self.folder.join("estimate.json");
            let mut value = json!(pooled.estimate);
            if let Some(last) = self.rounds.last() {
                // Paths begin in the folder, where this file is.
                value["inputs"] = stated_inputs(&last.together())?;
            }
            write_text(&place, &pretty(&value))?;
            answer.estimate = Some(place);
        }
        if let Some(svg) = figure::svg(&answer)? {
            let place = self.folder.join("progress.svg");
            write_text(&place, &svg)?;
            answer.figure = Some(place);
        }
        Ok(answer)
    }
}
