//! A table that something else wrote: any separator, with or without headings; columns become numbers when they are asked
//! for, so that others may hold anything.

use std::ops::Range;

use super::dialect::{Dialect, comment, is_comment};
use super::line_length::check_lines;
use crate::error::Error;
use crate::text::Text;

/// Rows of fields, with their places in the text.
#[derive(Clone, Debug)]
pub(crate) struct ForeignTable {
    pub(crate) text: Text,
    pub(crate) dialect: Dialect,
    /// Headings with their bytes in the text; `None` where the first line holds numbers.
    pub(crate) headings: Option<Vec<(String, Range<usize>)>>,
    /// Values in each row.
    pub(crate) width: usize,
    /// The bytes of each row.
    rows: Vec<Range<usize>>,
    /// Whether the last line ended before its last value.
    pub(crate) cut_off: bool,
}

impl ForeignTable {
    /// Finds out how the text is written, and where its rows are.
    ///
    /// # Errors
    /// [`Error`] where it has no rows, or a row has another number of values than the others.
    pub(crate) fn parse(text: Text) -> Result<Self, Error> {
        check_lines(&text)?;
        let content = text.content.clone();
        let bom = if content.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let dialect = Dialect::of(&content[bom..]);
        let (mut rows, mut commented, mut at) = (Vec::new(), None, bom);
        for line in content[bom..].split_inclusive('\n') {
            let range = at..at + line.trim_end_matches(['\n', '\r']).len();
            at += line.len();
            if !is_comment(&content[range.clone()]) {
                rows.push(range);
            } else if rows.is_empty() && comment(&content[range.clone()]).is_some() {
                commented = Some(range);
            }
        }
        let mut table = Self { text, dialect, headings: None, width: 0, rows, cut_off: false };
        table.find_headings(commented);
        table.check_widths()?;
        Ok(table)
    }

    /// The first line holds headings where it has fewer numbers than the second; else the last comment before the rows
    /// does, where it has as many words as they have values.
    fn find_headings(&mut self, commented: Option<Range<usize>>) {
        let Some(first) = self.rows.first().cloned() else { return };
        let numbers = |range: &Range<usize>| {
            self.fields(range).into_iter().filter(|at| self.number(at.clone()).is_some()).count()
        };
        let words = self.fields(&first).len();
        let is_heading = match self.rows.get(1) {
            Some(second) => numbers(&first) < numbers(second).min(words),
            None => numbers(&first) == 0,
        };
        let named = |fields: Vec<Range<usize>>| -> Vec<(String, Range<usize>)> {
            fields.into_iter().map(|at| (self.text.content[at.clone()].to_owned(), at)).collect()
        };
        if is_heading {
            self.headings = Some(named(self.fields(&first)));
            self.rows.remove(0);
        } else if let Some(range) = commented {
            let inner = comment(&self.text.content[range.clone()]).unwrap_or_default();
            let begin = range.end - inner.len();
            let fields: Vec<Range<usize>> =
                self.dialect.separator.split(inner).into_iter().map(|at| begin + at.start..begin + at.end).collect();
            if fields.len() == words && fields.iter().all(|at| self.number(at.clone()).is_none()) {
                self.headings = Some(named(fields));
            }
        }
    }

    fn check_widths(&mut self) -> Result<(), Error> {
        let width = match (&self.headings, self.rows.first()) {
            (Some(headings), _) => headings.len(),
            (None, Some(first)) => self.fields(first).len(),
            (None, None) => return Err(Error::new(format!("{} is empty, expected rows of numbers", self.text.name))),
        };
        self.width = width;
        for (k, range) in self.rows.iter().enumerate() {
            let fields = self.fields(range);
            let trailing = fields.len() == width + 1 && fields.last().is_some_and(Range::is_empty);
            if fields.len() == width || trailing {
                continue;
            }
            if k > 0 && k + 1 == self.rows.len() && fields.len() < width && !self.text.content.ends_with('\n') {
                self.cut_off = true;
                break;
            }
            let found = fields.len();
            let per = if self.headings.is_some() { "one per heading" } else { "as many as in the first row" };
            let message = format!("found {found} values, expected {width}, {per}");
            let help = format!("values were taken to be separated by {}", self.dialect.separator.name());
            return Err(Error::new(message).at_span(&self.text, range.clone(), "this row").help(help));
        }
        if self.cut_off {
            self.rows.pop();
        }
        Ok(())
    }

    fn fields(&self, row: &Range<usize>) -> Vec<Range<usize>> {
        let line = &self.text.content[row.clone()];
        self.dialect.separator.split(line).into_iter().map(|at| row.start + at.start..row.start + at.end).collect()
    }

