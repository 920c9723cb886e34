//! May a study be written into a folder? Results of another one there are not replaced.

use std::path::Path;

use armid::study::{OwnMethods, RobotResult, RobotsSummary, StudyPlan, StudyPlans};

use super::Journal;
use super::robots::read_robots;
use super::store::plan_text;
use crate::error::Error;
use crate::text::Text;

const PLAN: &str = "study.toml";
const ROWS: &str = "runs.parquet";
const SUMMARY: &str = "summary.json";

/// Refuses a folder with the results of another plan. Results of this plan's first starts, as `--until` stores them, are its
/// own. `own` are the methods from outside that the plan may name. The journal of an interrupted study is no result: a new study
/// keeps it under another name.
///
/// # Errors
/// [`Error`] where the folder holds results of another plan or without a plan, or another plan that nobody performed there.
pub fn check_output(folder: &Path, plan: &StudyPlan, own: &OwnMethods) -> Result<(), Error> {
    let holds = |name: &str| folder.join(name).exists();
    let has_results = holds(SUMMARY) || holds(ROWS);
    if !has_results && (!holds(PLAN) || holds(Journal::NAME)) {
        return Ok(());
    }
    let stored =
        Text::read(&folder.join(PLAN)).ok().and_then(|text| StudyPlans::from_toml_with(&text.content, own).ok());
    if let Some(StudyPlans::One(stored)) = stored {
        let starts = stored.designs.iter().map(|family| family.starts).max().unwrap_or(0);
        let text = plan_text(&stored)?;
        if text == plan_text(plan)? || text == plan_text(&plan.first_starts(starts))? {
            return Ok(());
        }
    }
    Err(occupied(folder, if has_results { "the results of another study" } else { "another plan, study.toml" }))
}

/// Refuses a folder for a study on several robots where it holds another study. The robots' own folders are checked one by one.
///
/// # Errors
/// [`Error`] where the folder holds a study on one robot, or one of another name or on other robots.
pub fn check_robots_output(folder: &Path, plans: &[StudyPlan]) -> Result<(), Error> {
    if folder.join(ROWS).exists() {
        return Err(occupied(folder, "a study on one robot"));
    }
    let is_own = |stored: &RobotsSummary| {
        let is_planned = |robot: &RobotResult| plans.iter().any(|plan| plan.robot == robot.robot);
        stored.robots.iter().all(is_planned) && plans.iter().all(|plan| plan.name == stored.name)
    };
    match read_robots(folder) {
        Ok(Some(stored)) if is_own(&stored) => Ok(()),
        Ok(None) if !folder.join(SUMMARY).exists() => Ok(()),
        Ok(_) | Err(_) => Err(occupied(folder, "the results of another study")),
    }
}

fn occupied(folder: &Path, what: &str) -> Error {
    let message = format!("{} holds {what}, expected a new folder or one of the same plan", folder.display());
    Error::mismatch(message).help("choose another folder with -o, or delete this one if nobody needs it")
}
