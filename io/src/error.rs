//! What is wrong with a file or with what was asked of it: its kind, a sentence, the place, and what helps.
//!
//! An [`Error`] is shown as `name:line:column: what was found, what was expected`, where it has a place. It is a
//! [`Diagnostic`] as well: a program with a terminal may show the lines around the place.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use armid::input::SizeError;
use armid::model::format::FormatError;
use armid::remedy::{Remedy, Setting, Task};
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

use crate::suggestion;
use crate::text::Text;

/// Why something could not be read, understood or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The file is there, or ought to be, and cannot be read.
    Unreadable(io::ErrorKind),
    /// The file cannot be written.
    Unwritable(io::ErrorKind),
    /// A name is neither a file nor one of those that are compiled in.
    Unknown,
    /// What was found is not what was expected.
    Invalid,
    /// Two things that are well by themselves do not belong together: a recording and another robot, say.
    Mismatch,
    /// An observer ended the work before there was anything to return.
    Interrupted,
}

/// Something is wrong with what was given.
#[derive(Debug)]
pub struct Error {
    kind: ErrorKind,
    message: String,
    remedy: Option<Remedy>,
    place: Option<Box<Place>>,
}

/// Where in a text it is.
#[derive(Debug)]
struct Place {
    source: NamedSource<Arc<str>>,
    span: Range<usize>,
    label: String,
    line: usize,
    column: usize,
    /// Whether the lines around it are short enough to be shown.
    shown: bool,
}

impl Error {
    /// Something is not as expected, in words or in those of another part's error.
    pub fn new(message: impl fmt::Display) -> Self {
        Self { kind: ErrorKind::Invalid, message: shortened(message.to_string()), remedy: None, place: None }
    }

    /// A name is neither a file nor compiled in.
    pub fn unknown(message: impl fmt::Display) -> Self {
        Self { kind: ErrorKind::Unknown, ..Self::new(message) }
    }

    /// Two things do not belong together.
    pub fn mismatch(message: impl fmt::Display) -> Self {
        Self { kind: ErrorKind::Mismatch, ..Self::new(message) }
    }

    /// An observer ended work on this before there was anything to return.
    pub fn interrupted(name: &str) -> Self {
        Self { kind: ErrorKind::Interrupted, ..Self::new(format!("{name}: interrupted")) }
    }

    /// A file cannot be read.
    pub fn unreadable(path: &Path, error: &io::Error) -> Self {
        let message = format!("{} cannot be read: {error}", path.display());
        let missing = error.kind() == io::ErrorKind::NotFound;
        let made_by = match path.extension().and_then(|extension| extension.to_str()) {
            Some("json") if missing => Some((Task::Identify, "LOG")),
            Some("mcap") if missing => Some((Task::Run, "EXPERIMENT")),
            _ => None,
        };
        let place = path.display().to_string();
        let makes = |task: Remedy| task.option(Setting::Output, &place).say(" makes such a file");
        let help = made_by.map(|(task, of)| makes(Remedy::task(task, of)));
        Self { kind: ErrorKind::Unreadable(error.kind()), ..Self::new(message).maybe_help(help) }
    }

    /// A file cannot be written.
    pub fn unwritable(path: &Path, error: &io::Error) -> Self {
        let message = format!("{} cannot be written: {error}", path.display());
        Self { kind: ErrorKind::Unwritable(error.kind()), ..Self::new(message) }
    }

    /// An error of one of the core's text formats, shown in the text.
    pub fn of_format(text: &Text, error: &FormatError) -> Self {
        let shown = Self::new(&error.message).maybe_help(suggestion::from_list_in(&error.message));
        match &error.span {
            Some(span) => shown.at_span(text, span.clone(), "here"),
            None => shown.at_line(text, error.line, error.column),
        }
    }

    /// An error of the reader of JSON, shown in the text.
    pub fn of_json(text: &Text, error: &serde_json::Error) -> Self {
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        Self::new(message).at_line(text, error.line(), error.column())
    }

    /// An error of the reader of TOML, shown in the text.
    pub fn of_toml(text: &Text, error: &toml::de::Error) -> Self {
        let message = error.message().trim_end();
        Self::new(message)
            .at_span(text, error.span().unwrap_or(0..0), "here")
            .maybe_help(suggestion::from_list_in(message))
    }

    /// Returns this error at some bytes of a text; the label stands under them.
    #[must_use]
    pub fn at_span(mut self, text: &Text, span: Range<usize>, label: impl Into<String>) -> Self {
        let (line, column) = text.line_and_column(span.start);
        let end = span.end.clamp(span.start, text.content.len().max(span.start));
        let source = NamedSource::new(&text.name, Arc::clone(&text.content));
        let shown = can_be_shown(&text.content, &(span.start..end));
        self.place = Some(Box::new(Place { source, span: span.start..end, label: label.into(), line, column, shown }));
        self
    }

    /// Returns this error at a line and a column that a reader reported.
    #[must_use]
    pub fn at_line(self, text: &Text, line: usize, column: usize) -> Self {
        let start = text.offset(line, column);
        let rest = &text.content[start..];
        let word = rest.find(['\n', ' ', ',', ']', '\r']).unwrap_or(rest.len()).max(usize::from(!rest.is_empty()));
        let mut end = start + word;
        while !text.content.is_char_boundary(end) {
            end += 1;
        }
        self.at_span(text, start..end, "here")
    }

    /// Returns this error with advice.
    #[must_use]
    pub fn help(mut self, help: impl Into<Remedy>) -> Self {
        self.remedy = Some(help.into());
        self
    }

