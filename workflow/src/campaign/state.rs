//! A campaign, round by round.

use std::path::{Path, PathBuf};

use armid::base::{Method, reduce};
use armid::estimation::{Estimate, Pooled, Together, pool};
use armid::model::format::ChainEnds;
use armid::model::{Columns, distinct};
use armid::observer::{Observer, Unobserved};
use armid::remedy::{Remedy, Setting};
use armid::seed::Seed;
use armid_io::estimate::{check_robot, read};
use armid_io::inputs::RobotSource;
use armid_io::output::{pretty, write_text};
use armid_io::{Error, ErrorKind, Inputs, LoadedRobot, ProcessedLog, Text, robot};
use serde_json::json;
use toml::Value;

use super::aim::Aim;
use super::folder::{Round, SETTINGS, beginning_in, joined, read_toml};
use super::logs::{are_alike, estimate, join};
use super::motion::Motion;
use super::settings::CampaignSettings;
use super::stopping::{Outcome, Width, chance_of_a_look, is_model_error_shown, outcome};
use super::terms::{COLUMNS, SelectedColumns, extended};
use crate::identification::advice;
use crate::log_source::LogSource;

/// A campaign, with the rounds that are finished.
#[derive(Debug)]
pub struct Campaign {
    pub(super) folder: PathBuf,
    pub(super) settings: CampaignSettings,
    pub(super) loaded: LoadedRobot,
    /// Those of all estimates: of the settings, with the terms that were added.
    columns: Columns,
    pub(super) added_terms: Vec<String>,
    /// Finished rounds when terms were selected last.
    selected_after: usize,
    pub(super) aims: Vec<Aim>,
    pub(super) rounds: Vec<Round>,
    estimates: Vec<Estimate>,
    /// The logs that were taken; of a campaign that goes on they are read again.
    logs: Vec<Option<ProcessedLog>>,
    /// After each round, by it and all before.
    pub(super) pooled: Vec<Pooled>,
    /// Target by target, after each round.
    pub(super) widths: Vec<Vec<Width>>,
}

/// What comes next.
#[derive(Clone, Debug)]
pub enum Step {
    /// A round, whose log is then [taken](Campaign::take).
    Perform(Round),
    /// Nothing: the campaign has ended.
    Ended,
    /// The observer ended the search of a motion or the selection of terms, which begins again at the next call.
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
        match read_toml::<CampaignSettings>(&place)? {
            Some(there) if there != settings => {
                let message = format!("{} is of another campaign, expected the settings of this one", place.display());
                return Err(Error::mismatch(message).help(help()));
            }
            None if ["rounds", COLUMNS].iter().any(|name| folder.join(name).exists()) => {
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
        read_toml(&folder.join(SETTINGS))?.map(|settings| Self::of(settings, folder)).transpose()
    }

    fn of(settings: CampaignSettings, folder: &Path) -> Result<Self, Error> {
        settings.check()?;
        let text = |key: &str| settings.experiment.get(key).and_then(Value::as_str).map(str::to_owned);
        let ends = ChainEnds { base: text("base_link"), tip: text("tip_link") };
        let named =
            text("robot").ok_or_else(|| Error::new("the experiment of a campaign names no robot, expected one"))?;
        let loaded = robot::load(&named, &ends, Some(folder))?;
        let stated = Columns::parse_estimable(&settings.columns).map_err(Error::new)?;
        let selected: Option<SelectedColumns> = read_toml(&folder.join(COLUMNS))?;
        let (columns, selected_after) = selected.map_or((stated, 0), |of| (of.columns, of.after));
        let added = columns.terms().filter(|term| !stated.has(*term)).map(|term| term.entry().name.to_owned());
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
            added_terms: distinct(added),
            selected_after,
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
            let (mut estimate, mut together) = (read(&round.estimate())?, read(&round.together())?);
            check_robot(&estimate, &round.estimate().display().to_string(), &campaign.loaded)?;
            let mut log = None;
            if estimate.columns != columns.to_string() {
                let (again, inputs) = LogSource::default().again(&Text::read(&round.estimate())?, &[])?;
                let found = campaign.estimate_round(&round, &again, &inputs, &Unobserved)?;
                let Some(found) = found else { return campaign.without_terms() };
                (estimate, together) = found;
                log = Some(again);
            }
            campaign.add(round, estimate, &together, log)?;
        }
    }

