//! Logs of any kind by their paths.

use std::path::{Path, PathBuf};

use armid::model::Robot;
use armid::remedy::{Remedy, Setting};

use super::joint_log::Log;
use super::log_file::LogFile;
use super::log_format::{self, LogFormat};
use super::mapping::Mapping;
use super::topics::StateReading;
use super::{foreign_csv, lerobot, side_by_side};
use crate::error::Error;
use crate::text::Text;

/// Logs, and what their `[log]` tables said beside them.
#[derive(Clone, Debug, Default)]
pub struct FoundLogs {
    /// The logs, in the order in which they were named.
    pub logs: Vec<Log>,
    /// The robot that a table names.
    pub robot: Option<String>,
    /// Period of the motion that a table states, s.
    pub period_s: Option<f64>,
    /// Where the logs begin and end to count by a table, s.
    pub part_s: (Option<f64>, Option<f64>),
}

/// Reads logs: MCAP files, tables, and TOML files with a `[log]` table. Tables are logs of their own, or stand side by side where
/// the mapping names files. Beside other logs, a `[log]` table that states columns keeps them whatever the mapping is. The rate is that of tables; the mapping is of tables or of joint states of other tools, in which the
/// joints of `robot` are looked for. A recording of armid's own has neither. `is_one_of_several` says that the mapping is that of other logs too.
///
/// # Errors
/// [`Error`] where a file cannot be read, is no log, or is not as the mapping says.
pub fn find(
    paths: &[PathBuf],
    mapping: Option<&str>,
    rate_hz: Option<f64>,
    robot: Option<&Robot>,
    is_one_of_several: bool,
) -> Result<FoundLogs, Error> {
    let parsed = mapping.map(Mapping::parse).transpose()?;
    let mut found = FoundLogs::default();
    let is_toml = |path: &Path| path.extension().is_some_and(|extension| extension == "toml");
    if let Some(parsed) =
        parsed.as_ref().filter(|parsed| parsed.names_files() && paths.iter().all(|path| is_table(path)))
    {
        for (own, files) in side_by_side::logs(parsed, paths)? {
            let tables = files.iter().map(|path| log_format::table(path)).collect::<Result<_, _>>()?;
            let log = foreign_csv::of_tables(tables, Some(&own), rate_hz);
            let mut log = log.map_err(|error| error.more_help(side_by_side::several(parsed, paths)))?;
            log.origin.mapping = mapping.map(str::to_owned);
            found.logs.push(log);
        }
        return Ok(found);
    }
    for path in paths {
        if is_toml(path) {
            let file = LogFile::parse(&Text::read(path)?, path.parent().unwrap_or(Path::new("")))?;
            let tables = file.files.iter().map(|file| log_format::table(file)).collect::<Result<_, _>>()?;
            // Beside other logs a table keeps what it says: the mapping is theirs.
            let is_theirs = file.mapping.is_some() && paths.iter().any(|path| !is_toml(path));
            let (parsed, mapping) = if is_theirs { (None, None) } else { (parsed.as_ref(), mapping) };
            let mut log = foreign_csv::of_tables(tables, parsed.or(file.mapping.as_ref()), rate_hz.or(file.rate_hz))?;
            log.origin.mapping = mapping.map(str::to_owned).or(file.mapping_text);
            found.robot = found.robot.or(file.robot);
            found.period_s = found.period_s.or(file.period_s);
            found.part_s = (found.part_s.0.or(file.from_s), found.part_s.1.or(file.until_s));
            found.logs.push(log);
        } else if is_table(path) && (parsed.is_some() || rate_hz.is_some()) {
            let log = foreign_csv::of_tables(vec![log_format::table(path)?], parsed.as_ref(), rate_hz);
            let mut log = log.map_err(|error| match &parsed {
                Some(parsed) if is_one_of_several || paths.len() > 1 => {
                    error.more_help(Some(side_by_side::another(parsed, path).into()))
                }
                _ => error,
            })?;
            log.origin.mapping = mapping.map(str::to_owned);
            found.logs.push(log);
        } else {
            let mut log = Log::read_as(path, &StateReading { mapping: parsed.as_ref(), robot })?;
            if let (Some(rate), None, false) = (rate_hz, &log.recording, is_table(path)) {
                let message = format!("{} has the stamps of its messages, found a rate of {rate} Hz", log.name);
                let help = Remedy::default().setting(Setting::Rate);
                return Err(
                    Error::mismatch(message).help(help.say(" is of tables without a column of times: leave it out"))
                );
            }
            log.origin.mapping = mapping.filter(|_| log.recording.is_none()).map(str::to_owned);
            found.logs.push(log);
        }
    }
    if found.logs.is_empty() {
        return Err(Error::new("no log is named, expected at least one"));
    }
    Ok(found)
}

/// Whether a path is that of a table, or of a folder that holds one: neither a bag nor a recording nor a TOML by its name.
#[must_use]
pub fn is_table(path: &Path) -> bool {
    !is_joint_states(path) && path.extension().is_none_or(|ending| ending != "toml")
}

/// Whether a path is that of a bag, of one of its files or of an MCAP, by its name.
#[must_use]
pub fn is_joint_states(path: &Path) -> bool {
    (path.is_dir() && !lerobot::is_data_set(path)) || LogFormat::is_of_states(path)
}
