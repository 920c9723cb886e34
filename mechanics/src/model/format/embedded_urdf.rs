//! The URDF that a `robot.toml` names, and the same robot file with that text in it.
//!
//! ```text
//! urdf = "arm.urdf"          # relative to the robot file
//! base_link = "base"         # where the URDF is a tree
//! tip_link = "flange"
//!
//! [embedded]                 # in recordings: the text of the file that `urdf` names
//! urdf = '''<robot …'''
//! ```

use serde::Deserialize;
use toml::Spanned;

use super::error::FormatError;
use super::tree::ChainEnds;

/// What a robot file says of its URDF.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UrdfReference {
    /// The file, relative to the robot file.
    pub path: String,
    /// Which chain of the tree is meant.
    pub ends: ChainEnds,
    /// Its text, where the robot file holds it.
    pub text: Option<String>,
    /// Where the robot file names it, bytes.
    pub span: std::ops::Range<usize>,
}

/// The keys that say it; others are passed over here.
#[derive(Deserialize)]
struct ReferenceTable {
    urdf: Option<Spanned<toml::Value>>,
    base_link: Option<toml::Value>,
    tip_link: Option<toml::Value>,
    embedded: Option<toml::Value>,
}

/// The part of a recorded robot file that holds the URDF.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EmbeddedTable {
    pub(super) urdf: String,
}

/// The URDF that a robot file names; `None` where it names none.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::format::{embed_urdf, named_urdf};
/// let text = "urdf = \"arm.urdf\"\ntip_link = \"flange\"\n";
/// let reference = named_urdf(text)?.unwrap();
/// assert_eq!((reference.path.as_str(), reference.ends.tip.as_deref()), ("arm.urdf", Some("flange")));
/// let whole = embed_urdf(text, "<robot name=\"arm\"/>\n");
/// assert_eq!(named_urdf(&whole)?.unwrap().text.as_deref(), Some("<robot name=\"arm\"/>\n"));
/// assert_eq!(named_urdf("name = \"arm\"")?, None);
/// # Ok::<(), armid::model::format::FormatError>(())
/// ```
///
/// # Errors
/// [`FormatError`] where the text is no TOML, or `urdf` is no text.
pub fn named_urdf(text: &str) -> Result<Option<UrdfReference>, FormatError> {
    let table: ReferenceTable = super::reading::read(text)?;
    let Some(urdf) = table.urdf else { return Ok(None) };
    let Some(path) = urdf.get_ref().as_str() else {
        let message = format!("urdf is {}, expected the path of a file", urdf.get_ref());
        return Err(FormatError::at_span(text, urdf.span(), message));
    };
    let name = |value: Option<toml::Value>| value.and_then(|value| value.as_str().map(str::to_owned));
    let embedded = table.embedded.as_ref().and_then(|table| table.get("urdf")).and_then(toml::Value::as_str);
    Ok(Some(UrdfReference {
        path: path.to_owned(),
        ends: ChainEnds { base: name(table.base_link), tip: name(table.tip_link) },
        text: embedded.map(str::to_owned),
        span: urdf.span(),
    }))
}

/// A robot file with the text of its URDF at the end: whole by itself, every line before as it was.
pub fn embed_urdf(text: &str, urdf: &str) -> String {
    let end = if text.ends_with('\n') { "" } else { "\n" };
    format!("{text}{end}\n[embedded]\nurdf = {}\n", toml_text(urdf))
}

/// A text as a TOML value: as it is between three quotes where that keeps it, else with escapes.
fn toml_text(text: &str) -> String {
    let is_plain = |c: char| c == '\n' || c == '\t' || !c.is_control();
    if text.chars().all(is_plain) && !text.contains("'''") && !text.ends_with('\'') {
        return format!("'''\n{text}'''");
    }
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::{embed_urdf, named_urdf};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn identity_an_embedded_text_is_read_as_it_was(text in "[\\x00-\\x7fäπ\u{feff}\u{2028}]{0,60}") {
            let whole = embed_urdf("urdf = \"a.urdf\"", &text);
            prop_assert_eq!(named_urdf(&whole).unwrap().unwrap().text.unwrap(), text);
        }

        #[test]
        fn identity_quotes_and_line_ends_are_kept(text in "['\"\\\\\r\nb]{0,12}") {
            let whole = embed_urdf("urdf = \"a.urdf\"\n", &text);
            prop_assert_eq!(named_urdf(&whole).unwrap().unwrap().text.unwrap(), text);
        }
    }
}
