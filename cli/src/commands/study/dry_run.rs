//! `armid study --dry-run`

use armid::study::StudyPlans;
use armid_io::Error;
use armid_workflow::study::{Forecast, SAMPLE_EVALUATIONS, forecast};
use miette::Result;

use super::request::Request;
use crate::terminal::{Answer, Console, Ending};

/// Says what the study costs; on several robots, on each and together.
pub(super) fn run(request: &Request, console: &Console) -> Result<Ending> {
    let beside = request.beside.as_deref();
    let answer = match &request.plans {
        StudyPlans::One(plan) => answer(&forecast(plan, beside)?)?,
        StudyPlans::OnRobots(plans) => {
            let (mut text, mut robots, mut hours) = (String::new(), Vec::new(), 0.0);
            for plan in plans {
                let forecast = forecast(plan, beside)?;
                let answer = answer(&forecast)?;
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

fn answer(forecast: &Forecast) -> Result<Answer, Error> {
    let bytes = |bytes: u64| match bytes as f64 {
        most if most >= 1e9 => format!("{:.1} GB", most / 1e9),
        some => format!("{:.0} MB", (some / 1e6).ceil()),
    };
    let memory = forecast.memory_bytes.map_or("not known on this system".to_owned(), bytes);
    let text = format!(
        "{} designs, {} runs ({} conditions, {} arms)\n\
         {:.2} core-hours: {:.2} of designs at most, {:.2} of runs\n\
         disk: {} of journal and {} of numbers while it runs, {} of results\n\
         memory: {memory}\n\
         shared: {}\n\
         by {} designs of at most {SAMPLE_EVALUATIONS} evaluations and {} runs under {} of the conditions, {:.1} s; hours are those of this machine's cores; nothing was written\n",
        forecast.designs,
        forecast.runs,
        forecast.conditions,
        forecast.truths,
        forecast.core_hours(),
        forecast.design_core_hours,
        forecast.run_core_hours,
        bytes(forecast.journal_bytes),
        bytes(forecast.numbers_bytes),
        bytes(forecast.results_bytes),
        forecast.shared.join("; "),
        forecast.sample_designs,
        forecast.sample_runs,
        forecast.sample_conditions,
        forecast.sample_seconds,
    );
    Ok(Answer { text, json: serde_json::to_value(forecast).map_err(Error::of)? })
}