    /// Returns this error with advice, if there is any.
    #[must_use]
    pub fn maybe_help(mut self, help: Option<impl Into<Remedy>>) -> Self {
        self.remedy = help.map(Into::into).or(self.remedy);
        self
    }

    /// Returns this error with more advice, after what it has.
    #[must_use]
    pub(crate) fn more_help(mut self, help: Option<Remedy>) -> Self {
        self.remedy = match (self.remedy, help) {
            (Some(first), Some(more)) => Some(Remedy([first.say("\n").0, more.0].concat())),
            (first, more) => first.or(more),
        };
        self
    }

    /// Returns this error about a robot that the file of an estimate names: where nothing has that name, `help` says what to do.
    #[must_use]
    pub fn of_an_estimate(mut self, estimate: &str, help: impl Into<Remedy>) -> Self {
        if self.kind == ErrorKind::Unknown {
            let looked = "looked for from the current folder and from that of the estimate";
            self.message = shortened(format!("{}: named by {estimate}, {looked}", self.message));
            self.remedy = Some(help.into());
        }
        self
    }

    /// What helps in words, where anything does.
    pub fn hint(&self) -> Option<String> {
        self.remedy.as_ref().map(ToString::to_string)
    }

    /// What helps, where anything does.
    pub const fn remedy(&self) -> Option<&Remedy> {
        self.remedy.as_ref()
    }

    /// What kind of error it is.
    pub const fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// What was found and what was expected, without the place.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The text's name, and line and column in it, both counted from one; `None` where the error is about no place.
    pub fn place(&self) -> Option<(&str, usize, usize)> {
        self.place.as_ref().map(|place| (place.source.name(), place.line, place.column))
    }
}

/// Longest sentence, bytes: what was found may be a file on one line.
const MESSAGE: usize = 2_000;
/// Longest text that is shown around a place, bytes: the line itself and those beside it.
const SHOWN: usize = 4_000;

/// A sentence with its middle left out where it is too long.
fn shortened(message: String) -> String {
    if message.len() <= MESSAGE {
        return message;
    }
    let boundary = |mut at: usize| {
        while !message.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let (begin, end) = (boundary(MESSAGE / 2), boundary(message.len() - MESSAGE / 2));
    format!("{} … ({} bytes left out) … {}", &message[..begin], end - begin, &message[end..])
}

/// The lines around some bytes, one before and one after, are few enough to be shown.
fn can_be_shown(text: &str, span: &Range<usize>) -> bool {
    let bytes = text.as_bytes();
    let back = |from: usize| bytes[..from].iter().rposition(|&byte| byte == b'\n').unwrap_or(0);
    let on = |from: usize| bytes[from..].iter().position(|&byte| byte == b'\n').map_or(bytes.len(), |at| from + at + 1);
    let start = span.start.min(bytes.len());
    let end = span.end.clamp(start, bytes.len());
    on(on(end)) - back(back(start)) <= SHOWN
}

impl From<SizeError> for Error {
    fn from(error: SizeError) -> Self {
        Self::new(error)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place() {
            Some((name, line, column)) => write!(f, "{name}:{line}:{column}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for Error {}

impl Diagnostic for Error {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.remedy.as_ref().map(|remedy| Box::new(remedy) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        let shown = self.place.as_ref().filter(|place| place.shown);
        shown.map(|place| &place.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref().filter(|place| place.shown)?;
        let label = LabeledSpan::new_with_span(Some(place.label.clone()), place.span.clone());
        Some(Box::new(std::iter::once(label)))
    }
}

#[cfg(test)]
mod tests {
    use super::{Error, ErrorKind};
    use crate::text::Text;

    #[test]
    fn a_place_is_counted_from_one_in_characters() {
        let text = Text::new("t.toml", "ä = 1\nöö = 2, 3\n");
        let error = Error::new("odd").at_line(&text, 2, 6);
        assert_eq!(error.place(), Some(("t.toml", 2, 6)));
        assert_eq!(error.to_string(), "t.toml:2:6: odd");
        assert_eq!(error.kind(), ErrorKind::Invalid);
        // Past the end is the end.
        assert_eq!(Error::new("odd").at_line(&text, 9, 9).place(), Some(("t.toml", 3, 1)));
    }

    #[test]
    fn a_line_without_end_is_not_shown_and_a_sentence_without_end_is_cut() {
        use miette::Diagnostic;
        let line = "1,".repeat(25_000_000);
        let text = Text::new("t.csv", format!("q1\n{line}\n2\n"));
        let began = std::time::Instant::now();
        let error = Error::new(format!("found \"{line}\"")).at_span(&text, 3..line.len(), "here");
        assert_eq!(error.place(), Some(("t.csv", 2, 1)));
        assert!(error.source_code().is_none() && error.labels().is_none());
        let shown = error.to_string();
        assert!(shown.len() < 2_200 && shown.contains("bytes left out"), "{}", shown.len());
        assert!(began.elapsed().as_secs() < 5);
        assert!(Error::new("odd").at_span(&text, 0..2, "here").source_code().is_none(), "its neighbour is as long");
        let text = Text::new("t.csv", "q1\n1\n2\n");
        assert!(Error::new("odd").at_span(&text, 3..4, "here").source_code().is_some());
    }

    #[test]
    fn a_file_that_is_not_there_says_so() {
        let error = Text::read(std::path::Path::new("/nonexistent/x.toml")).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unreadable(std::io::ErrorKind::NotFound));
        assert!(error.to_string().starts_with("/nonexistent/x.toml cannot be read: "), "{error}");
    }
}
