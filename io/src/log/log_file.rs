//! A `[log]` table: a TOML beside the data that says what a log is.
//!
//! ```toml
//! [log]
//! files = ["positions.csv", "currents.csv"]      # side by side; paths begin at this file
//! robot = "arm.urdf"
//! rate_hz = 1000                                  # where there is no column of times
//! q = "positions:joint_[1-6] deg motor gear=100"
//! tau = "currents:joint_[1-6] motor gear=100"
//! ```
//! Keys `t`, `q`, `qd`, `current`, `tau`, `q_link` and `q_cmd` are those of a [`Mapping`].

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::mapping::{Mapping, Quantity};
use crate::error::Error;
use crate::text::Text;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    log: Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    files: toml::Spanned<Vec<String>>,
    robot: Option<String>,
    rate_hz: Option<f64>,
    period_s: Option<f64>,
    from_s: Option<f64>,
    until_s: Option<f64>,
    t: Option<String>,
    q: Option<String>,
    qd: Option<String>,
    current: Option<String>,
    tau: Option<String>,
    q_link: Option<String>,
    q_cmd: Option<String>,
}

/// What a `[log]` table says.
#[derive(Clone, Debug, PartialEq)]
pub struct LogFile {
    /// The files, which stand side by side.
    pub files: Vec<PathBuf>,
    /// What the robot is called; relative to the table's own folder where it is a file there.
    pub robot: Option<String>,
    /// Rows per second.
    pub rate_hz: Option<f64>,
    /// Period of the motion, s.
    pub period_s: Option<f64>,
    /// Where the log begins to count, s.
    pub from_s: Option<f64>,
    /// Where it ends to count, s.
    pub until_s: Option<f64>,
    /// What the columns are; `None` leaves it to their headings.
    pub mapping: Option<Mapping>,
    /// The map of columns as `--map` takes it.
    pub mapping_text: Option<String>,
}

impl LogFile {
    /// Reads the table from its text; relative paths begin at `folder`.
    ///
    /// # Errors
    /// [`Error`] with line and column.
    pub fn parse(text: &Text, folder: &Path) -> Result<Self, Error> {
        let document: Document = toml::from_str(&text.content).map_err(|error| Error::of_toml(text, &error))?;
        let table = document.log;
        if table.files.as_ref().is_empty() {
            return Err(Error::new("files is empty, expected at least one").at_span(text, table.files.span(), "here"));
        }
        let values = [&table.t, &table.q, &table.qd, &table.current, &table.tau, &table.q_link, &table.q_cmd];
        let entries: Vec<(&str, &str)> = Quantity::ALL
            .into_iter()
            .zip(values)
            .filter_map(|(quantity, value)| value.as_deref().map(|value| (quantity.key(), value)))
            .collect();
        let (mapping, mapping_text) = if entries.is_empty() {
            (None, None)
        } else {
            let mapping = Mapping::of_entries(entries.iter().copied()).map_err(|fault| {
                let key = fault.split(':').next().unwrap_or_default();
                let at = text.content.lines().scan(0, |at, line| {
                    let start = *at;
                    *at += line.len() + 1;
                    Some((start, line))
                });
                let place = at.filter(|(_, line)| line.trim_start().split('=').next().is_some_and(|k| k.trim() == key));
                let span = place.last().map_or(0..0, |(start, line)| start..start + line.len());
                Error::new(fault).at_span(text, span, "here")
            })?;
            let said = entries.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(", ");
            (Some(mapping), Some(said))
        };
        let robot = table.robot.map(|name| {
            let beside = folder.join(&name);
            if beside.exists() { beside.display().to_string() } else { name }
        });
        Ok(Self {
            files: table.files.into_inner().iter().map(|file| folder.join(file)).collect(),
            robot,
            rate_hz: table.rate_hz,
            period_s: table.period_s,
            from_s: table.from_s,
            until_s: table.until_s,
            mapping,
            mapping_text,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::LogFile;
    use crate::text::Text;

    #[test]
    fn a_table_says_what_a_mapping_says() {
        let text = "[log]\nfiles = [\"a.csv\", \"b.csv\"]\nrate_hz = 50\nq = \"a:x[1-2] deg\"\ntau = \"b:y[1-2]\"\n";
        let file = LogFile::parse(&Text::new("log.toml", text), Path::new("data")).unwrap();
        assert_eq!(file.files, [Path::new("data/a.csv"), Path::new("data/b.csv")]);
        assert_eq!((file.rate_hz, file.mapping_text.as_deref()), (Some(50.0), Some("q=a:x[1-2] deg, tau=b:y[1-2]")));
        assert!(file.mapping.unwrap().names_files());
    }

    #[test]
    fn faults_carry_line_and_column() {
        for (text, wanted) in [
            ("[log]\nfiles = []\n", "log.toml:2:9: files is empty"),
            ("[log]\nfiles = [\"a\"]\nq = \"x\"\ntau = \"y A\"\n", "log.toml:4:1: tau: found \"A\""),
            ("[log]\nfiles = [\"a\"]\nrate = 3\n", "log.toml:3:1: unknown field `rate`"),
            ("[lok]\n", "unknown field `lok`"),
        ] {
            let fault = LogFile::parse(&Text::new("log.toml", text), Path::new("")).unwrap_err().to_string();
            assert!(fault.contains(wanted), "{wanted} not in {fault}");
        }
    }
}
