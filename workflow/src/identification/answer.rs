//! What an identification answers.

use armid::calibration::TransmissionStiffness;
use armid::diagnosis::Suspicion;
use armid::estimation::{Estimate, FrictionSpeeds, Selection, TorqueResidual};
use armid_io::{Inputs, ProcessedLog};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use super::advice::advice;
use super::friction_speed::speeds_json;
use super::verdict::Verdict;
use crate::report::LogFigures;

/// The estimates of one identification, and everything that is said of them. It serialises to the command's file: one object for one
/// estimator, a list for several.
#[derive(Clone, Debug)]
pub struct IdentifyAnswer {
    /// The log, with the speeds of its robot's friction where they were found.
    pub log: ProcessedLog,
    /// What it was made from, where that is known.
    pub inputs: Option<Inputs>,
    /// One estimate for each estimator.
    pub estimates: Vec<Identified>,
    /// Mistakes that the log seems to have been made with.
    pub suspicions: Vec<Suspicion>,
    /// The terms that the log supports, where they were asked for.
    pub selection: Option<Selection>,
    /// The speeds in which Coulomb friction sets in, where they were looked for.
    pub onset: Option<FrictionSpeeds>,
    /// The speeds at which friction falls, where they were asked for.
    pub speeds: Option<FrictionSpeeds>,
    /// Stiffness of the transmissions, where both their ends are measured.
    pub transmissions: Option<Vec<TransmissionStiffness>>,
    /// Whether an observer ended an estimator before it was at rest, or what follows: a verdict then lacks what model files predict.
    pub interrupted: bool,
}

/// One estimate, and what it leaves unexplained.
#[derive(Clone, Debug)]
pub struct Identified {
    /// The estimate.
    pub estimate: Estimate,
    /// Torque that it does not explain, in what was used.
    pub used: TorqueResidual,
    /// Torque that it does not explain, in what was held out.
    pub held_out: Option<TorqueResidual>,
    /// What each base parameter stands for.
    pub expressions: Vec<String>,
    /// What it is worth, and what to do about it.
    pub verdict: Verdict,
    /// What its page shows of the log; none beside other estimates, and where an observer ended the work.
    pub figures: Option<LogFigures>,
}

impl IdentifyAnswer {
    /// Did every search end as it should, and does nothing speak against the log?
    pub fn is_sound(&self) -> bool {
        let mut used = self.onset.iter().filter(|onset| onset.predict_better()).chain(&self.speeds);
        self.estimates.iter().all(|one| one.estimate.termination.was_successful())
            && used.all(|speeds| speeds.termination.was_successful())
            && self.suspicions.is_empty()
    }

    /// The estimate's own keys; beside each finding's numbers its sentence and advice; what it was made from.
    fn json(&self, identified: &Identified) -> Value {
        let Identified { estimate, used, held_out, expressions, verdict, figures } = identified;
        let mut json = serde_json::to_value(estimate).unwrap_or_default();
        if let Some(base) = json.get_mut("base").and_then(Value::as_array_mut) {
            for (value, expression) in base.iter_mut().zip(expressions) {
                value["expression"] = json!(expression);
            }
        }
        if let Some(findings) = json.get_mut("findings").and_then(Value::as_array_mut) {
            for (value, finding) in findings.iter_mut().zip(&estimate.findings) {
                value["text"] = json!(finding.to_string());
                value["advice"] = json!(finding.advice());
            }
        }
        if let [report] = self.log.reports.as_slice()
            && let Some(gaps) = &report.gaps
        {
            json["gaps"] = gaps.json();
        }
        json["suspicions"] = self.suspicions.iter().map(|suspicion| suspicion_json(suspicion, &self.log)).collect();
        json["joints"] = json!(self.log.joint_names());
        json["verdict"] = json!(verdict);
        json["residual"] = json!(used);
        json["held_out"] = json!(held_out);
        json["logs"] = json!(self.log.reports);
        json["inputs"] = json!(self.inputs);
        // A page also shows what the estimate was made from.
        if let (Some(figures), Some(_)) = (figures, &self.inputs) {
            json["figures"] = json!(figures);
        }
        if let Some(transmissions) = &self.transmissions {
            json["transmissions"] = json!(transmissions);
        }
        if let Some(selection) = &self.selection {
            json["selection"] = json!(selection);
        }
        if let Some(onset) = &self.onset {
            json["onset_speed"] = speeds_json(onset, &self.log.robot.robot);
        }
        if let Some(speeds) = &self.speeds {
            json["stribeck_speed"] = speeds_json(speeds, &self.log.robot.robot);
        }
        json
    }
}

impl Serialize for IdentifyAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.estimates.as_slice() {
            [one] => self.json(one).serialize(serializer),
            several => serializer.collect_seq(several.iter().map(|one| self.json(one))),
        }
    }
}

/// The keys of a suspicion, with its sentence and what to try.
fn suspicion_json(suspicion: &Suspicion, log: &ProcessedLog) -> Value {
    let mut json = json!(suspicion);
    json["text"] = json!(suspicion.mistake.to_string());
    json["advice"] = json!(advice(suspicion, log));
    json
}
