//! A CSV of numbers with one heading per column; faults carry line and column.

use std::ops::Range;

use armid::input::size::COLUMNS;

use super::line_length::check_lines;

use crate::error::Error;
use crate::suggestion;
use crate::text::Text;

/// Numbers in rows under named columns.
#[derive(Clone, Debug)]
pub(crate) struct NumberTable {
    /// The text they came from.
    pub(crate) text: Text,
    /// Headings, with their bytes in the text.
    pub(crate) columns: Vec<(String, Range<usize>)>,
    /// Values, row after row.
    values: Vec<f64>,
    /// The byte at which each row begins.
    starts: Vec<usize>,
}

impl NumberTable {
    /// Reads a table from its text. Lines that begin with `#` are comments; blank lines are skipped.
    pub(crate) fn parse(text: Text) -> Result<Self, Error> {
        check_lines(&text)?;
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .from_reader(text.content.as_bytes());
        let mut table = Self { text: text.clone(), columns: Vec::new(), values: Vec::new(), starts: Vec::new() };
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(|error| Error::new(format!("{}: {error}", text.name)))? {
            let position = record.position().map_or(0, |position| usize::try_from(position.byte()).unwrap_or(0));
            let start = first_of_record(&text.content, position);
            if table.columns.is_empty() {
                let names = record.iter().map(|name| name.trim().trim_start_matches('\u{feff}').to_owned());
                COLUMNS
                    .check_count("number of headings", record.len())
                    .map_err(|error| Error::from(error).at_span(&text, start..start, "here"))?;
                table.columns = names.zip(fields(&text.content, start, record.len())).collect();
                table.check_headings()?;
            } else {
                table.push_row(&record, start)?;
            }
        }
        if table.columns.is_empty() {
            return Err(Error::new(format!("{} is empty, expected a line of headings", text.name)));
        }
        Ok(table)
    }

    fn check_headings(&self) -> Result<(), Error> {
        for (k, (name, span)) in self.columns.iter().enumerate() {
            if self.columns[..k].iter().any(|(other, _)| other == name) {
                let message = format!("heading \"{name}\" occurs twice, expected each once");
                return Err(Error::new(message).at_span(&self.text, span.clone(), "here again"));
            }
        }
        Ok(())
    }

    fn push_row(&mut self, record: &csv::StringRecord, start: usize) -> Result<(), Error> {
        let spans = || fields(&self.text.content, start, record.len());
        if record.len() != self.columns.len() {
            let message = format!("found {} values, expected {}, one per heading", record.len(), self.columns.len());
            let end = spans().last().map_or(start, |span| span.end);
            return Err(Error::new(message).at_span(&self.text, start..end, "this row"));
        }
        for (k, field) in record.iter().enumerate() {
            match field.trim().parse::<f64>() {
                Ok(value) if value.is_finite() => self.values.push(value),
                _ => {
                    let name = &self.columns[k].0;
                    let message = format!("{name}: found \"{}\", expected a finite number", field.trim());
                    return Err(Error::new(message).at_span(&self.text, spans()[k].clone(), "no number"));
                }
            }
        }
        self.starts.push(start);
        Ok(())
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.starts.len()
    }

    /// The columns called `prefix1 … prefix n`, or a fault that says which heading is missing.
    pub(crate) fn numbered(&self, prefix: &str, n: usize) -> Result<Vec<usize>, Error> {
        (1..=n).map(|k| self.require(&format!("{prefix}{k}"))).collect()
    }

