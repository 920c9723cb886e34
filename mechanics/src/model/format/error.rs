//! The one error of every text format: what is wrong, and where.

use std::ops::Range;

/// Why a text cannot be read, and where in it.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::format::parse_robot;
/// let fault = parse_robot("name = \"arm\"\nconvention = \"backwards\"\n").unwrap_err();
/// assert_eq!((fault.line, fault.column), (2, 14));
/// assert!(fault.message.contains("expected `standard` or `modified`"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {message}")]
pub struct FormatError {
    /// What was found and what was expected.
    pub message: String,
    /// Bytes of the text that are meant; `None` where only the line is known.
    pub span: Option<Range<usize>>,
    /// Line, from one.
    pub line: usize,
    /// Column in characters, from one.
    pub column: usize,
}

impl FormatError {
    /// A fault at some bytes of a text.
    pub fn at_span(text: &str, span: Range<usize>, message: impl Into<String>) -> Self {
        let mut start = span.start.min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
        Self { message: message.into(), span: Some(span), line, column }
    }

    /// A fault at a line and column that a parser reported.
    pub(super) fn at_line(line: usize, column: usize, message: impl Into<String>) -> Self {
        Self { message: message.into(), span: None, line: line.max(1), column: column.max(1) }
    }

    /// A fault of JSON, which ends its own message with the place.
    pub(super) fn of_json(fault: &serde_json::Error) -> Self {
        let message = fault.to_string();
        let place = format!(" at line {} column {}", fault.line(), fault.column());
        Self::at_line(fault.line(), fault.column(), message.strip_suffix(&place).unwrap_or(&message))
    }

    /// A fault of TOML's grammar or of the shape that a table must have.
    pub fn of_toml(text: &str, fault: &toml::de::Error) -> Self {
        Self::at_span(text, fault.span().unwrap_or(0..0), fault.message().trim_end())
    }
}
