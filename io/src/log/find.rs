//! Logs of any kind by their paths.

use std::path::{Path, PathBuf};

use super::foreign_csv;
use super::joint_log::Log;
use super::log_file::LogFile;
use super::mapping::Mapping;
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

/// Reads logs: MCAP files, tables, and TOML files with a `[log]` table. Tables are logs of their own, or one side by side where
/// the mapping names files. Mapping and rate are those of tables.
///
/// # Errors
/// [`Error`] where a file cannot be read, is no log, or is not as the mapping says.
pub fn find(paths: &[PathBuf], mapping: Option<&str>, rate_hz: Option<f64>) -> Result<FoundLogs, Error> {
    let parsed = mapping.map(Mapping::parse).transpose()?;
    let mut found = FoundLogs::default();
    if parsed.as_ref().is_some_and(Mapping::names_files) && paths.iter().all(|path| is_table(path)) {
        let texts = paths.iter().map(|path| Text::read(path)).collect::<Result<Vec<_>, _>>()?;
        let mut log = foreign_csv::parse(texts, parsed.as_ref(), rate_hz)?;
        log.origin.mapping = mapping.map(str::to_owned);
        found.logs.push(log);
        return Ok(found);
    }
    for path in paths {
        if path.extension().is_some_and(|extension| extension == "toml") {
            let file = LogFile::parse(&Text::read(path)?, path.parent().unwrap_or(Path::new("")))?;
            let texts = file.files.iter().map(|file| Text::read(file)).collect::<Result<Vec<_>, _>>()?;
            let mut log =
                foreign_csv::parse(texts, parsed.as_ref().or(file.mapping.as_ref()), rate_hz.or(file.rate_hz))?;
            log.origin.mapping = mapping.map(str::to_owned).or(file.mapping_text);
            found.robot = found.robot.or(file.robot);
            found.period_s = found.period_s.or(file.period_s);
            found.part_s = (found.part_s.0.or(file.from_s), found.part_s.1.or(file.until_s));
            found.logs.push(log);
        } else if is_table(path) && (parsed.is_some() || rate_hz.is_some()) {
            let mut log = foreign_csv::parse(vec![Text::read(path)?], parsed.as_ref(), rate_hz)?;
            log.origin.mapping = mapping.map(str::to_owned);
            found.logs.push(log);
        } else {
            found.logs.push(Log::read(path)?);
        }
    }
    if found.logs.is_empty() {
        return Err(Error::new("no log is named, expected at least one"));
    }
    Ok(found)
}

/// Whether a path is that of a table: neither a folder nor a recording nor a TOML by its name.
#[must_use]
pub fn is_table(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    !path.is_dir() && [".mcap", ".mcap.part", ".db3", ".toml"].iter().all(|ending| !name.ends_with(ending))
}
