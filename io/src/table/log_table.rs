//! A table of a log: a text, or columns that a binary file holds.

use armid::provenance::sha256;

use super::{ColumnTable, ForeignTable, Separator};
use crate::error::Error;
use crate::text::Text;

/// A table of either kind.
#[derive(Clone, Debug)]
pub(crate) enum LogTable {
    Text {
        table: ForeignTable,
        /// SHA-256 of the bytes of its file.
        sha256: String,
    },
    Columns(ColumnTable),
}

impl LogTable {
    /// That of a text.
    ///
    /// # Errors
    /// [`Error`] where it has no rows, or a row has another number of values than the others.
    pub(crate) fn of_text(text: Text) -> Result<Self, Error> {
        let sha256 = sha256(&text.content);
        Self::of_unpacked(text, sha256)
    }

    /// That of a text which was unpacked from a file with this SHA-256.
    ///
    /// # Errors
    /// As [`Self::of_text`].
    pub(crate) fn of_unpacked(text: Text, sha256: String) -> Result<Self, Error> {
        Ok(Self::Text { table: ForeignTable::parse(text)?, sha256 })
    }

    /// What errors call it.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Text { table, .. } => &table.text.name,
            Self::Columns(table) => &table.name,
        }
    }

    /// SHA-256 of the bytes of its file.
    pub(crate) fn sha256(&self) -> String {
        match self {
            Self::Text { sha256, .. } => sha256.clone(),
            Self::Columns(table) => table.sha256.clone(),
        }
    }

    /// Number of rows, where all columns have as many.
    pub(crate) fn rows(&self) -> Option<usize> {
        match self {
            Self::Text { table, .. } => Some(table.len()),
            Self::Columns(_) => None,
        }
    }

    /// Whether its columns have names of their own.
    pub(crate) fn has_headings(&self) -> bool {
        match self {
            Self::Text { table, .. } => table.headings.is_some(),
            Self::Columns(_) => true,
        }
    }

    /// The names of the columns.
    pub(crate) fn names(&self) -> Vec<String> {
        match self {
            Self::Text { table, .. } => table.names(),
            Self::Columns(table) => table.names(),
        }
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        match self {
            Self::Text { table, .. } => table.width,
            Self::Columns(table) => table.width(),
        }
    }

    /// The columns that a binary file holds; `None` of a text.
    pub(crate) fn columns(&self) -> Option<&ColumnTable> {
        match self {
            Self::Text { .. } => None,
            Self::Columns(table) => Some(table),
        }
    }

    /// Some columns as numbers, row after row; NaN where a value is missing.
    ///
    /// # Errors
    /// [`Error`] with its place where something else stands there.
    pub(crate) fn values(&self, columns: &[usize]) -> Result<Vec<f64>, Error> {
        match self {
            Self::Text { table, .. } => table.values(columns),
            Self::Columns(table) => table.values(columns),
        }
    }

    /// A fault about the headings.
    pub(crate) fn heading_fault(&self, message: &str) -> Error {
        match self {
            Self::Text { table, .. } => table.heading_fault(message),
            Self::Columns(table) => table.heading_fault(message),
        }
    }

    /// A fault at a row, from zero.
    pub(crate) fn row_fault(&self, row: usize, message: &str) -> Error {
        match self {
            Self::Text { table, .. } => table.row_fault(row, message),
            Self::Columns(table) => Error::new(format!("{}: row {}: {message}", table.name, row + 1)),
        }
    }

    /// How it is written where that is not plain.
    pub(crate) fn remarks(&self) -> Vec<String> {
        let table = match self {
            Self::Text { table, .. } => table,
            Self::Columns(table) => return table.remarks.clone(),
        };
        let mut how = Vec::new();
        if table.dialect.separator != Separator::Comma {
            how.push(format!("values separated by {}", table.dialect.separator.name()));
        }
        if table.dialect.decimal_comma {
            how.push("decimal commas".to_owned());
        }
        if table.headings.is_none() {
            how.push("no headings".to_owned());
        }
        if table.cut_off {
            how.push("the last row was cut off and is left out".to_owned());
        }
        how
    }
}
