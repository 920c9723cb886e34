//! Folders of LeRobot: `meta/info.json` beside `data/chunk-*/*.parquet`, whose rows are frames of one or more episodes.
//!
//! ```text
//! t = frame_index / fps        observation.state → observation.state_0, observation.state_1, …
//! ```
//! Every episode begins at zero again and becomes a segment of its own. The format has no torque and no units: a mapping says what a
//! feature holds.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use armid::input::size::RECORDING_BYTES;
use armid::provenance::{sha256, sha256_of_bytes};
use serde::Deserialize;
use serde_json::Value;

use super::parquet_table::{ParquetColumn, columns, columns_of};
use crate::error::Error;
use crate::table::{ColumnTable, LogTable};
use crate::text::{Text, read_bytes};

/// What says that a folder is one.
pub(super) const INFO: &str = "meta/info.json";
/// The column of times that is made of the frames.
const TIME: &str = "t";

const LACKING: &str = "a data set of LeRobot holds positions and commands, without torque and units: record currents or torques of the \
                       motors as a feature, and name both in a map: \"q=observation.state deg, current=observation.current mA\"; or \
                       state the gains of the servos: \"q=observation.state deg, q_cmd=action deg kp=… kd=…\"";

/// What is read of `meta/info.json`.
#[derive(Deserialize)]
struct Info {
    fps: f64,
    #[serde(default)]
    features: BTreeMap<String, Feature>,
}

#[derive(Deserialize)]
struct Feature {
    #[serde(default)]
    names: Value,
}

/// Whether a folder is a data set of LeRobot.
pub(super) fn is_data_set(path: &Path) -> bool {
    path.join(INFO).is_file()
}

/// The frames of all episodes, one after the other.
///
/// # Errors
/// [`Error`] where the folder is not whole, or its files are of unlike columns.
pub(super) fn table(folder: &Path) -> Result<LogTable, Error> {
    let name = folder.display().to_string();
    let text = Text::read(&folder.join(INFO))?;
    let info: Info = serde_json::from_str(&text.content).map_err(|error| Error::of_json(&text, &error))?;
    if !(info.fps.is_finite() && info.fps > 0.0) {
        return Err(Error::new(format!("{}: fps is {}, expected a number above zero", text.name, info.fps)));
    }
    let mut files = Vec::new();
    find_files(&folder.join("data"), &mut files)?;
    files.sort();
    let (mut all, mut hashes): (Vec<ParquetColumn>, String) = (Vec::new(), String::new());
    for path in &files {
        let bytes = read_bytes(path, &RECORDING_BYTES)?;
        hashes += &sha256_of_bytes(&bytes);
        let found = columns(&path.display().to_string(), bytes)?;
        if all.is_empty() {
            all = found;
        } else {
            append(&mut all, found).map_err(|fault| Error::mismatch(format!("{}: {fault}", path.display())))?;
        }
    }
    if all.is_empty() {
        return Err(Error::new(format!(
            "{name} holds {INFO} and no data/*/*.parquet, expected the frames of episodes"
        )));
    }
    let mut table = ColumnTable::new(&name, sha256(&hashes));
    let frames = all.iter().find(|column| column.name == "frame_index" && column.width == 0);
    if let Some(Ok(frames)) = frames.map(|column| &column.values) {
        table.add(TIME, frames.iter().map(|frame| frame / info.fps).collect(), None);
        table.time = Some(TIME);
        table.remarks.push(format!("times are frame_index / fps, {} frames per second", info.fps));
    }
    for (feature, Feature { names }) in &info.features {
        let names = words(names);
        if names.len() > 1 && all.iter().any(|column| column.name == *feature && column.width == names.len()) {
            table.remarks.push(format!("{feature}_0 to {feature}_{} are {}", names.len() - 1, names.join(", ")));
        }
    }
    table.lacking = Some(LACKING);
    Ok(LogTable::Columns(columns_of(table, all)))
}

/// Parquet files in a folder and those below it.
fn find_files(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Error> {
    let entries = fs::read_dir(folder).map_err(|error| Error::unreadable(folder, &error))?;
    for entry in entries {
        let entry = entry.map_err(|error| Error::unreadable(folder, &error))?;
        let (path, kind) = (entry.path(), entry.file_type());
        if kind.is_ok_and(|kind| kind.is_dir()) {
            find_files(&path, files)?;
        } else if path.extension().is_some_and(|ending| ending == "parquet") {
            files.push(path);
        }
    }
    Ok(())
}

/// Adds the rows of another file.
fn append(all: &mut [ParquetColumn], more: Vec<ParquetColumn>) -> Result<(), String> {
    for (column, more) in all.iter_mut().zip(&more) {
        if (&column.name, column.width) != (&more.name, more.width) {
            let (found, expected) = (&more.name, &column.name);
            return Err(format!(
                "found the column {found} of {} values, expected {expected} of {}",
                more.width, column.width
            ));
        }
        match (&mut column.values, &more.values) {
            (Ok(values), Ok(more)) => values.extend(more),
            (_, Err(what)) => column.values = Err(what.clone()),
            (Err(_), Ok(_)) => {}
        }
    }
    if all.len() == more.len() { Ok(()) } else { Err(format!("found {} columns, expected {}", more.len(), all.len())) }
}

/// The texts of a list, or of the lists by motor that older data sets have.
fn words(names: &Value) -> Vec<&str> {
    match names {
        Value::String(word) => vec![word],
        Value::Array(list) => list.iter().flat_map(words).collect(),
        Value::Object(lists) => lists.values().flat_map(words).collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) => Vec::new(),
    }
}
