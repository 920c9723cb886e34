//! The first screen of an estimate: what it predicts, what the motion determines, and the one or two findings that matter.

use armid::diagnosis::Suspicion;
use armid::estimation::{Against, Estimate, Finding, ResidualTrends, Trend};
use armid::observer::Observer;
use armid::remedy::{Remedy, Setting};
use armid_io::ProcessedLog;
use armid_io::log::LogResidual;
use serde::Serialize;

use super::advice::advice;
use super::findings::{Group, groups};
use crate::export::{Exchange, prediction_of};

/// Findings on the first screen.
const SHOWN: usize = 2;

/// Share of the power of a joint's residual from which on a shape in it matters.
const LARGE_SHARE: f64 = 0.2;

/// What an estimate is worth, and what to do about it.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// Which torque the errors are of: `held-out` where anything is, or `fit`.
    pub of: &'static str,
    /// Torque that is not explained, as a share of the measured one.
    pub total: Option<f64>,
    /// Torque that is not explained of the worst joint.
    pub worst_joint: Option<JointShare>,
    /// Parameters that are determined to within a third of their value.
    pub determined: usize,
    /// All parameters.
    pub parameters: usize,
    /// What model files would predict of the same torque.
    pub files: Vec<FileError>,
    /// Findings that matter.
    pub findings: Vec<Advised>,
    /// Groups of the estimate's findings that are among them.
    #[serde(skip)]
    pub groups: usize,
}

/// A share of a joint.
#[derive(Clone, Debug, Serialize)]
pub struct JointShare {
    /// The joint.
    pub name: String,
    /// The share.
    pub share: f64,
}

/// What a model file would predict.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FileError {
    /// Its format.
    pub to: Exchange,
    /// Torque that it leaves unexplained, as a share of the measured one.
    pub total: f64,
}

impl FileError {
    /// Those of a URDF and an MJCF; nothing of a format in which no model of the log can be made.
    pub(super) fn all(log: &ProcessedLog, observer: &dyn Observer) -> Vec<Self> {
        let of = |to| Some(Self { to, total: prediction_of(to, log, observer).ok()?.shown() });
        [Exchange::Urdf, Exchange::Mjcf].into_iter().filter_map(of).collect()
    }
}

/// What was found, and what to do.
#[derive(Clone, Debug, Serialize)]
pub struct Advised {
    /// Sentences.
    pub text: Vec<String>,
    /// What to do.
    pub advice: Remedy,
}

impl Verdict {
    /// The verdict on an estimate with this residual in a log with these suspicions; `trends` are what the residual shows, and `files` what model files
    /// of the log would predict. Equations that no test of a shape can use show nothing. A log without periods has no noise to compare
    /// with: what is left has a shape all the same.
    pub(super) fn new(
        estimate: &Estimate,
        LogResidual { used, held_out }: &LogResidual,
        trends: Option<&ResidualTrends>,
        log: &ProcessedLog,
        suspicions: &[Suspicion],
        files: &[FileError],
    ) -> Self {
        let joints = log.joint_names();
        let rows = &held_out.as_ref().unwrap_or(used).all;
        let shares = joints.iter().zip(&rows.share);
        let shares = shares.filter_map(|(joint, share)| Some(JointShare { name: joint.clone(), share: (*share)? }));
        let is_doubtful = |finding: &&Finding| matches!(finding, Finding::PoorlyDetermined { .. });
        let doubtful = estimate.findings.iter().filter(is_doubtful).count();
        let mut findings: Vec<Advised> = suspicions
            .iter()
            .map(|of| Advised { text: vec![of.mistake.to_string()], advice: advice(of, log) })
            .collect();
        let open = SHOWN.saturating_sub(findings.len());
        let groups = groups(&estimate.findings);
        let matter = groups.iter().take(open).take_while(|group| group.matters()).map(Group::said);
        let matter: Vec<_> = matter.map(|(text, advice)| Advised { text, advice: advice.into() }).collect();
        let in_groups = matter.len();
        findings.extend(matter);
        let strongest = trends.and_then(|trends| trends.trends.first());
        if let Some(trend) = strongest.filter(|trend| trend.share >= LARGE_SHARE && in_groups < open) {
            findings.push(Advised { text: vec![trend.sentence(&joints[trend.joint])], advice: action(trend) });
        }
        Self {
            of: if held_out.is_some() { "held-out" } else { "fit" },
            total: rows.total,
            worst_joint: shares.max_by(|a, b| a.share.total_cmp(&b.share)),
            determined: estimate.base.len() - doubtful,
            parameters: estimate.base.len(),
            files: files.to_vec(),
            findings,
            groups: in_groups,
        }
    }
}

/// What to do about a shape of the residual.
fn action(trend: &Trend) -> Remedy {
    match trend.shape.against() {
        Against::Time => Remedy::from("compare fits of the first and the last half of the log: ")
            .setting(Setting::Until)
            .say(", ")
            .setting(Setting::From),
        Against::Speed | Against::Position => Remedy::from("test more terms with ").setting(Setting::Select),
        Against::Load => {
            let words = "check gear ratio and torque constant of this joint, and test load friction with ";
            Remedy::from(words).setting(Setting::Select)
        }
    }
}
