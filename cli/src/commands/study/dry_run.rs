//! `armid study --dry-run`

use std::path::Path;

use armid::study::{StudyPlan, StudyPlans};
use miette::Result;

use super::request::Request;
use crate::study::{Forecast, Part, Prepared, sample_plan};
use crate::terminal::{Answer, Console, Ending};

/// Says what the study costs; on several robots, on each and together.
pub(super) fn run(request: &Request, console: &Console) -> Result<Ending> {
    let forecast = |plan: &StudyPlan| -> Result<Forecast> {
        let sample = Prepared::new(sample_plan(plan), request.beside.as_deref())?;
        sample.performance(Path::new(""), Part::default(), console).forecast(plan)
    };
    let answer = match &request.plans {
        StudyPlans::One(plan) => forecast(plan)?.answer()?,
        StudyPlans::OnRobots(plans) => {
            let (mut text, mut robots, mut hours) = (String::new(), Vec::new(), 0.0);
            for plan in plans {
                let forecast = forecast(plan)?;
                let answer = forecast.answer()?;
                hours += forecast.core_hours();
                text += &format!("{}\n{}\n", plan.robot, answer.text);
                robots.push(serde_json::json!({ "robot": plan.robot, "forecast": answer.json }));
            }
            text += &format!("all {} robots: {hours:.2} core-hours\n", plans.len());
            Answer { text, json: serde_json::json!({ "robots": robots, "core_hours": hours }) }
        }
    };
    console.answer(&answer)?;
    Ok(Ending::Done)
}