    /// The column with a heading, if it is there.
    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|(heading, _)| heading == name)
    }

    /// The column with a heading, or a fault with the nearest heading there is.
    pub(crate) fn require(&self, name: &str) -> Result<usize, Error> {
        self.find(name).ok_or_else(|| {
            let found: Vec<&str> = self.columns.iter().map(|(heading, _)| heading.as_str()).collect();
            let span = match (self.columns.first(), self.columns.last()) {
                (Some((_, first)), Some((_, last))) => first.start..last.end,
                _ => 0..0,
            };
            let near = suggestion::nearest(name, found).map(|near| format!("the nearest there is: \"{near}\""));
            Error::new(format!("heading \"{name}\" is missing"))
                .at_span(&self.text, span, "the headings")
                .maybe_help(near)
        })
    }

    /// A fault if there is an unexpected heading.
    pub(crate) fn only(&self, expected: &str, accepts: impl Fn(&str) -> bool) -> Result<(), Error> {
        match self.columns.iter().find(|(name, _)| !accepts(name)) {
            Some((name, span)) => {
                let message = format!("found heading \"{name}\", expected {expected}");
                Err(Error::new(message).at_span(&self.text, span.clone(), "not expected"))
            }
            None => Ok(()),
        }
    }

    /// The value in a row and a column.
    pub(crate) fn value(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.columns.len() + column]
    }

    /// Some columns of a row.
    pub(crate) fn pick(&self, row: usize, columns: &[usize]) -> Vec<f64> {
        columns.iter().map(|&column| self.value(row, column)).collect()
    }
}

/// Where a record's own line begins: the reader's position includes the comments and blank lines before it.
fn first_of_record(text: &str, position: usize) -> usize {
    let mut at = position;
    loop {
        let line = &text[at..];
        let length = line.find('\n').map_or(line.len(), |length| length + 1);
        let skipped = line.starts_with('#') || line[..length].trim().is_empty();
        if length == 0 || !skipped {
            return at;
        }
        at += length;
    }
}

/// The bytes of each field of the record whose line begins at `start`.
fn fields(text: &str, start: usize, count: usize) -> Vec<Range<usize>> {
    let line = text[start..].lines().next().unwrap_or_default();
    let whole = start..start + line.len();
    if line.contains('"') {
        return vec![whole; count];
    }
    let mut at = start;
    let mut spans: Vec<Range<usize>> = line
        .split(',')
        .map(|field| {
            let span = at..at + field.len();
            at = span.end + 1;
            span
        })
        .collect();
    spans.resize(count, whole);
    spans
}

#[cfg(test)]
mod tests {
    use super::NumberTable;
    use crate::text::Text;

    #[test]
    fn rows_are_read_past_comments_and_blank_lines() {
        let table = NumberTable::parse(Text::new("t.csv", "# a log\nq1,q2\n\n1,2\n# more\n 3 , 4e-1\r\n")).unwrap();
        assert_eq!(table.len(), 2);
        assert_eq!(table.pick(1, &[1, 0]), [0.4, 3.0]);
    }

    #[test]
    fn faults_carry_line_and_column() {
        for (text, fault) in [
            ("", "t.csv is empty, expected a line of headings"),
            ("q1,q1\n", "t.csv:1:4: heading \"q1\" occurs twice, expected each once"),
            ("q1,q2\n1,2\n# x\n3,four\n", "t.csv:4:3: q2: found \"four\", expected a finite number"),
            ("q1,q2\n1,NaN\n", "t.csv:2:3: q2: found \"NaN\", expected a finite number"),
            ("q1,q2\n1,2\n1\n", "t.csv:3:1: found 1 values, expected 2, one per heading"),
        ] {
            assert_eq!(NumberTable::parse(Text::new("t.csv", text)).unwrap_err().to_string(), fault);
        }
    }

    #[test]
    fn a_line_without_end_and_headings_without_end_are_refused_at_once() {
        let long = NumberTable::parse(Text::new("t.csv", format!("q1\n1\n{}", "1,".repeat(25_000_000)))).unwrap_err();
        let expected = "t.csv:3:1: length of the line is 50000000 bytes, expected at most 65536 bytes: \
                        a thousand columns with all their digits are shorter";
        assert_eq!(long.to_string(), expected);
        let wide = NumberTable::parse(Text::new("t.csv", "q,".repeat(2_000))).unwrap_err().to_string();
        assert!(wide.starts_with("t.csv:1:1: number of headings is 2001, expected at most 1000"), "{wide}");
    }

    #[test]
    fn a_missing_heading_is_named() {
        let table = NumberTable::parse(Text::new("t.csv", "q1,gd1\n1,2\n")).unwrap();
        assert_eq!(table.numbered("qd", 1).unwrap_err().to_string(), "t.csv:1:1: heading \"qd1\" is missing");
    }
}
