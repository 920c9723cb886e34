//! Recordings as MCAP: joint states that any ROS 2 tool opens, and all that is needed to read them again.
//!
//! | where | what |
//! |---|---|
//! | `/joint_states` | `sensor_msgs/msg/JointState` in CDR: position rad (m), effort A or N·m (N), every sample |
//! | `/motor_voltage` | `std_msgs/msg/Float64MultiArray` in CDR: V, in the order of the joints, every sample; only where recorded |
//! | `/link_positions` | the same: rad (m) by encoders behind the transmissions, every sample; only where there are some |
//! | `/joint_commands` | the commanded position, at most 100 times a second |
//! | `/robot_description`, `/tf` | the arm as URDF and the poses of its links, where a robot is shown |
//! | metadata `armid` | robot and its file, joints, rate, unit of effort, trajectory, phases, provenance, experiment |
//! | in it, `sessions` | where the experiment was cut short and continued: the periods of each session |
//! | metadata `armid/ending` | how the experiment ended, what guard and link saw; absent where the file was cut off |
//!
//! Times count from the beginning of the experiment, so equal experiments give equal bytes.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use armid::experiment::{Ending, Flow, RawSample, Recording, Sink};
use armid::model::{EffortInterface, Robot};
use armid_cdr::{FloatArray, JointState, Time};
use mcap::records::{MessageHeader, Metadata};

use super::arm_view::{ArmView, Fault};
use super::part::{create, create_draft};
use super::{FileSink, part_path};
use crate::error::Error;
use crate::output::{make_folder, name_file};

/// Topic of the measured states.
pub(crate) const STATES: &str = "/joint_states";
/// Topic of the motors' terminal voltages.
pub(crate) const VOLTAGE: &str = "/motor_voltage";
/// Topic of the positions behind the transmissions.
pub(crate) const LINKS: &str = "/link_positions";
/// Topic of the commands.
const COMMANDS: &str = "/joint_commands";
/// Name of the metadata record.
pub(crate) const METADATA: &str = "armid";
/// Name of the metadata record at the end.
pub(crate) const ENDING: &str = "armid/ending";
/// How often a command is stored, at most, Hz.
const COMMAND_RATE_HZ: f64 = 100.0;
/// Seconds of the experiment in one chunk: what a crash loses at most.
const CHUNK_S: f64 = 1.0;

/// Streams an experiment into `R.mcap.part`.
pub struct McapSink<'a> {
    path: PathBuf,
    part: PathBuf,
    /// What the file is called until the samples that it must not lose are in it, and how many those are.
    draft: Option<(PathBuf, usize)>,
    robot: Option<&'a Robot>,
    notes: BTreeMap<String, String>,
    open: Option<Open>,
    fault: Option<Error>,
    on_sample: Box<dyn FnMut(usize) + Send + 'a>,
    asked_to_stop: fn() -> bool,
}

struct Open {
    writer: mcap::Writer<BufWriter<File>>,
    /// A handle of the file: to synchronise it, and to keep others from it.
    file: File,
    states: u16,
    /// Made with the first sample that has voltages.
    voltage: Option<u16>,
    /// Made with the first sample that has positions of the links.
    links: Option<u16>,
    commands: u16,
    view: Option<ArmView>,
    joints: Arc<[String]>,
    command_every: usize,
    chunk_samples: usize,
    samples: usize,
}

impl<'a> McapSink<'a> {
    /// A sink that writes beside `path`. `notes` go into the metadata as they are; `on_sample` gets the number
    /// of samples so far.
    pub fn new(path: &Path, notes: BTreeMap<String, String>, on_sample: impl FnMut(usize) + Send + 'a) -> Self {
        Self {
            path: path.to_path_buf(),
            part: part_path(path),
            draft: None,
            robot: None,
            notes,
            open: None,
            fault: None,
            on_sample: Box::new(on_sample),
            asked_to_stop: || false,
        }
    }

    /// Returns this sink, which stops the experiment when `asked` says so.
    #[must_use]
    pub fn stopping_when(self, asked: fn() -> bool) -> Self {
        Self { asked_to_stop: asked, ..self }
    }

    /// Returns this sink; its recording also shows the robot in viewers.
    #[must_use]
    pub fn with_robot(self, robot: &'a Robot) -> Self {
        Self { robot: Some(robot), ..self }
    }

