//! Name, title and caption of a figure.

/// Name, title and caption of a figure.
///
/// ```
/// use armid_reports::Heading;
/// let heading = Heading::new("bias", "Bias stays inside its interval").caption("Points: mean over 25 runs.");
/// assert_eq!(heading.name, "bias");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Heading {
    /// Stem of the SVG file and prefix of HTML ids: lower-case letters, digits and hyphens.
    pub name: String,
    /// What one sees, as a statement.
    pub title: String,
    /// A line under the title: conditions, sample sizes. May be empty.
    pub subtitle: String,
    /// What each mark means and what follows from it: printed under the figure on the page, and read out by screen
    /// readers. May be empty.
    pub caption: String,
}

impl Heading {
    /// A heading without subtitle and caption.
    pub fn new(name: impl Into<String>, title: impl Into<String>) -> Self {
        Self { name: name.into(), title: title.into(), subtitle: String::new(), caption: String::new() }
    }

    /// Returns this heading with a line under the title.
    #[must_use]
    pub fn subtitle(mut self, subtitle: impl Into<String>) -> Self {
        self.subtitle = subtitle.into();
        self
    }

    /// Returns this heading with a caption.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }
}

/// A name of a study as a part of a file's name.
pub(crate) fn file_stem(name: &str) -> String {
    name.to_lowercase().replace(|c: char| !c.is_ascii_alphanumeric(), "-")
}
