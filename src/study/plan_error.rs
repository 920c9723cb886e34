//! Why a plan cannot be carried out.

use crate::experiment::{EffectKind, Effects, ExpectedEffectError};
use crate::input::{FileNameError, SizeError};
use crate::model::{ColumnsError, format::FormatError};

/// Why a plan cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum StudyPlanError {
    /// A name that is not in the list.
    #[error("{key} is \"{found}\", expected one of {}", names.join(", "))]
    Name { key: &'static str, found: String, names: Vec<String> },
    /// A name that no family has that could be meant.
    #[error("{key} is \"{found}\", expected one of the families: {}", families.join(", "))]
    Family { key: String, found: String, families: Vec<String> },
    /// Columns that cannot be estimated.
    #[error("identification.columns: {fault}")]
    Columns { found: String, fault: ColumnsError },
    /// An entry that is in its list already.
    #[error("{key} has \"{found}\" twice, expected each once")]
    Twice { key: &'static str, found: String },
    /// A number out of range.
    #[error("{key} is {found}, expected {expected}")]
    Number { key: String, found: String, expected: &'static str },
    /// Robots that do not make one study each.
    #[error("robots is [{}], expected {expected}", quoted(found))]
    Robots { found: Vec<String>, expected: &'static str },
    /// More than may be asked for.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A name that would leave its folder.
    #[error(transparent)]
    FileName(#[from] FileNameError),
}

impl StudyPlanError {
    /// The fault at its place in the plan's text.
    pub fn in_text(&self, text: &str) -> FormatError {
        FormatError::at_span(text, self.place(text), self.to_string())
    }

    /// Where in the text the fault's key stands: the first line with that key and the value that was found.
    fn place(&self, text: &str) -> std::ops::Range<usize> {
        let (key, found) = match self {
            Self::Name { key, found, .. } => (*key, found.as_str()),
            Self::Family { key, found, .. } | Self::Number { key, found, .. } => (key.as_str(), found.as_str()),
            Self::Twice { key, found } => (*key, found.as_str()),
            Self::Columns { found, .. } => ("columns", found.as_str()),
            Self::Robots { found, .. } => ("robots", found.first().map_or("", String::as_str)),
            Self::FileName(FileNameError { key, found, .. }) => (key.as_str(), found.as_str()),
            // A number may be written in more ways than one.
            Self::Size(SizeError { key, .. }) => (key.as_str(), ""),
        };
        let key = key.rsplit('.').next().unwrap_or(key);
        // What is counted together stands behind the key that counts most.
        let key = key.split([' ', ',']).next().unwrap_or(key);
        let mut begin = 0;
        for line in text.split_inclusive('\n') {
            if line.trim_start().starts_with(key) && line.contains(found) {
                let value = line.find('=').map_or(0, |at| line.len() - line[at + 1..].trim_start().len());
                let start = begin + if found.is_empty() { value } else { line.find(found).unwrap_or(0) };
                return start..start + found.len();
            }
            begin += line.len();
        }
        0..0
    }
}

fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

pub(super) fn number(key: impl Into<String>, found: impl ToString, expected: &'static str) -> StudyPlanError {
    StudyPlanError::Number { key: key.into(), found: found.to_string(), expected }
}

pub(super) fn expected(fault: &ExpectedEffectError) -> StudyPlanError {
    match fault {
        ExpectedEffectError::NoLaw { found } => {
            name("design.expected", found.name(), Effects::EXPECTABLE.map(EffectKind::name))
        }
    }
}

pub(super) fn family_name<'a>(
    key: impl Into<String>,
    found: &str,
    names: impl Iterator<Item = &'a str>,
) -> StudyPlanError {
    StudyPlanError::Family { key: key.into(), found: found.to_owned(), families: names.map(str::to_owned).collect() }
}

pub(super) fn name<'a>(key: &'static str, found: &str, names: impl IntoIterator<Item = &'a str>) -> StudyPlanError {
    StudyPlanError::Name { key, found: found.to_owned(), names: names.into_iter().map(str::to_owned).collect() }
}
