//! Tables: named columns with units, one cell per column in every row.

use crate::DocumentError;
use crate::drawing::ticks::{plain, significant};

/// A table with a caption.
///
/// Numbers stand to the right, texts to the left. A table of more than 24 rows starts folded up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What the table shows.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its heading.
    pub label: String,
    /// Unit of its numbers; may be empty.
    pub unit: String,
    /// Whether its cells stand to the right.
    pub numeric: bool,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A text; may hold `` `code` `` and `**bold**`.
    Text(String),
    /// A number, written with so many significant digits.
    Number {
        /// The number.
        value: f64,
        /// Significant digits, 1 to 17.
        digits: usize,
    },
    /// A number with so many digits after the point, for columns whose points should align.
    Fixed {
        /// The number.
        value: f64,
        /// Digits after the point, at most 15.
        decimals: usize,
    },
    /// Nothing to show, written as a dash.
    Missing,
}

impl Cell {
    /// A text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// A number with `digits` significant digits.
    pub fn number(value: f64, digits: usize) -> Self {
        Self::Number { value, digits }
    }

    /// A number with `decimals` digits after the point.
    pub fn fixed(value: f64, decimals: usize) -> Self {
        Self::Fixed { value, decimals }
    }

    /// A count.
    pub fn count(value: usize) -> Self {
        Self::Fixed { value: value as f64, decimals: 0 }
    }

    /// The cell as text: `−` for minus, powers of ten below 10⁻⁴ and from 10⁶ on, a dash for what is not a number.
    ///
    /// ```
    /// use armid_reports::document::Cell;
    /// assert_eq!(Cell::number(-0.012345, 3).written(), "−0.0123");
    /// assert_eq!(Cell::number(1.5e-7, 2).written(), "1.5×10⁻⁷");
    /// assert_eq!(Cell::fixed(95.25, 1).written(), "95.2");
    /// assert_eq!(Cell::number(f64::NAN, 3).written(), "–");
    /// ```
    pub fn written(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Missing => "–".to_owned(),
            Self::Number { value, .. } | Self::Fixed { value, .. } if value.is_nan() => "–".to_owned(),
            Self::Number { value, .. } | Self::Fixed { value, .. } if value.is_infinite() => {
                if *value > 0.0 {
                    "∞".to_owned()
                } else {
                    "−∞".to_owned()
                }
            }
            Self::Fixed { value, decimals } => plain(*value, (*decimals).min(15)),
            Self::Number { value, digits } => significant(*value, (*digits).clamp(1, 17)),
        }
    }
}

impl Column {
    /// Columns by their headings, between bars: `#` begins that of numbers, whose unit may stand behind it in brackets.
    ///
    /// ```
    /// use armid_reports::document::Column;
    /// assert_eq!(Column::list("joint | #torque [N·m]"), [Column::text("joint"), Column::number("torque", "N·m")]);
    /// ```
    pub fn list(headings: &str) -> Vec<Self> {
        let column = |heading: &str| match heading.strip_prefix('#') {
            None => Self::text(heading),
            Some(label) => match label.strip_suffix(']').and_then(|label| label.split_once(" [")) {
                Some((label, unit)) => Self::number(label, unit),
                None => Self::number(label, ""),
            },
        };
        headings.split(" | ").map(column).collect()
    }

    /// A column of texts.
    pub fn text(label: impl Into<String>) -> Self {
        Self { label: label.into(), unit: String::new(), numeric: false }
    }

    /// A column of numbers.
    pub fn number(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), numeric: true }
    }
}

impl Table {
    /// Rows from which on a table starts folded up.
    pub const FOLDED_FROM: usize = 25;

    /// A table without rows.
    pub fn new(caption: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { caption: caption.into(), columns, rows: Vec::new() }
    }

    /// Adds a row.
    #[must_use]
    pub fn row(mut self, cells: Vec<Cell>) -> Self {
        self.rows.push(cells);
        self
    }

    pub(super) fn check(&self) -> Result<(), DocumentError> {
        if self.caption.trim().is_empty() {
            return Err(DocumentError::Empty { what: "the caption of a table".to_owned(), expected: "a text" });
        }
        if self.columns.is_empty() {
            let what = format!("the list of columns of table \"{}\"", self.caption);
            return Err(DocumentError::Empty { what, expected: "at least one column" });
        }
        let expected = self.columns.len();
        match self.rows.iter().position(|cells| cells.len() != expected) {
            None => Ok(()),
            Some(index) => Err(DocumentError::Cells {
                table: self.caption.clone(),
                row: index + 1,
                found: self.rows[index].len(),
                expected,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::drawing::ticks::significant;

    #[test]
    fn analytic_significant_digits() {
        assert_eq!(significant(0.099_96, 3), "0.100");
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(123_456.0, 3), "123\u{202F}456");
        assert_eq!(significant(1_234_567.0, 3), "1.23×10⁶");
        assert_eq!(significant(-0.000_123_4, 2), "−0.00012");
        assert_eq!(significant(99_999.96, 7), "99\u{202F}999.96");
        assert_eq!(significant(5e-324, 2), "4.9×10⁻³²⁴");
    }
}