    /// Goes on without the terms that were added, for good: a round does not show one of them, and each needs an estimate.
    fn without_terms(&self) -> Result<Self, Error> {
        let columns = Columns::parse_estimable(&self.settings.columns).map_err(Error::new)?;
        SelectedColumns { after: self.settings.most_rounds, columns }.write(&self.folder)?;
        Self::of(self.settings.clone(), &self.folder)
    }

    /// Selects terms by the logs of all rounds. With those that are new, all rounds are estimated again. A campaign that is killed meanwhile
    /// does the rest when it is opened, since the columns are written first.
    fn add_terms(&mut self, observer: &dyn Observer) -> Result<(), Error> {
        let Some(last) = self.rounds.last() else { return Ok(()) };
        let (log, inputs) = LogSource::default().again(&Text::read(&last.estimate())?, &[])?;
        let before = self.rounds.len() - 1;
        let (all, _) = self.together(before, &log, &inputs)?;
        let rounds: Vec<&ProcessedLog> = self.logs.iter().take(before).flatten().chain([&log]).collect();
        let columns = extended(&self.loaded, self.columns, all, &rounds, observer)?;
        SelectedColumns { after: self.rounds.len(), columns }.write(&self.folder)?;
        Self::of(self.settings.clone(), &self.folder).map(|grown| *self = grown)
    }

