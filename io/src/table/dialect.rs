//! How a table of numbers is written: separator, decimal sign, comments, headings. Found out from its first lines.
//!
//! Each candidate splits the first lines; the one under which most lines have the same number of fields, and most fields
//! are numbers, is taken. A comma is a decimal sign where the separator is another one and reads more numbers with it.

use std::ops::Range;

/// Lines that are looked at.
const LOOKED_AT: usize = 64;
/// What a comment begins with.
const COMMENTS: [&str; 3] = ["#", "%", "//"];

/// What stands between two values of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    Semicolon,
    Tab,
    Bar,
    Comma,
    /// Any number of spaces.
    Blanks,
}

impl Separator {
    /// In the order in which equally good ones are taken.
    const ALL: [Self; 5] = [Self::Semicolon, Self::Tab, Self::Bar, Self::Comma, Self::Blanks];

    /// What a reader is given.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Bar => "bars",
            Self::Comma => "commas",
            Self::Blanks => "blanks",
        }
    }

    const fn sign(self) -> Option<char> {
        match self {
            Self::Semicolon => Some(';'),
            Self::Tab => Some('\t'),
            Self::Bar => Some('|'),
            Self::Comma => Some(','),
            Self::Blanks => None,
        }
    }

    /// The bytes of each field of a line, blanks and quotes around it left out. A separator inside quotes is text.
    pub(crate) fn split(self, line: &str) -> Vec<Range<usize>> {
        let Some(sign) = self.sign() else {
            let base = line.as_ptr() as usize;
            return line
                .split_whitespace()
                .map(|word| {
                    let start = word.as_ptr() as usize - base;
                    start..start + word.len()
                })
                .collect();
        };
        let (mut fields, mut start, mut quoted) = (Vec::new(), 0, false);
        for (at, c) in line.char_indices() {
            if c == '"' {
                quoted = !quoted;
            } else if c == sign && !quoted {
                fields.push(trimmed(line, start..at));
                start = at + c.len_utf8();
            }
        }
        fields.push(trimmed(line, start..line.len()));
        fields
    }
}

/// A range without the blanks and quotes around it.
fn trimmed(line: &str, range: Range<usize>) -> Range<usize> {
    let field = &line[range.clone()];
    let front = field.trim_start_matches(|c: char| c.is_whitespace() || c == '"');
    let start = range.start + field.len() - front.len();
    let inner = front.trim_end_matches(|c: char| c.is_whitespace() || c == '"');
    start..start + inner.len()
}

/// How a table is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dialect {
    pub(crate) separator: Separator,
    pub(crate) decimal_comma: bool,
}

impl Dialect {
    /// The dialect in which the first lines of a text make the best table.
    pub(crate) fn of(text: &str) -> Self {
        let lines: Vec<&str> = text.lines().filter(|line| !is_comment(line)).take(LOOKED_AT).collect();
        let mut best = (0.0, Self { separator: Separator::Comma, decimal_comma: false });
        for separator in Separator::ALL {
            for decimal_comma in [false, true] {
                let dialect = Self { separator, decimal_comma };
                if decimal_comma && separator == Separator::Comma {
                    continue;
                }
                let score = dialect.score(&lines);
                if score > best.0 + 1e-9 {
                    best = (score, dialect);
                }
            }
        }
        best.1
    }

    /// The part of the lines with the usual number of fields, at least two, times the part of their fields that are
    /// numbers.
    fn score(self, lines: &[&str]) -> f64 {
        // Headings may hold anything: they do not count where there are rows below them.
        let rows = if lines.len() > 1 { &lines[1..] } else { lines };
        let mut counts: Vec<usize> = rows.iter().map(|line| self.separator.split(line).len()).collect();
        counts.sort_unstable();
        let usual = counts.get(counts.len() / 2).copied().unwrap_or(0);
        if usual < 2 {
            return 0.0;
        }
        let regular: Vec<&&str> = rows.iter().filter(|line| self.separator.split(line).len() == usual).collect();
        let numbers: usize = regular
            .iter()
            .map(|line| {
                self.separator.split(line).into_iter().filter(|at| self.number(&line[at.clone()]).is_some()).count()
            })
            .sum();
        regular.len() as f64 / rows.len() as f64 * numbers as f64 / (regular.len() * usual) as f64
    }

    /// A field as a number; NaN is one, an empty field is none.
    pub(crate) fn number(self, field: &str) -> Option<f64> {
        if self.decimal_comma && field.contains(',') {
            // A point beside the comma would be a sign of thousands: not a number that can be trusted.
            return if field.contains('.') { None } else { field.replacen(',', ".", 1).parse().ok() };
        }
        field.parse().ok()
    }
}

/// Whether a line holds no row: blank, or a comment.
pub(crate) fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || COMMENTS.iter().any(|sign| line.starts_with(sign))
}

/// The content of a comment.
pub(crate) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    COMMENTS.iter().find_map(|sign| line.strip_prefix(sign))
}

#[cfg(test)]
mod tests {
    use super::{Dialect, Separator};

    #[test]
    fn separators_and_decimal_signs_are_found_out() {
        for (text, separator, decimal_comma) in [
            ("t,q1\n0,1\n0.1,2\n", Separator::Comma, false),
            ("t;q1\n0;1\n0.1;2\n", Separator::Semicolon, false),
            ("t;q1\n0;1\n0,1;2,5\n", Separator::Semicolon, true),
            ("0,1\t2,5\n0,2\t2,6\n", Separator::Tab, true),
            ("  0.1   2.5\n  0.2   2.6\n", Separator::Blanks, false),
            ("t q1\n0,1 2,5\n0,2 2,6\n", Separator::Blanks, true),
            ("t;q1;state\n0,1;2,5;ok\n0,2;2,6;ok\n", Separator::Semicolon, true),
            ("0|1\n2|3\n", Separator::Bar, false),
            // Two columns of whole numbers, not one with decimal commas.
            ("0,1\n1,2\n", Separator::Comma, false),
        ] {
            assert_eq!(Dialect::of(text), Dialect { separator, decimal_comma }, "{text:?}");
        }
    }

    #[test]
    fn fields_stand_without_blanks_and_quotes() {
        let line = "\"joint 1, deg\", 2 ,\t3";
        let fields: Vec<&str> = Separator::Comma.split(line).into_iter().map(|at| &line[at]).collect();
        assert_eq!(fields, ["joint 1, deg", "2", "3"]);
        let line = "  a  b ";
        let fields: Vec<&str> = Separator::Blanks.split(line).into_iter().map(|at| &line[at]).collect();
        assert_eq!(fields, ["a", "b"]);
    }
}
