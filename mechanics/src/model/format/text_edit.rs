//! Changes of an XML text that are made at once; everything else stays byte for byte.

use std::ops::Range;

use super::element::{Element, parse_xml};
use super::error::FormatError;

/// A text whose numbers were changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EditedText {
    /// The text.
    pub text: String,
    /// What else the reader must know, a sentence each.
    pub remarks: Vec<String>,
}

/// Changes that are not made yet.
pub(super) struct TextEdit<'t> {
    text: &'t str,
    changes: Vec<(Range<usize>, String)>,
}

impl<'t> TextEdit<'t> {
    pub(super) const fn of(text: &'t str) -> Self {
        Self { text, changes: Vec::new() }
    }

    pub(super) fn insert(&mut self, at: usize, words: String) {
        self.replace(at..at, words);
    }

    pub(super) fn replace(&mut self, range: Range<usize>, words: String) {
        self.changes.push((range, words));
    }

    /// Numbers of an attribute, which is left as it is written where it says them already.
    pub(super) fn set<const N: usize>(
        &mut self,
        element: Element<'_>,
        key: &str,
        values: [f64; N],
    ) -> Result<(), FormatError> {
        if element.numbers::<N>(key)? == Some(values) {
            return Ok(());
        }
        self.set_words(element, key, numbers(&values));
        Ok(())
    }

    /// Words of an attribute.
    pub(super) fn set_words(&mut self, element: Element<'_>, key: &str, words: String) {
        match element.attribute(key) {
            Some(attribute) => self.replace(attribute.range_value(), words),
            None => self.insert(element.span().end, format!(" {key}=\"{words}\"")),
        }
    }

    /// Words inside an element, before all it has.
    pub(super) fn first_child(&mut self, element: Element<'_>, words: &str) {
        let mut quote = None;
        for (at, letter) in self.text[element.span().end..].char_indices() {
            match (quote, letter) {
                (None, '"' | '\'') => quote = Some(letter),
                (Some(open), _) if open == letter => quote = None,
                (None, '>') => {
                    let end = element.span().end + at;
                    if self.text[..end].ends_with('/') {
                        self.replace(end - 1..end + 1, format!(">{words}</{}>", element.tag()));
                    } else {
                        self.insert(end + 1, words.to_owned());
                    }
                    return;
                }
                _ => {}
            }
        }
    }

    /// The white space that ends at a byte.
    pub(super) fn gap_before(&self, at: usize) -> &'t str {
        let before = &self.text[..at];
        &before[before.trim_end().len()..]
    }

    pub(super) fn done(mut self) -> String {
        self.changes.sort_by_key(|(range, _)| range.start);
        let (mut text, mut from) = (String::with_capacity(self.text.len()), 0);
        for (range, words) in &self.changes {
            text.push_str(&self.text[from..range.start]);
            text.push_str(words);
            from = range.end;
        }
        text.push_str(&self.text[from..]);
        text
    }
}

/// Numbers that read back as the same bits; no minus before a zero.
pub(super) fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| format!("{:?}", value + 0.0)).collect::<Vec<_>>().join(" ")
}

/// Begins the comment that [`note`] writes.
const NOTE: &str = "<!-- armid:";

/// The text with a comment before its root element, in the place of one that was written by the same function.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::format::note;
/// let once = note("<robot name=\"arm\"/>", "8.6 %").unwrap();
/// assert_eq!(once, "<!-- armid: 8.6 % -->\n<robot name=\"arm\"/>");
/// assert_eq!(note(&once, "9.1 %").unwrap(), "<!-- armid: 9.1 % -->\n<robot name=\"arm\"/>");
/// ```
///
/// # Errors
/// [`FormatError`] where the text is no XML.
pub fn note(text: &str, words: &str) -> Result<String, FormatError> {
    let document = parse_xml(text)?;
    let root = Element::root(&document).range().start;
    // Two hyphens would end a comment.
    let words = format!("{NOTE} {} -->", words.replace("--", "- -"));
    let before = &text[..root];
    let old = before.find(NOTE).and_then(|at| Some(at..at + before[at..].find("-->")? + 3));
    let mut edit = TextEdit::of(text);
    match old {
        Some(range) => edit.replace(range, words),
        None => edit.insert(root, format!("{words}\n")),
    }
    Ok(edit.done())
}