    fn number(&self, at: Range<usize>) -> Option<f64> {
        self.dialect.number(&self.text.content[at])
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The names of the columns; their numbers from one where there are no headings.
    pub(crate) fn names(&self) -> Vec<String> {
        match &self.headings {
            Some(headings) => headings.iter().map(|(name, _)| name.clone()).collect(),
            None => (1..=self.width).map(|number| format!("#{number}")).collect(),
        }
    }

    /// Some columns as numbers, row after row. A field that is empty or says that there is no number (`NaN`, `null`,
    /// `-`) becomes NaN: a missing sample.
    ///
    /// # Errors
    /// [`Error`] with line and column where another text stands there.
    pub(crate) fn values(&self, columns: &[usize]) -> Result<Vec<f64>, Error> {
        let mut values = Vec::with_capacity(self.rows.len() * columns.len());
        for row in &self.rows {
            let fields = self.fields(row);
            for &column in columns {
                let at = fields[column].clone();
                let field = &self.text.content[at.clone()];
                values.push(match self.dialect.number(field) {
                    Some(value) if value.is_finite() => value,
                    Some(_) => f64::NAN,
                    None if ["", "-", "null", "none", "n/a", "na"].contains(&field.to_lowercase().as_str()) => f64::NAN,
                    None => {
                        let name = &self.names()[column];
                        let message = format!("{name}: found \"{field}\", expected a number");
                        return Err(Error::new(message).at_span(&self.text, at, "no number"));
                    }
                });
            }
        }
        Ok(values)
    }

    /// A fault about the headings, or the first row where there are none.
    pub(crate) fn heading_fault(&self, message: impl std::fmt::Display) -> Error {
        let span = match &self.headings {
            Some(headings) => headings.first().map_or(0, |h| h.1.start)..headings.last().map_or(0, |h| h.1.end),
            None => self.rows.first().cloned().unwrap_or(0..0),
        };
        let label = if self.headings.is_some() { "the headings" } else { "the first row: there are no headings" };
        Error::new(message).at_span(&self.text, span, label)
    }

    /// A fault at a row.
    pub(crate) fn row_fault(&self, row: usize, message: impl std::fmt::Display) -> Error {
        Error::new(message).at_span(&self.text, self.rows[row].clone(), "this row")
    }
}

#[cfg(test)]
mod tests {
    use super::ForeignTable;
    use crate::text::Text;

    fn table(text: &str) -> ForeignTable {
        ForeignTable::parse(Text::new("t.csv", text)).unwrap()
    }

    #[test]
    fn headings_are_found_out_or_columns_are_numbered() {
        assert_eq!(table("t,q1\n0,1\n").names(), ["t", "q1"]);
        assert_eq!(table("0,1\n2,3\n").names(), ["#1", "#2"]);
        // As numpy writes them.
        let commented = table("# t q1\n0 1\n2 3\n");
        assert_eq!((commented.names(), commented.len()), (vec!["t".to_owned(), "q1".to_owned()], 2));
        // A byte-order mark, a blank line, comments, a semicolon at the end of each line.
        let other = table("\u{feff}t;q1;\r\n\r\n0,5;1;\r\n% later\r\n1;2;\r\n");
        assert_eq!(other.names(), ["t", "q1", ""]);
        assert_eq!(other.values(&[0, 1]).unwrap(), [0.5, 1.0, 1.0, 2.0]);
    }

    #[test]
    fn missing_values_are_kept_as_such_and_other_columns_may_hold_anything() {
        let table = table("t,q1,state\n0,1,ok\n0.1,,ok\n0.2,NaN,bad\n");
        let q = table.values(&[1]).unwrap();
        assert!(q[0] == 1.0 && q[1].is_nan() && q[2].is_nan());
        let fault = table.values(&[2]).unwrap_err().to_string();
        assert_eq!(fault, "t.csv:2:5: state: found \"ok\", expected a number");
    }

    #[test]
    fn a_row_of_another_length_is_a_fault_unless_the_file_was_cut_off_in_it() {
        let fault = ForeignTable::parse(Text::new("t.csv", "a,b\n1,2\n3\n4,5\n")).unwrap_err().to_string();
        assert_eq!(fault, "t.csv:3:1: found 1 values, expected 2, one per heading");
        let cut = table("a,b,c\n1,2,3\n4,5,6\n7,8");
        assert!(cut.cut_off && cut.len() == 2);
        assert!(ForeignTable::parse(Text::new("t.csv", "")).is_err());
    }
}
