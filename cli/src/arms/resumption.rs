//! `armid run --resume`: what is left of an experiment that was cut short, and how it goes on.
//!
//! The second session repeats the approach, and the missing periods follow those that are kept. A simulated session
//! draws its noise from a run number of its own, or the periods of two sessions would be the same to the last bit.

use std::path::Path;

use armid::experiment::{Continuation, Ending, Phase, Sink};
use armid_hardware::link::StampFindings;
use armid_io::recording::{check_at_rest, part_path};
use armid_io::{Error, Log};
use miette::Result;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{Experiment, Performed, perform};
use crate::terminal::Answer;

/// One session of an experiment, as the metadata of a recording says it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Session {
    /// Its first period, from one.
    first_period: usize,
    /// Its last one.
    last_period: usize,
    /// The run number of its random numbers.
    run: u64,
}

/// What there is to continue.
pub(crate) enum Found {
    /// No recording at all.
    Nothing,
    /// One that is complete.
    Whole,
    /// One that was cut short.
    Part(Box<Part>),
}

/// A recording that was cut short.
pub(crate) struct Part {
    pub(crate) continuation: Continuation,
    sessions: Vec<Session>,
    /// Run number of the session that follows.
    run: u64,
    /// Samples that a link missed before; unknown where the recording was cut off.
    missing: Vec<usize>,
}

/// Looks for the recording that `path` was to become.
pub(crate) fn find(path: &Path, experiment: &Experiment) -> Result<Found> {
    let part = part_path(path);
    if !part.is_file() {
        return Ok(if path.is_file() { Found::Whole } else { Found::Nothing });
    }
    check_at_rest(&part)?;
    let log = Log::read(&part)?;
    let refused =
        |message: String| Error::new(message).help("nothing was changed; choose another file with -o to begin anew");
    let (Some(recording), Some(robot)) = (log.recording, log.robot) else {
        return Err(refused(format!("{} was not recorded by armid", log.name)).into());
    };
    if robot.text != *experiment.planned.robot.text.content {
        return Err(refused(format!(
            "{} is of another robot file than {}",
            log.name, experiment.planned.robot.text.name
        ))
        .into());
    }
    for (key, expected) in [("arm", experiment.arm.name().to_owned()), ("seed", experiment.planned.seed.to_string())] {
        let found = log.notes.get(key).map_or("", String::as_str);
        if found != expected {
            return Err(refused(format!("{}: {key} is \"{found}\", expected \"{expected}\"", log.name)).into());
        }
    }
    let mut sessions: Vec<Session> = match log.notes.get("sessions") {
        None => vec![Session { first_period: 1, last_period: usize::MAX, run: experiment.planned.run }],
        Some(text) => serde_json::from_str(text)
            .map_err(|error| Error::new(format!("{}: metadata \"sessions\": {error}", log.name)))?,
    };
    let stamps = log.notes.get("stamps").and_then(|text| serde_json::from_str::<StampFindings>(text).ok());
    let missing = stamps.map_or_else(Vec::new, |stamps| stamps.missing);
    let continuation = Continuation::new(&experiment.planned.plan, recording)
        .map_err(|error| refused(format!("{}: {error}", log.name)))?;
    let kept = continuation.periods();
    sessions.retain(|session| session.first_period <= kept);
    if let Some(last) = sessions.last_mut() {
        last.last_period = last.last_period.min(kept);
    }
    // High bits: far from the run numbers that people count.
    let run = if kept == 0 { experiment.planned.run } else { experiment.planned.run ^ ((kept as u64) << 32) };
    Ok(Found::Part(Box::new(Part { continuation, sessions, run, missing })))
}

/// What to say where nothing is left to do.
pub(crate) fn already_whole(path: &Path) -> Answer {
    Answer {
        text: format!("{} is complete already\n", path.display()),
        json: json!({ "recording": path, "ending": "completed", "already": true }),
    }
}

impl Part {
    /// The sessions of the joined recording, as JSON.
    pub(crate) fn sessions(&self, periods: usize) -> String {
        let mut sessions = self.sessions.clone();
        let kept = self.continuation.periods();
        if kept < periods {
            sessions.push(Session { first_period: kept + 1, last_period: periods, run: self.run });
        }
        serde_json::to_string(&sessions).unwrap_or_default()
    }

    /// Performs what is missing and hands the joined experiment to the sink.
    pub(crate) fn perform(
        &self,
        experiment: &Experiment,
        recording: Option<&Path>,
        sink: &mut dyn Sink,
    ) -> Result<Performed> {
        let Some(plan) = self.continuation.rest() else {
            self.continuation.replay_kept(sink);
            return Ok(Performed { ending: Ending::Completed, tracking: None, guard: None, stamps: None });
        };
        let mut rest = experiment.clone();
        (rest.planned.plan, rest.planned.run) = (plan, self.run);
        let mut performed = perform(rest.arm, &rest, recording, &mut self.continuation.join(sink))?;
        if let Some(stamps) = &mut performed.stamps {
            let layout = rest.planned.plan.layout().map_err(Error::new)?;
            let kept = self.continuation.periods();
            let new = stamps.missing.iter().filter(|&&k| kept == 0 || layout.phase(k) >= Phase::Record);
            let new = new.map(|k| k + kept * layout.period_samples);
            let earlier = self.missing.iter().copied().filter(|&k| k < self.continuation.samples());
            stamps.missing = earlier.chain(new).collect();
        }
        Ok(performed)
    }
}
