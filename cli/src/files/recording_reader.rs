//! MCAP files back to values: armid's own, and those of other tools that hold joint states.

use std::collections::BTreeMap;
use std::path::Path;

use armid::excitation::PeriodicTrajectory;
use armid::experiment::{PhaseSpan, Recording};
use armid::model::EffortInterface;
use armid::provenance::Provenance;
use mcap::McapError;
use mcap::records::Record;
use miette::Result;

use super::float_array;
use super::joint_state::{JointState, NAME};
use super::log::{Log, RecordedRobot};
use super::mcap_records::Records;
use super::recording_mcap::{ENDING, METADATA, STATES, VOLTAGE};
use crate::fault::Fault;
use crate::robot_source::ChainArguments;

/// What a file holds.
#[derive(Default)]
struct Contents {
    metadata: Option<BTreeMap<String, String>>,
    /// What was noted at the end; empty where the file is cut off.
    ending: BTreeMap<String, String>,
    states: Vec<JointState>,
    /// Time, ns, and motor voltages.
    voltages: Vec<(u64, Vec<f64>)>,
    whole: bool,
}

/// Reads the joint states of a file. One that was cut off is read to its last chunk where its name ends in `.part`.
pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Log> {
    let name = path.display().to_string();
    let contents = contents(&name, bytes)?;
    if !contents.whole && path.extension().is_none_or(|extension| extension != "part") {
        let last = contents.states.last().map_or(0.0, |state| state.stamp_ns as f64 / 1e9);
        let message = format!(
            "{name} is cut off: it ends after {} samples, at t = {last:.3} s, without the footer of an MCAP file",
            contents.states.len()
        );
        let help = "its whole chunks can be used as they are under a name that ends in .mcap.part";
        return Err(Fault::new(message).help(help).into());
    }
    if contents.states.is_empty() {
        let message = format!("{name} holds no message of type {NAME} on {STATES}, expected one per sample");
        return Err(Fault::new(message).into());
    }
    let whole = contents.whole;
    let mut log = match &contents.metadata {
        Some(metadata) => own(&name, metadata, &contents)?,
        None => foreign(&name, &contents.states)?,
    };
    log.complete = whole;
    Ok(log)
}

fn contents(name: &str, bytes: &[u8]) -> Result<Contents> {
    let fault = |error: &McapError| -> miette::Report {
        let shown = Fault::new(format!("{name} cannot be read as MCAP: {error}"));
        match error {
            McapError::UnsupportedCompression(_) => {
                shown.help("expected chunks without compression, or compressed by lz4 or zstd").into()
            }
            _ => shown.into(),
        }
    };
    let mut contents = Contents::default();
    let (mut channel, mut voltage) = (None, None);
    let (mut schema, mut arrays) = (None, None);
    // A chunk's checksum is checked at its end: where that fails it says more than the message that was damaged.
    let mut undecodable: Option<Fault> = None;
    for record in Records::new(bytes, true).map_err(|error| fault(&error))? {
        match record {
            Ok(Record::Schema { header, .. }) if header.name == NAME => schema = Some(header.id),
            Ok(Record::Schema { header, .. }) if header.name == float_array::NAME => arrays = Some(header.id),
            Ok(Record::Channel(found)) if found.topic == VOLTAGE && Some(found.schema_id) == arrays => {
                voltage = Some(found.id);
            }
            Ok(Record::Channel(found)) if found.topic == STATES => {
                if Some(found.schema_id) != schema || found.message_encoding != "cdr" {
                    let message = format!("{name}: {STATES} is no {NAME} in CDR, as a recording of ROS 2 is");
                    return Err(Fault::new(message).into());
                }
                channel = Some(found.id);
            }
            Ok(Record::Message { header, data }) if Some(header.channel_id) == channel => {
                let number = contents.states.len() + 1;
                match JointState::decode(&data) {
                    Ok(state) => contents.states.push(state),
                    Err(error) => {
                        let message = format!("{name}: message {number} on {STATES}: {error}");
                        undecodable.get_or_insert_with(|| Fault::new(message));
                    }
                }
            }
            Ok(Record::Message { header, data }) if Some(header.channel_id) == voltage => {
                let number = contents.voltages.len() + 1;
                match float_array::decode(&data) {
                    Ok(values) => contents.voltages.push((header.log_time, values)),
                    Err(error) => {
                        let message = format!("{name}: message {number} on {VOLTAGE}: {error}");
                        undecodable.get_or_insert_with(|| Fault::new(message));
                    }
                }
            }
            Ok(Record::Metadata(found)) if found.name == METADATA => contents.metadata = Some(found.metadata),
            Ok(Record::Metadata(found)) if found.name == ENDING => contents.ending = found.metadata,
            Ok(Record::Footer(_)) => contents.whole = true,
            Ok(_) => {}
            Err(McapError::UnexpectedEof | McapError::UnexpectedEoc) => break,
            Err(error) => return Err(fault(&error)),
        }
    }
    undecodable.map_or(Ok(contents), |fault| Err(fault.into()))
}

