//! The plan of a study by what it is called: a bundled name, a folder with a `study.toml`, or the file itself.

use std::path::{Path, PathBuf};

use armid::model::format::ChainEnds;
use armid::study::{OwnMethods, StudyPlan, StudyPlans};

use crate::bundled_experiments;
use crate::error::{Error, ErrorKind};
use crate::robot;
use crate::suggestion;
use crate::text::Text;

const FILE: &str = "study.toml";

/// The plan of a study on one robot, and the folder of its file where it is one: relative paths in it begin there. `engines`
/// are the names of those that its conditions may ask for.
///
/// # Errors
/// [`Error`] where there is no such study, its file is not as a study is written, or it is one on several robots.
pub fn load(name: &str, engines: &[&'static str]) -> Result<(StudyPlan, Option<PathBuf>), Error> {
    let (plans, folder) = load_all(name, engines, &OwnMethods::default())?;
    match plans {
        StudyPlans::One(plan) => Ok((*plan, folder)),
        StudyPlans::OnRobots(plans) => {
            let robots: Vec<&str> = plans.iter().map(|plan| plan.robot.as_str()).collect();
            let message =
                format!("{name}: found a study on the robots {}, expected one on one robot", robots.join(", "));
            Err(Error::mismatch(message))
        }
    }
}

/// Reads the plan of a study on one robot or on several, which may name methods from outside; each robot of several is there.
///
/// # Errors
/// As [`load`], and where a robot of several cannot be loaded.
pub fn load_all(
    name: &str,
    engines: &[&'static str],
    own: &OwnMethods,
) -> Result<(StudyPlans, Option<PathBuf>), Error> {
    let path = Path::new(name);
    let (text, folder) = if path.is_dir() {
        (Text::read(&path.join(FILE))?, Some(path.to_path_buf()))
    } else if path.is_file() {
        (Text::read(path)?, path.parent().map(Path::to_path_buf))
    } else {
        match bundled_experiments::find(name, FILE) {
            Some(entry) => (Text::new(format!("experiments/{}/{FILE}", entry.folder), entry.text), None),
            None => {
                let message = format!("study \"{name}\" is neither a bundled study, nor a folder, nor a file");
                return Err(Error::unknown(message).help(suggestion::help(name, &bundled_experiments::names(FILE))));
            }
        }
    };
    let plans = StudyPlans::from_toml_with(&text.content, own).map_err(|error| Error::of_format(&text, &error))?;
    for plan in plans.plans() {
        plan.check_engines(engines).map_err(|error| Error::of_format(&text, &error.in_text(&text.content)))?;
    }
    if let StudyPlans::OnRobots(plans) = &plans {
        for plan in plans {
            robot::load(&plan.robot, &ChainEnds::default(), folder.as_deref()).map_err(|error| match error.kind() {
                ErrorKind::Unknown => at_robot(error, &text, &plan.robot),
                _ => error,
            })?;
        }
    }
    Ok((plans, folder))
}

/// The error at a robot's name in the list of a plan.
fn at_robot(error: Error, text: &Text, robot: &str) -> Error {
    let lines = text.content.split_inclusive('\n').scan(0, |begin, line| {
        let start = *begin;
        *begin += line.len();
        Some((start, line))
    });
    let list = lines.filter(|(_, line)| line.trim_start().starts_with("robots")).map(|(start, _)| start).next();
    let place = list.and_then(|list| Some(list + text.content[list..].find(&format!("\"{robot}\""))?));
    match place {
        Some(place) => error.at_span(text, place..place + robot.len() + 2, "here"),
        None => error,
    }
}
