//! What `armid study` says of a study on several robots: how many comparisons they agree on, and where the report is.

use std::path::Path;

use armid::study::{Agreement, RobotsSummary};
use armid_io::Error;

use crate::terminal::{Answer, Table};

/// The answer of a study that is finished on every robot.
pub(crate) fn answer(summary: &RobotsSummary, page: &Path) -> Result<Answer, Error> {
    let counted = Agreement::ALL.map(Agreement::words).join(" | #");
    let mut table = Table::of(&format!("metric | estimator | #{counted}"));
    for counts in &summary.agreements {
        let mut row = vec![counts.metric.title().to_owned(), counts.estimator.clone()];
        row.extend(Agreement::ALL.map(|agreement| counts.count(agreement).to_string()));
        table.row(row);
    }
    let robots: Vec<&str> = summary.robots.iter().map(|robot| robot.robot.as_str()).collect();
    let text = format!(
        "{}\n\nComparisons of two criteria in one scenario, on {}:\n\n{}\nreport: {}\n",
        summary.question,
        robots.join(", "),
        table.render(0),
        page.display()
    );
    let mut json = serde_json::to_value(summary).map_err(Error::new)?;
    json["report"] = page.display().to_string().into();
    Ok(Answer { text, json })
}
