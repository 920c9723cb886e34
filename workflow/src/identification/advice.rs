//! What to try about a mistake that a log seems to have been made with.

use armid::diagnosis::Suspicion;
use armid::remedy::{Remedy, Setting};
use armid_io::ProcessedLog;

/// What to try about a suspicion: where all logs were read alike, with the mapping that does it.
pub fn advice(suspicion: &Suspicion, log: &ProcessedLog) -> Remedy {
    let correction = suspicion.mistake.correction();
    let robot = &log.robot.robot;
    let mut mappings = log.reports.iter().map(|report| report.origin.corrected(&suspicion.mistake, robot));
    match mappings.next() {
        Some(first) if !first.is_empty() && mappings.all(|other| other == first) => {
            let typed = first.into_iter().enumerate();
            typed.fold(correction, |so_far, (k, mapping)| {
                so_far.say(if k == 0 { ", so: " } else { " or: " }).assign(Setting::Map, mapping)
            })
        }
        Some(_) | None => correction,
    }
}
