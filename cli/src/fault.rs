//! What is wrong with an input: file, line, column, what was found, what was expected.

use std::fmt;
use std::io::IsTerminal;
use std::ops::Range;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// A text and what it is called, for faults that point into it.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    pub(crate) name: String,
    pub(crate) content: Arc<str>,
}

impl Text {
    pub(crate) fn new(name: impl Into<String>, content: impl Into<Arc<str>>) -> Self {
        Self { name: name.into(), content: content.into() }
    }

    /// The byte at which a line and a column begin, both counted from one, the column in characters.
    fn offset(&self, line: usize, column: usize) -> usize {
        let mut offset = 0;
        for (number, content) in self.content.split_inclusive('\n').enumerate() {
            if number + 1 == line {
                let within = content.char_indices().nth(column.saturating_sub(1)).map_or(content.len(), |(at, _)| at);
                return offset + within;
            }
            offset += content.len();
        }
        self.content.len()
    }

    /// Line and column of a byte.
    pub(crate) fn position(&self, offset: usize) -> (usize, usize) {
        let mut offset = offset.min(self.content.len());
        while !self.content.is_char_boundary(offset) {
            offset -= 1;
        }
        let before = &self.content[..offset];
        let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
        (before.matches('\n').count() + 1, column)
    }
}

/// Something is wrong with what was given.
#[derive(Debug)]
pub(crate) struct Fault {
    message: String,
    help: Option<String>,
    place: Option<Box<Place>>,
}

#[derive(Debug)]
struct Place {
    source: NamedSource<Arc<str>>,
    span: Range<usize>,
    label: String,
    line: usize,
    column: usize,
}

impl Fault {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None, place: None }
    }

    /// A fault at some bytes of a text; the label stands under them.
    pub(crate) fn at(mut self, text: &Text, span: Range<usize>, label: impl Into<String>) -> Self {
        let (line, column) = text.position(span.start);
        let end = span.end.clamp(span.start, text.content.len().max(span.start));
        let source = NamedSource::new(&text.name, Arc::clone(&text.content));
        self.place = Some(Box::new(Place { source, span: span.start..end, label: label.into(), line, column }));
        self
    }

    /// A fault at a line and a column that a reader reported.
    pub(crate) fn at_line(self, text: &Text, line: usize, column: usize) -> Self {
        let start = text.offset(line, column);
        let rest = &text.content[start..];
        let word = rest.find(['\n', ' ', ',', ']', '\r']).unwrap_or(rest.len()).max(usize::from(!rest.is_empty()));
        let mut end = start + word;
        while !text.content.is_char_boundary(end) {
            end += 1;
        }
        self.at(text, start..end, "here")
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds a help where there is one.
    pub(crate) fn maybe_help(mut self, help: Option<String>) -> Self {
        self.help = help.or(self.help);
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{}:{}:{}: {}", place.source.name(), place.line, place.column, self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for Fault {}

impl Diagnostic for Fault {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place.as_ref().map(|place| &place.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref()?;
        let label = LabeledSpan::new_with_span(Some(place.label.clone()), place.span.clone());
        Some(Box::new(std::iter::once(label)))
    }
}

/// How faults are shown: with a snippet; in colour and wrapped only where a terminal shows them.
pub(crate) fn install_reporter() {
    let terminal = std::io::stderr().is_terminal();
    // A second call is the only way to fail, and there is none.
    let _ = miette::set_hook(Box::new(move |_| {
        let options = miette::MietteHandlerOpts::new().width(100).context_lines(1).wrap_lines(terminal);
        Box::new(if terminal { options } else { options.color(false) }.build())
    }));
}