    /// Returns this sink for an experiment that is resumed: what was recorded before stays `R.mcap.part` until its first
    /// `kept` samples are in the new file, which then takes that name.
    #[must_use]
    pub fn resuming(mut self, kept: usize) -> Self {
        let mut draft = self.part.as_os_str().to_owned();
        draft.push(".new");
        self.draft = Some((draft.into(), kept));
        self
    }

    /// Gives the draft its name, once what it must not lose is in it.
    fn settle_draft(&mut self, at_the_end: bool) -> Result<(), Error> {
        let samples = self.open.as_ref().map_or(0, |open| open.samples);
        let Some((draft, _)) = self.draft.take_if(|(_, kept)| at_the_end || samples >= *kept) else { return Ok(()) };
        let Some(open) = &mut self.open else { return Ok(()) };
        open.writer.flush().map_err(|error| cannot_write(&draft, &error))?;
        name_file(&open.file, &draft, &self.part).map_err(|error| cannot_write(&self.part, &error))
    }

    fn complete(&mut self, ending: &Ending, remarks: BTreeMap<String, String>) -> Result<PathBuf, Error> {
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        if self.draft.is_some() && self.open.is_some() {
            self.settle_draft(true)?;
        }
        let Some(mut open) = self.open.take() else {
            return Err(Error::new("the arm never began a recording"));
        };
        let (word, detail) = match ending {
            Ending::Completed => ("completed", String::new()),
            Ending::Stopped { t, phase, rest } => ("stopped", format!("at t = {t} s ({}): {rest}", phase.name())),
            Ending::Diverged { t, phase, reason } => ("diverged", format!("at t = {t} s ({}): {reason}", phase.name())),
            Ending::Tripped { t, phase, trip } => ("tripped", format!("at t = {t} s ({}): {trip}", phase.name())),
        };
        let record = [("ending", word.to_owned()), ("detail", detail), ("samples", open.samples.to_string())];
        let metadata = record.into_iter().map(|(key, value)| (key.to_owned(), value)).chain(remarks).collect();
        open.writer
            .write_metadata(&Metadata { name: ENDING.to_owned(), metadata })
            .and_then(|()| open.writer.finish())
            .map_err(|error| cannot_write(&self.part, &error))?;
        if ending.is_complete() {
            name_file(&open.file, &self.part, &self.path).map_err(|error| cannot_write(&self.path, &error))?;
            Ok(self.path.clone())
        } else {
            open.file.sync_all().map_err(|error| cannot_write(&self.part, &error))?;
            Ok(self.part.clone())
        }
    }

    fn create(&self, recording: &Recording) -> Result<Open, Error> {
        if let Some(folder) = self.part.parent() {
            make_folder(folder).map_err(|error| cannot_write(folder, &error))?;
        }
        let file = match &self.draft {
            None => create(&self.part)?,
            Some((draft, _)) => create_draft(draft)?,
        };
        let same = file.try_clone().map_err(|error| cannot_write(&self.part, &error))?;
        let start = || -> Result<Open, Fault> {
            let mut writer = options().create(BufWriter::new(file))?;
            writer.write_metadata(&Metadata { name: METADATA.to_owned(), metadata: self.metadata(recording) })?;
            let schema = writer.add_schema(JointState::NAME, "ros2msg", JointState::DEFINITION.as_bytes())?;
            let states = writer.add_channel(schema, STATES, "cdr", &BTreeMap::new())?;
            let commands = writer.add_channel(schema, COMMANDS, "cdr", &BTreeMap::new())?;
            let view = self.robot.map(|robot| ArmView::begin(&mut writer, robot, recording.rate_hz)).transpose()?;
            writer.flush()?;
            Ok(Open {
                writer,
                file: same,
                states,
                voltage: None,
                links: None,
                commands,
                view,
                joints: recording.joints.as_slice().into(),
                command_every: (recording.rate_hz / COMMAND_RATE_HZ).ceil().max(1.0) as usize,
                chunk_samples: (recording.rate_hz * CHUNK_S).ceil().max(1.0) as usize,
                samples: 0,
            })
        };
        start().map_err(|error| cannot_write(&self.part, &error))
    }

