//! What identification reads: a log of positions and efforts, from whatever recorded it.

use std::collections::BTreeMap;
use std::path::Path;

use armid::experiment::Recording;
use armid::model::EffortInterface;
use miette::Result;

use super::{recording_csv, recording_reader};
use crate::fault::Fault;
use crate::robot_source::ChainArguments;

/// Positions and efforts of some joints at a constant rate.
#[derive(Clone, Debug)]
pub(crate) struct Log {
    /// The file.
    pub(crate) name: String,
    /// Names of the joints, where the file has them.
    pub(crate) joints: Option<Vec<String>>,
    /// Number of joints n.
    pub(crate) dof: usize,
    /// Samples per second, Hz.
    pub(crate) rate_hz: f64,
    /// What the efforts are; `None` where the file does not say and the robot decides.
    pub(crate) effort_unit: Option<EffortInterface>,
    /// Joint coordinates, rad (m); N × n.
    pub(crate) q: Vec<f64>,
    /// Efforts, A or N·m (N); N × n.
    pub(crate) effort: Vec<f64>,
    /// The robot that was recorded, where the file holds it.
    pub(crate) robot: Option<RecordedRobot>,
    /// The experiment, where armid performed it.
    pub(crate) recording: Option<Recording>,
    /// What else an armid recording says of itself, as texts.
    pub(crate) notes: BTreeMap<String, String>,
    /// Whether the file is whole.
    pub(crate) complete: bool,
}

/// The robot as a recording holds it: texts.
#[derive(Clone, Debug, Default)]
pub(crate) struct RecordedRobot {
    /// Its file.
    pub(crate) text: String,
    /// What an experimenter would guess, where there was such a file.
    pub(crate) nominal: Option<String>,
    /// The chain that was chosen in a tree.
    pub(crate) chain: ChainArguments,
}

/// Reads a log: MCAP by its first bytes, CSV otherwise.
pub(crate) fn read(path: &Path) -> Result<Log> {
    let bytes =
        std::fs::read(path).map_err(|error| Fault::new(format!("{} cannot be read: {error}", path.display())))?;
    if bytes.starts_with(mcap::MAGIC) {
        return recording_reader::read(path, &bytes);
    }
    let mcap_by_name = path.extension().is_some_and(|extension| extension == "mcap");
    if mcap_by_name {
        let message = format!("{} does not begin as an MCAP file does", path.display());
        return Err(Fault::new(message).help("expected the bytes 89 4D 43 41 50 30 0D 0A").into());
    }
    recording_csv::read(crate::atomic_file::read_text(path)?)
}
