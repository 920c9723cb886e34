//! The first screen of an estimate: what it predicts, what the motion determines, and the one or two findings that matter.

use std::fmt::Write;

use armid::diagnosis::Suspicion;
use armid::estimation::{Against, Estimate, Finding, ResidualTrends, TorqueResidual, Trend};
use armid_io::ProcessedLog;
use armid_workflow::identification::advice;
use serde_json::{Value, json};

use super::exchange::Exchange;
use super::findings::{Group, groups, paragraph};
use super::labels::{joint_names, percent};
use super::model_prediction::PredictionError;

/// Findings on the first screen.
const SHOWN: usize = 2;

/// Share of the power of a joint's residual from which on a shape in it matters.
const LARGE_SHARE: f64 = 0.2;

/// What an estimate is worth, and what to do about it.
pub(crate) struct Verdict {
    /// Torque that is not explained: in total and of the worst joint, held out where anything is.
    total: Option<f64>,
    worst: Option<(String, f64)>,
    held_out: bool,
    /// Parameters that are determined, and all of them.
    determined: usize,
    parameters: usize,
    /// What model files would predict of the same torque.
    files: Vec<(Exchange, PredictionError)>,
    /// Sentences and the action of each finding.
    findings: Vec<(Vec<String>, String)>,
    /// Groups of findings that are among them.
    groups: usize,
}

impl Verdict {
    pub(crate) fn new(
        estimate: &Estimate,
        prepared: &ProcessedLog,
        used: &TorqueResidual,
        held_out: Option<&TorqueResidual>,
        (suspicions, files): (&[Suspicion], &[(Exchange, PredictionError)]),
        trends: Option<&ResidualTrends>,
    ) -> Self {
        let joints = joint_names(prepared);
        let of = &held_out.unwrap_or(used).all;
        let shares = joints.iter().zip(&of.share).filter_map(|(joint, share)| Some((joint.clone(), (*share)?)));
        let is_doubtful = |finding: &&Finding| matches!(finding, Finding::PoorlyDetermined { .. });
        let doubtful = estimate.findings.iter().filter(is_doubtful).count();
        let mut findings: Vec<(Vec<String>, String)> =
            suspicions.iter().map(|of| (vec![of.mistake.to_string()], advice(of, prepared))).collect();
        let open = SHOWN.saturating_sub(findings.len());
        let groups = groups(&estimate.findings);
        let matter = groups.iter().take(open).take_while(|group| group.matters()).map(Group::said);
        let matter: Vec<_> = matter.collect();
        let in_groups = matter.len();
        findings.extend(matter);
        // A log without periods has no noise to compare with: what is left has a shape all the same.
        let strongest = trends.and_then(|trends| trends.trends.first()).filter(|trend| trend.share >= LARGE_SHARE);
        if let Some(trend) = strongest.filter(|_| in_groups < open) {
            findings.push((vec![trend.sentence(&joints[trend.joint])], action(trend).to_owned()));
        }
        Self {
            total: of.total,
            worst: shares.max_by(|a, b| a.1.total_cmp(&b.1)),
            held_out: held_out.is_some(),
            determined: estimate.base.len() - doubtful,
            parameters: estimate.base.len(),
            files: files.to_vec(),
            findings,
            groups: in_groups,
        }
    }

    /// How many groups of findings need not be said again.
    pub(crate) const fn groups(&self) -> usize {
        self.groups
    }

    pub(crate) fn json(&self) -> Value {
        let worst = self.worst.as_ref();
        let findings = self.findings.iter().map(|(sentences, action)| json!({ "text": sentences, "advice": action }));
        json!({
            "of": if self.held_out { "held-out" } else { "fit" },
            "total": self.total,
            "worst_joint": worst.map(|(joint, share)| json!({ "name": joint, "share": share })),
            "determined": self.determined,
            "parameters": self.parameters,
            "files": self.files.iter().map(|(format, error)| json!({ "to": format.name(), "total": error.shown() })).collect::<Value>(),
            "findings": findings.collect::<Value>(),
        })
    }

    pub(crate) fn text(&self) -> String {
        let of = if self.held_out { "held-out torque" } else { "torque of the fit (nothing is held out)" };
        let mut error = format!("error of the {of}: {}", percent(self.total));
        if let Some((joint, share)) = &self.worst {
            let _ = write!(error, ", worst at {joint}: {}", percent(Some(*share)));
        }
        let mut text = paragraph(&error, 2);
        let determined = format!(
            "this motion determines {} of {} parameters to within a third of their value",
            self.determined, self.parameters
        );
        text += &paragraph(&determined, 2);
        let files: Vec<String> = self
            .files
            .iter()
            .map(|(format, error)| format!("{} with {}", format.name(), percent(Some(error.shown()))))
            .collect();
        if !files.is_empty() {
            text +=
                &paragraph(&format!("a file of `armid export` predicts the same torque as {}", files.join(", as ")), 2);
        }
        for (sentences, action) in &self.findings {
            text.push('\n');
            for sentence in sentences {
                text += &paragraph(sentence, 2);
            }
            text += &paragraph(&format!("→ {action}"), 4);
        }
        text
    }
}

/// What to do about a shape of the residual.
const fn action(trend: &Trend) -> &'static str {
    match trend.shape.against() {
        Against::Time => "compare fits of the first and the last half of the log: --until, --from",
        Against::Speed | Against::Position => "test more terms with --select",
        Against::Load => "check gear ratio and torque constant of this joint, and test load friction with --select",
    }
}