    fn metadata(&self, recording: &Recording) -> BTreeMap<String, String> {
        let json = |value: serde_json::Result<String>| value.unwrap_or_default();
        [
            ("format", "1".to_owned()),
            ("robot", recording.robot.clone()),
            ("robot_file", recording.robot_text.clone()),
            ("joints", json(serde_json::to_string(&recording.joints))),
            ("rate_hz", recording.rate_hz.to_string()),
            ("effort", recording.effort_unit.name().to_owned()),
            ("effort_unit", effort_unit(recording).to_owned()),
            ("trajectory", recording.trajectory.to_toml()),
            ("period_samples", recording.period_samples.to_string()),
            ("phases", json(serde_json::to_string(&recording.phases))),
            ("provenance", json(serde_json::to_string(&recording.provenance))),
        ]
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .chain(self.notes.clone())
        .collect()
    }
}

/// How armid writes MCAP.
pub(super) fn options() -> mcap::WriteOptions {
    mcap::WriteOptions::new().profile("ros2").library(concat!("armid ", env!("CARGO_PKG_VERSION"))).compression(None)
}

const fn effort_unit(recording: &Recording) -> &'static str {
    match recording.effort_unit {
        EffortInterface::Current => "A",
        EffortInterface::Torque => "N·m (N for a prismatic joint)",
    }
}

fn cannot_write(path: &Path, error: &impl std::fmt::Display) -> Error {
    Error::new(format!("{} cannot be written: {error}", path.display()))
}

impl FileSink for McapSink<'_> {
    fn finish(mut self: Box<Self>, ending: &Ending, remarks: BTreeMap<String, String>) -> Result<PathBuf, Error> {
        self.complete(ending, remarks)
    }
}

impl Sink for McapSink<'_> {
    fn begin(&mut self, recording: &Recording) {
        match self.create(recording) {
            Ok(open) => self.open = Some(open),
            Err(fault) => self.fault = Some(fault),
        }
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        let Some(open) = &mut self.open else { return Flow::Stop };
        if let Err(error) = open.write(sample) {
            self.fault = Some(cannot_write(&self.part, &error));
            return Flow::Stop;
        }
        (self.on_sample)(open.samples);
        if self.draft.is_some()
            && let Err(fault) = self.settle_draft(false)
        {
            self.fault = Some(fault);
            return Flow::Stop;
        }
        if (self.asked_to_stop)() { Flow::Stop } else { Flow::Continue }
    }

    fn idle(&mut self, _: f64) -> Flow {
        if (self.asked_to_stop)() { Flow::Stop } else { Flow::Continue }
    }
}

impl Open {
    fn write(&mut self, sample: &RawSample<'_>) -> Result<(), Box<dyn std::error::Error>> {
        let stamp = Time::from_s(sample.t)?;
        let stamp_ns = stamp.ns().cast_unsigned();
        let state = JointState {
            stamp,
            frame_id: String::new(),
            name: Arc::clone(&self.joints),
            position: sample.q.to_vec(),
            velocity: Vec::new(),
            effort: sample.effort.to_vec(),
        };
        self.message(self.states, sample.index, stamp_ns, &state.encode()?)?;
        for (topic, values) in [(VOLTAGE, sample.voltage), (LINKS, sample.link_q)] {
            if !values.is_empty() {
                let channel = self.array_channel(topic)?;
                self.message(channel, sample.index, stamp_ns, &FloatArray { data: values.to_vec() }.encode()?)?;
            }
        }
        if sample.index.is_multiple_of(self.command_every) {
            let command = JointState { position: sample.command.to_vec(), effort: Vec::new(), ..state };
            self.message(self.commands, sample.index / self.command_every, stamp_ns, &command.encode()?)?;
        }
        if let Some(view) = &self.view {
            view.show(&mut self.writer, sample.index, stamp, sample.q)?;
        }
        self.samples += 1;
        if self.samples.is_multiple_of(self.chunk_samples) {
            self.writer.flush()?;
        }
        Ok(())
    }

    /// The channel of a topic of arrays, made where it is not there yet.
    fn array_channel(&mut self, topic: &str) -> mcap::McapResult<u16> {
        let known = if topic == VOLTAGE { &mut self.voltage } else { &mut self.links };
        if let Some(channel) = *known {
            return Ok(channel);
        }
        let schema = self.writer.add_schema(FloatArray::NAME, "ros2msg", FloatArray::DEFINITION.as_bytes())?;
        let channel = self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
        *known = Some(channel);
        Ok(channel)
    }

    fn message(&mut self, channel_id: u16, index: usize, time_ns: u64, bytes: &[u8]) -> mcap::McapResult<()> {
        let header = MessageHeader { channel_id, sequence: index as u32, log_time: time_ns, publish_time: time_ns };
        self.writer.write_to_known_channel(&header, bytes)
    }
}