    /// Adds a finished round, whose files are there. Where the estimates with added terms have no mean, all go on without the terms.
    fn add(
        &mut self,
        round: Round,
        estimate: Estimate,
        together: &Estimate,
        log: Option<ProcessedLog>,
    ) -> Result<(), Error> {
        self.estimates.push(estimate);
        let all: Vec<&Estimate> = self.estimates.iter().collect();
        let together = Together { estimate: together, do_motions_differ: !self.settings.repeats };
        let pooled = match pool(&all, Some(together)) {
            Err(_) if !self.added_terms.is_empty() => return self.without_terms().map(|less| *self = less),
            made => made.map_err(|error| Error::new(format!("{}: {error}", round.estimate().display())))?,
        };
        let chance = chance_of_a_look(self.settings.most_rounds);
        for (aim, widths) in self.aims.iter().zip(&mut self.widths) {
            widths.push(aim.width(&pooled.estimate, chance)?);
        }
        self.rounds.push(round);
        self.logs.push(log);
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

    /// What comes next. A round has its files when it is returned: motion, and experiment to perform. Where a target would be out of reach,
    /// terms that the logs show are added before.
    ///
    /// # Errors
    /// [`Error`] where no motion is found within the limits of the arm, a log is not there any more, or a file cannot be written.
    pub fn next(&mut self, observer: &dyn Observer) -> Result<Step, Error> {
        if self.seeks_terms() {
            match self.add_terms(observer) {
                Err(error) if error.kind() == ErrorKind::Interrupted => return Ok(Step::Interrupted),
                added => added?,
            }
        }
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
        let Some((estimate, together)) = self.estimate_round(&round, &log, inputs, observer)? else {
            *self = self.without_terms()?;
            return self.take(log, inputs, observer);
        };
        self.add(round, estimate, &together, Some(log))
    }

    /// The estimates of a round and of all so far, which are written. That of the round comes last: where it is, the rest is. `None` where they
    /// do not show a term that was added.
    fn estimate_round(
        &mut self,
        round: &Round,
        log: &ProcessedLog,
        inputs: &Inputs,
        observer: &dyn Observer,
    ) -> Result<Option<(Estimate, Estimate)>, Error> {
        let Some(estimate) = self.estimate(log, observer)? else { return Ok(None) };
        check_robot(&estimate, &log.name(), &self.loaded)?;
        let (all, inputs_of_all) = self.together(self.rounds.len(), log, inputs)?;
        let Some(together) = self.estimate(&all, observer)? else { return Ok(None) };
        let with_inputs = |estimate: &Estimate, inputs: Inputs| {
            let mut value = json!(estimate);
            value["inputs"] = json!(inputs);
            pretty(&value)
        };
        write_text(&round.together(), &with_inputs(&together, beginning_in(&self.folder, inputs_of_all)))?;
        write_text(&round.estimate(), &with_inputs(&estimate, beginning_in(&round.folder, inputs.clone())))?;
        Ok(Some((estimate, together)))
    }

    /// The estimate by a log; `None` where it does not show a term that was added.
    fn estimate(&self, log: &ProcessedLog, observer: &dyn Observer) -> Result<Option<Estimate>, Error> {
        let found = |columns| estimate(log, columns, self.settings.without.is_some(), observer);
        match found(self.columns) {
            Err(error) if error.kind() != ErrorKind::Interrupted && !self.added_terms.is_empty() => {
                // A log that has no estimate without them either is at fault itself.
                let stated = Columns::parse_estimable(&self.settings.columns).map_err(Error::new)?;
                found(stated).map(|_| None)
            }
            made => made.map(Some),
        }
    }

    /// The logs of so many rounds that are sampled as the last one, and that one, as one without periods: what they say together of the laws
    /// that the model omits.
    fn together(
        &mut self,
        before: usize,
        last: &ProcessedLog,
        inputs: &Inputs,
    ) -> Result<(ProcessedLog, Inputs), Error> {
        let (mut alike, mut of_alike) = (Vec::new(), Vec::new());
        for (log, round) in self.logs.iter_mut().zip(&self.rounds).take(before) {
            let file = Text::read(&round.estimate())?;
            if log.is_none() {
                *log = Some(LogSource::default().again(&file, &[])?.0);
            }
            if let Some(log) = log.clone().filter(|log| are_alike(log, last)) {
                alike.push(log);
                of_alike.extend(Inputs::of_estimate(&file)?);
            }
        }
        alike.push(last.clone());
        of_alike.push(inputs.clone());
        // A recording holds its robot, and does not say what it was called.
        let text = |key: &str| self.settings.experiment.get(key).and_then(Value::as_str).map(str::to_owned);
        let [name, base_link, tip_link] = ["robot", "base_link", "tip_link"].map(text);
        let robot = RobotSource { name, base_link, tip_link, sha256: inputs.robot.sha256.clone() };
        Ok((join(alike)?, joined(of_alike, Inputs { robot, ..inputs.clone() })))
    }

    pub(super) fn outcome(&self) -> Outcome {
        if self.seeks_terms() { Outcome::Unfinished } else { self.outcome_with_columns() }
    }

    /// Whether terms are to be selected, before a target counts as out of reach: once after a round.
    fn seeks_terms(&self) -> bool {
        // A load is found by two estimates with the same columns.
        let may = self.settings.adds_terms && self.settings.without.is_none();
        may && self.selected_after < self.rounds.len() && self.outcome_with_columns() == Outcome::ModelError
    }

    /// How it stands with these columns.
    fn outcome_with_columns(&self) -> Outcome {
        let targets = self.aims.iter().zip(&self.widths).map(|(aim, widths)| (aim.target.limit(), widths.clone()));
        outcome(&targets.collect::<Vec<_>>(), self.settings.most_rounds, self.is_model_error_shown())
    }

    pub(super) fn is_model_error_shown(&self) -> bool {
        let chance = chance_of_a_look(self.settings.most_rounds);
        // One motion is repeated for comparison: of what others would show, nothing is known.
        let last = self.pooled.last().filter(|_| !self.settings.repeats);
        last.is_some_and(|last| is_model_error_shown(&last.estimate, chance))
    }
}
