//! Recordings of armid's own: the plan, the robot and the provenance beside the samples.

use std::collections::BTreeMap;

use armid::experiment::{PhaseSpan, Recording};
use armid::input::size::{JOINTS, RATE_HZ};
use armid::model::{EffortInterface, format::ChainEnds};
use armid::provenance::Provenance;
use armid::trajectory::PeriodicTrajectory;
use armid_cdr::Time;

use super::conversion::Conversion;
use super::joint_log::{Log, RecordedRobot, Segment};
use super::mcap_contents::Contents;
use super::origin::Origin;
use crate::error::Error;

/// A recording that armid wrote.
pub(super) fn log(name: &str, contents: Contents) -> Result<Log, Error> {
    let Contents { metadata, ending, table, voltages, links, .. } = contents;
    let metadata = metadata.unwrap_or_default();
    let get = |key: &str| -> Result<&String, Error> {
        metadata.get(key).ok_or_else(|| Error::new(format!("{name}: metadata \"{key}\" is missing")))
    };
    let wrong = |key: &str, found: &str, expected: &str| -> Error {
        Error::new(format!("{name}: metadata \"{key}\" is \"{found}\", expected {expected}"))
    };
    let format = get("format")?;
    if format != "1" {
        return Err(wrong("format", format, "1; a newer armid wrote this recording"));
    }
    let joints: Vec<String> =
        serde_json::from_str(get("joints")?).map_err(|_| wrong("joints", &metadata["joints"], "a list of names"))?;
    let rate_hz: f64 = get("rate_hz")?.parse().map_err(|_| wrong("rate_hz", &metadata["rate_hz"], "a number"))?;
    let period_samples: usize = get("period_samples")?
        .parse()
        .map_err(|_| wrong("period_samples", &metadata["period_samples"], "a whole number"))?;
    let effort_unit = EffortInterface::ALL
        .into_iter()
        .find(|unit| Some(unit.name()) == metadata.get("effort").map(String::as_str))
        .ok_or_else(|| wrong("effort", metadata.get("effort").map_or("", String::as_str), "current or torque"))?;
    let phases: Vec<PhaseSpan> = serde_json::from_str(get("phases")?)
        .map_err(|error| Error::new(format!("{name}: metadata \"phases\": {error}")))?;
    let provenance: Provenance = serde_json::from_str(get("provenance")?)
        .map_err(|error| Error::new(format!("{name}: metadata \"provenance\": {error}")))?;
    let trajectory = PeriodicTrajectory::from_toml(get("trajectory")?)
        .map_err(|error| Error::new(format!("{name}: metadata \"trajectory\": {error}")))?;
    let dof = joints.len();
    JOINTS.check_count("number of joints", dof).map_err(|error| Error::new(format!("{name}: {error}")))?;
    RATE_HZ.check("rate_hz", rate_hz).map_err(|error| Error::new(format!("{name}: {error}")))?;
    let robot = RecordedRobot {
        text: get("robot_file")?.clone(),
        nominal: metadata.get("nominal_file").cloned(),
        chain: ChainEnds { base: metadata.get("base_link").cloned(), tip: metadata.get("tip_link").cloned() },
    };
    if let Some(fault) = table.fault {
        return Err(Error::new(format!("{name}: {fault}")));
    }
    let voltage = arrays(name, "motor voltages", dof, &table.stamps, &voltages)?;
    let link_q = arrays(name, "positions of links", dof, &table.stamps, &links)?;
    let recording = Recording {
        robot: get("robot")?.clone(),
        robot_text: robot.text.clone(),
        dof,
        rate_hz,
        joints,
        effort_unit,
        phases,
        trajectory,
        period_samples,
        t: table.stamps.iter().map(|stamp| stamp.ns() as f64 / 1e9).collect(),
        q: table.q,
        effort: table.effort,
        voltage,
        link_q,
        provenance,
    };
    recording.check().map_err(|fault| Error::new(format!("{name}: {fault}")))?;
    let notes = metadata.into_iter().chain(ending).collect();
    Ok(Log { notes, ..Log::of_recording(name, recording, Some(robot)) })
}

impl Log {
    /// The log of an experiment that was recorded in this program; `robot` holds the texts of its files, where they are to go
    /// with it.
    pub fn of_recording(name: &str, recording: Recording, robot: Option<RecordedRobot>) -> Self {
        Self {
            name: name.to_owned(),
            joints: Some(recording.joints.clone()),
            dof: recording.dof,
            rate_hz: recording.rate_hz,
            effort_unit: Some(recording.effort_unit),
            segments: vec![Segment { start_s: 0.0, samples: recording.t.len() }],
            q: recording.q.clone(),
            qd: None,
            link_q: None,
            effort: recording.effort.clone(),
            excluded: Vec::new(),
            robot,
            recording: Some(recording),
            servo: None,
            notes: BTreeMap::new(),
            complete: true,
            conversion: Conversion::default(),
            origin: Origin::default(),
        }
    }
}

/// The values of every sample, or none. Each stands right behind its joint state, so that a cut may have taken the
/// last one: the sample counts all the same, and its values are those of the sample before.
fn arrays(name: &str, what: &str, dof: usize, stamps: &[Time], found: &[(u64, Vec<f64>)]) -> Result<Vec<f64>, Error> {
    if found.is_empty() {
        return Ok(Vec::new());
    }
    let mut all = Vec::with_capacity(stamps.len() * dof);
    let mut rest = found.iter().peekable();
    for (k, stamp) in stamps.iter().enumerate() {
        match rest.next_if(|(time, _)| i128::from(*time) == i128::from(stamp.ns())) {
            Some((_, values)) if values.len() == dof => all.extend_from_slice(values),
            None if k > 0 && k + 1 == stamps.len() => all.extend_from_within(all.len() - dof..),
            found => {
                let found = found.map_or(0, |(_, values)| values.len());
                let message = format!("{name}: sample {k} has {found} {what}, expected {dof}");
                return Err(Error::new(message));
            }
        }
    }
    Ok(all)
}