/// A recording that armid wrote.
fn own(name: &str, metadata: &BTreeMap<String, String>, contents: &Contents) -> Result<Log> {
    let states = contents.states.as_slice();
    let get = |key: &str| -> Result<&String> {
        metadata.get(key).ok_or_else(|| Fault::new(format!("{name}: metadata \"{key}\" is missing")).into())
    };
    let wrong = |key: &str, found: &str, expected: &str| -> miette::Report {
        Fault::new(format!("{name}: metadata \"{key}\" is \"{found}\", expected {expected}")).into()
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
        .map_err(|error| Fault::new(format!("{name}: metadata \"phases\": {error}")))?;
    let provenance: Provenance = serde_json::from_str(get("provenance")?)
        .map_err(|error| Fault::new(format!("{name}: metadata \"provenance\": {error}")))?;
    let trajectory = PeriodicTrajectory::from_toml(get("trajectory")?)
        .map_err(|error| Fault::new(format!("{name}: metadata \"trajectory\": {error}")))?;
    let dof = joints.len();
    let robot = RecordedRobot {
        text: get("robot_file")?.clone(),
        nominal: metadata.get("nominal_file").cloned(),
        chain: ChainArguments {
            base_link: metadata.get("base_link").cloned(),
            tip_link: metadata.get("tip_link").cloned(),
        },
    };
    let (q, effort) = columns(name, &joints, states)?;
    let voltage = voltages(name, dof, contents)?;
    let recording = Recording {
        robot: get("robot")?.clone(),
        robot_text: robot.text.clone(),
        dof,
        rate_hz,
        joints: joints.clone(),
        effort_unit,
        phases,
        trajectory,
        period_samples,
        t: states.iter().map(|state| state.stamp_ns as f64 / 1e9).collect(),
        q: q.clone(),
        effort: effort.clone(),
        voltage,
        provenance,
    };
    Ok(Log {
        name: name.to_owned(),
        joints: Some(joints),
        dof,
        rate_hz,
        effort_unit: Some(effort_unit),
        q,
        effort,
        robot: Some(robot),
        recording: Some(recording),
        notes: metadata.iter().chain(&contents.ending).map(|(key, value)| (key.clone(), value.clone())).collect(),
        complete: true,
    })
}

/// The voltages of every sample, or none. Each stands right behind its joint state, so that a cut may have taken the
/// last one: the sample counts all the same, and its voltages are those of the sample before.
fn voltages(name: &str, dof: usize, contents: &Contents) -> Result<Vec<f64>> {
    if contents.voltages.is_empty() {
        return Ok(Vec::new());
    }
    let mut all = Vec::with_capacity(contents.states.len() * dof);
    let mut rest = contents.voltages.iter().peekable();
    for (k, state) in contents.states.iter().enumerate() {
        match rest.next_if(|(time, _)| *time == state.stamp_ns) {
            Some((_, values)) if values.len() == dof => all.extend_from_slice(values),
            None if k > 0 && k + 1 == contents.states.len() => all.extend_from_within(all.len() - dof..),
            found => {
                let found = found.map_or(0, |(_, values)| values.len());
                let message = format!("{name}: sample {k} has {found} motor voltages, expected {dof}");
                return Err(Fault::new(message).into());
            }
        }
    }
    Ok(all)
}

/// Joint states that something else recorded: the rate comes from their stamps.
fn foreign(name: &str, states: &[JointState]) -> Result<Log> {
    let joints = states[0].name.clone();
    let (q, effort) = columns(name, &joints, states)?;
    let n = states.len();
    if n < 2 {
        return Err(Fault::new(format!("{name} has {n} sample, expected at least 2")).into());
    }
    let (first, last) = (states[0].stamp_ns, states[n - 1].stamp_ns);
    if last <= first {
        return Err(Fault::new(format!("{name}: time goes from {first} to {last} ns, expected it to rise")).into());
    }
    let rate = (n - 1) as f64 / ((last - first) as f64 * 1e-9);
    let whole = rate.round();
    // The stamps of a real robot jitter: a rate within a thousandth of a whole number of Hz is meant to be that.
    let rate_hz = if whole > 0.0 && (rate / whole - 1.0).abs() < 1e-3 { whole } else { rate };
    Ok(Log {
        name: name.to_owned(),
        dof: joints.len(),
        joints: Some(joints),
        rate_hz,
        effort_unit: None,
        q,
        effort,
        robot: None,
        recording: None,
        notes: BTreeMap::new(),
        complete: true,
    })
}

/// Positions and efforts in the order of `joints`, whatever the order in each message.
fn columns(name: &str, joints: &[String], states: &[JointState]) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut q = Vec::with_capacity(states.len() * joints.len());
    let mut effort = Vec::with_capacity(states.len() * joints.len());
    for (k, state) in states.iter().enumerate() {
        let complete = state.position.len() == state.name.len() && state.effort.len() == state.name.len();
        for joint in joints {
            let at = state.name.iter().position(|found| found == joint);
            let (Some(at), true) = (at, complete) else {
                let message = format!(
                    "{name}: message {}: {} names, {} positions and {} efforts, expected one of each for joint \"{joint}\"",
                    k + 1,
                    state.name.len(),
                    state.position.len(),
                    state.effort.len()
                );
                return Err(Fault::new(message).into());
            };
            q.push(state.position[at]);
            effort.push(state.effort[at]);
        }
    }
    Ok((q, effort))
}
