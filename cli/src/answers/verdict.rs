//! The first screen of an estimate as a text.

use std::fmt::Write;

use armid_workflow::identification::Verdict;
use armid_workflow::numbers::percent;

use super::findings::paragraph;

/// Its sentences.
pub(super) fn verdict_text(verdict: &Verdict) -> String {
    let of = if verdict.of == "fit" { "torque of the fit (nothing is held out)" } else { "held-out torque" };
    let mut error = format!("error of the {of}: {}", percent(verdict.total));
    if let Some(worst) = &verdict.worst_joint {
        let _ = write!(error, ", worst at {}: {}", worst.name, percent(Some(worst.share)));
    }
    let mut text = paragraph(&error, 2);
    let determined = format!(
        "this motion determines {} of {} parameters to within a third of their value",
        verdict.determined, verdict.parameters
    );
    text += &paragraph(&determined, 2);
    let files = verdict.files.iter().map(|file| format!("{} with {}", file.to.name(), percent(Some(file.total))));
    let files: Vec<String> = files.collect();
    if !files.is_empty() {
        text += &paragraph(&format!("a file of `armid export` predicts the same torque as {}", files.join(", as ")), 2);
    }
    for finding in &verdict.findings {
        text.push('\n');
        for sentence in &finding.text {
            text += &paragraph(sentence, 2);
        }
        text += &paragraph(&format!("→ {}", finding.advice), 4);
    }
    text
}
