//! A study performed here, whole or in part.

use std::path::{Path, PathBuf};

use armid::observer::Observer;
use armid::remedy::{Remedy, Setting};
use armid::study::{OwnMethods, StoppingRule, StudyPlan, StudyPlanError, StudyPlans};
use armid_io::Error;
use armid_io::study::{FinishedWork, Journal};

use super::answer::StudyAnswer;
use super::part::{Part, Stage, designs_from};
use super::performance::Performance;
use super::prepared::PreparedStudy;
use super::robots;
use super::settings::StudySettings;

/// Performs a study on one robot or on each of several, and stores what it finds.
///
/// Equal plans give equal bytes of every result for any number of threads, parts and resumptions.
///
/// # Errors
/// [`Error`] where the study cannot be prepared, the folder holds another one, or a part or an early end is asked for of a study
/// on several robots.
pub fn perform(plans: &StudyPlans, settings: &StudySettings, observer: &dyn Observer) -> Result<StudyAnswer, Error> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build().map_err(Error::new)?;
    match plans {
        StudyPlans::One(plan) => threads.install(|| perform_one(plan, settings, observer)),
        StudyPlans::OnRobots(plans) if settings.part == Part::default() && settings.until.is_none() => {
            threads.install(|| robots::perform(plans, settings, observer))
        }
        StudyPlans::OnRobots(_) => {
            Err(Error::mismatch("found a study on several robots, expected one robot for a part or an early end"))
        }
    }
}

fn perform_one(plan: &StudyPlan, settings: &StudySettings, observer: &dyn Observer) -> Result<StudyAnswer, Error> {
    let prepared = PreparedStudy::new(plan.clone(), settings.beside.as_deref(), &settings.own)?;
    let study = prepared.performance(&settings.output, settings.part, observer);
    if let Some(words) = &settings.until {
        return perform_until(study, words, settings);
    }
    match settings.part.stage {
        Some(Stage::Designs) => {
            let mut work = study.no_work()?;
            study.begin(&mut work, settings.resume)?;
            Ok(if study.perform_designs(work)? { study.part_answer() } else { study.interrupted() })
        }
        Some(Stage::Runs) | None => {
            // Before a journal is begun: a mistaken folder is found while nothing is written yet.
            let mut work = study.no_work()?;
            for folder in &settings.designs_from {
                designs_from(folder, &mut work, study.setup)?;
            }
            study.begin(&mut work, settings.resume)?;
            study.answer(work)
        }
    }
}

/// Starts of all families until a rule is met, and the study of those that were performed.
fn perform_until(mut study: Performance<'_>, words: &str, settings: &StudySettings) -> Result<StudyAnswer, Error> {
    let rule: StoppingRule = words.parse().map_err(Error::new)?;
    rule.families(&study.setup.plan).map_err(|error| match error {
        StudyPlanError::Family { found, families, .. } => {
            let until = Remedy::default().setting(Setting::Until);
            Error::new(format!("{until} is \"{found}\", expected one of the families: {}", families.join(", ")))
        }
        other => Error::new(other),
    })?;
    let mut work = study.no_work()?;
    study.begin(&mut work, settings.resume)?;
    let Some((looks, work)) = study.perform_until(work, &rule, words)? else {
        return Ok(study.interrupted());
    };
    let first = study.setup.plan.first_starts(looks.starts());
    let performed = PreparedStudy::new(first, settings.beside.as_deref(), &settings.own)?;
    let first = performed.performance(&settings.output, Part::default(), study.observer);
    Ok(StudyAnswer::Whole(Box::new(first.sum_up_first(&study, work, looks)?)))
}

/// Puts the parts of a study together in `output`; every piece must be there, since a merge performs nothing.
///
/// # Errors
/// [`Error`] where a part is missing or of another study, or the output is one of the parts.
pub fn merge(
    plan: StudyPlan,
    beside: Option<&Path>,
    folders: &[PathBuf],
    output: &Path,
    observer: &dyn Observer,
) -> Result<StudyAnswer, Error> {
    let place = |folder: &Path| folder.canonicalize().ok();
    if let Some(part) = folders.iter().find(|part| place(part).is_some_and(|part| place(output) == Some(part))) {
        let message = format!("the output folder {} is one of the parts, expected another folder", part.display());
        return Err(Error::mismatch(message).help(Remedy::from("choose another folder with ").setting(Setting::Output)));
    }
    let prepared = PreparedStudy::new(plan, beside, &OwnMethods::default())?;
    let study = prepared.performance(output, Part::default(), observer);
    let mut work = study.no_work()?;
    for folder in folders {
        work.include(&folder.join(Journal::NAME), study.setup)?;
    }
    let missing = study.missing(&work);
    if missing > 0 {
        let message = format!("{missing} runs are in none of the folders, expected every part of the study, complete");
        return Err(Error::new(message));
    }
    study.begin(&mut work, false)?;
    study.answer(work)
}

impl Performance<'_> {
    /// Performs what is missing, and sums up a whole study.
    fn answer(&self, work: FinishedWork) -> Result<StudyAnswer, Error> {
        Ok(match self.perform(work)? {
            Some(performed) if self.part.is_whole() => StudyAnswer::Whole(Box::new(self.sum_up(performed)?)),
            Some(_) => self.part_answer(),
            None => self.interrupted(),
        })
    }

    fn part_answer(&self) -> StudyAnswer {
        StudyAnswer::Part { part: self.part, folder: self.output.to_path_buf() }
    }

    fn interrupted(&self) -> StudyAnswer {
        StudyAnswer::Interrupted { folder: self.output.to_path_buf() }
    }
}
