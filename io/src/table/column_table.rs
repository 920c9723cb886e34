//! A table whose columns are numbers already: arrays and columns that a binary file holds by name.

use std::ops::Range;

use crate::error::Error;

/// Columns of an array at most: what has more holds something else than one value for each joint, or stands on its side.
pub(crate) const MOST_COLUMNS: usize = 64;

/// A column, or what stands in its place.
#[derive(Clone, Debug)]
struct Column {
    name: String,
    /// The values, or what the file holds under this name instead.
    values: Result<Vec<f64>, String>,
    unit: Option<&'static str>,
}

/// Columns by name, of equal or of unlike length.
#[derive(Clone, Debug)]
pub(crate) struct ColumnTable {
    pub(crate) name: String,
    pub(crate) sha256: String,
    columns: Vec<Column>,
    /// Arrays of several columns by their names.
    arrays: Vec<(String, Range<usize>)>,
    /// The heading of the stamps, where the format itself says which they are.
    pub(crate) time: Option<&'static str>,
    /// What was found on the way, a sentence each.
    pub(crate) remarks: Vec<String>,
    /// What the file may lack, and what helps then.
    pub(crate) lacking: Option<&'static str>,
}

impl ColumnTable {
    /// A table without columns.
    pub(crate) fn new(name: impl Into<String>, sha256: String) -> Self {
        let (columns, arrays) = (Vec::new(), Vec::new());
        Self { name: name.into(), sha256, columns, arrays, time: None, remarks: Vec::new(), lacking: None }
    }

    /// Adds a column; `unit` is the one that the file states.
    pub(crate) fn add(&mut self, name: &str, values: Vec<f64>, unit: Option<&'static str>) {
        self.columns.push(Column { name: name.to_owned(), values: Ok(values), unit });
    }

    /// Adds an array of `width` columns, row after row: its columns are called `name_0`, `name_1` and so on, and `name` stands for all.
    pub(crate) fn add_array(&mut self, name: &str, rows: &[f64], width: usize) {
        if width == 0 || width > MOST_COLUMNS {
            let found = rows.len().checked_div(width).unwrap_or(0);
            let what = format!("an array of {found} × {width}, expected rows of at most {MOST_COLUMNS} values");
            return self.add_other(name, what);
        }
        let first = self.columns.len();
        for k in 0..width {
            self.add(&format!("{name}_{k}"), rows.iter().skip(k).step_by(width).copied().collect(), None);
        }
        self.arrays.push((name.to_owned(), first..first + width));
    }

    /// Adds a name under which the file holds something else than columns of numbers.
    pub(crate) fn add_other(&mut self, name: &str, what: impl Into<String>) {
        self.columns.push(Column { name: name.to_owned(), values: Err(what.into()), unit: None });
    }

    /// The names of the columns, each once.
    pub(crate) fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.columns.len()
    }

    /// The columns of an array by its name.
    pub(crate) fn array(&self, name: &str) -> Option<Range<usize>> {
        self.arrays.iter().find(|(known, _)| known == name).map(|(_, columns)| columns.clone())
    }

    /// The unit that the file states of a column.
    pub(crate) fn unit(&self, column: usize) -> Option<&'static str> {
        self.columns[column].unit
    }

    /// The values of a column.
    ///
    /// # Errors
    /// [`Error`] where it holds no numbers.
    pub(crate) fn numbers(&self, column: usize) -> Result<&Vec<f64>, Error> {
        let column = &self.columns[column];
        column.values.as_ref().map_err(|what| {
            Error::new(format!("{}: {} holds {what}; expected a column of numbers", self.name, column.name))
        })
    }

    /// Some columns, row after row.
    ///
    /// # Errors
    /// [`Error`] where one holds no numbers, or they are of unlike length.
    pub(crate) fn values(&self, columns: &[usize]) -> Result<Vec<f64>, Error> {
        let mut found: Vec<&Vec<f64>> = Vec::with_capacity(columns.len());
        for &at in columns {
            let values = self.numbers(at)?;
            if let Some(first) = found.first().filter(|first| first.len() != values.len()) {
                let (name, other) = (&self.columns[columns[0]].name, &self.columns[at].name);
                let (a, b) = (first.len(), values.len());
                let message = format!("{}: {name} has {a} rows and {other} has {b}, expected as many", self.name);
                return Err(Error::mismatch(message));
            }
            found.push(values);
        }
        let rows = found.first().map_or(0, |values| values.len());
        Ok((0..rows).flat_map(|row| found.iter().map(move |values| values[row])).collect())
    }

    /// A fault about the columns that there are.
    pub(crate) fn heading_fault(&self, message: impl std::fmt::Display) -> Error {
        let names =
            self.columns.iter().enumerate().filter(|(at, _)| !self.arrays.iter().any(|(_, of)| of.contains(at)));
        let arrays = self.arrays.iter().map(|(name, range)| format!("{name} ({} columns)", range.len()));
        let all: Vec<String> = names.map(|(_, column)| column.name.clone()).chain(arrays).collect();
        let found = if all.is_empty() { "no column of numbers".to_owned() } else { all.join(", ") };
        Error::new(format!("{}: {message}, found {found}", self.name))
    }
}

#[cfg(test)]
mod tests {
    use super::ColumnTable;

    #[test]
    fn columns_of_arrays_are_numbered_from_zero_and_the_array_is_all_of_them() {
        let mut table = ColumnTable::new("r.npz", String::new());
        table.add("t", vec![0.0, 0.1], None);
        table.add_array("q", &[1.0, 2.0, 3.0, 4.0], 2);
        table.add_array("aside", &[0.0; 300], 100);
        assert_eq!(table.names(), ["t", "q_0", "q_1", "aside"]);
        assert_eq!(table.array("q"), Some(1..3));
        assert_eq!(table.values(&[1, 2]).unwrap(), [1.0, 2.0, 3.0, 4.0]);
        let fault = table.values(&[3]).unwrap_err().to_string();
        assert!(fault.contains("aside holds an array of 3 × 100"), "{fault}");
        table.add("gear", vec![1.0; 3], None);
        let fault = table.values(&[0, 4]).unwrap_err().to_string();
        assert_eq!(fault, "r.npz: t has 2 rows and gear has 3, expected as many");
        let fault = table.heading_fault("heading \"tau\" is missing").to_string();
        assert_eq!(fault, "r.npz: heading \"tau\" is missing, found t, aside, gear, q (2 columns)");
    }
}
