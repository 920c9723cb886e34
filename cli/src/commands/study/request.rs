//! The study that a command line asks for: on one robot, or on each of several.

use std::path::PathBuf;

use armid::study::{StudyPlan, StudyPlans};
use armid_io::Error;
use miette::Result;

use crate::terminal::{Console, report_folder};

/// A study, with the values of the command line in it.
pub(crate) struct Request {
    /// What it is called there.
    pub(super) study: String,
    /// Its plan, on one robot or on each of several.
    pub(super) plans: StudyPlans,
    /// The folder that relative paths of the plan begin at.
    pub(super) beside: Option<PathBuf>,
    /// The robot's folder below that of the study, where one of several was picked.
    pub(super) below: Option<String>,
}

impl Request {
    /// The study on this robot alone.
    pub(super) fn for_robot(self, robot: &str) -> Result<Self, Error> {
        let plans = self.plans.plans();
        let Some(plan) = plans.iter().find(|plan| plan.robot == robot).cloned() else {
            let robots: Vec<&str> = plans.iter().map(|plan| plan.robot.as_str()).collect();
            let message = format!("--robot is \"{robot}\", expected one of the robots of {}", self.study);
            return Err(Error::unknown(message).help(format!("expected one of: {}", robots.join(", "))));
        };
        let below = matches!(self.plans, StudyPlans::OnRobots(_)).then(|| plan.robot_folder());
        Ok(Self { plans: StudyPlans::One(Box::new(plan)), below, ..self })
    }

    /// The plan where it is on one robot; `arguments` are those that ask for one robot, as they stand on a command line.
    pub(super) fn single_plan(&self, arguments: &str) -> Result<&StudyPlan, Error> {
        match &self.plans {
            StudyPlans::One(plan) => Ok(plan),
            StudyPlans::OnRobots(plans) => {
                let robots: Vec<&str> = plans.iter().map(|plan| plan.robot.as_str()).collect();
                let (study, first, folder) = (&self.study, &plans[0].robot, plans[0].robot_folder());
                let message =
                    format!("{study} is a study on the robots {}, expected one of them here", robots.join(", "));
                Err(Error::mismatch(message).help(format!(
                    "`armid study {} --robot {first}` with -o DIR/{folder}, and so for the others; \
                     `armid study {study} --resume -o DIR` sets them side by side when all are there",
                    arguments.replace("STUDY", study)
                )))
            }
        }
    }

    /// Where the study is stored: the folder of -o, or the study's own.
    pub(super) fn output(&self, console: &Console) -> Result<PathBuf> {
        let folder = output_folder(&self.plans.plans()[0], console)?;
        match &self.below {
            Some(below) if console.output().is_none() => Ok(folder.join(below)),
            Some(_) | None => Ok(folder),
        }
    }
}

/// The folder that the command line names, or the plan's own.
pub(super) fn output_folder(plan: &StudyPlan, console: &Console) -> Result<PathBuf> {
    Ok(console.output_or(|| report_folder("name", &plan.name))?)
}
