//! The parts of a document.

use super::Table;
use crate::{DocumentError, Drawing, Figure, Sheet};

/// A report: title, summary, sections, and what produced it.
///
/// Texts may hold `` `code` `` and `**bold**`; everything else is taken literally.
///
/// ```
/// use armid_reports::document::{Cell, Column, Document, Section, Table};
/// let table = Table::new("Torque error", vec![Column::text("joint"), Column::number("RMSE", "N·m")])
///     .row(vec![Cell::text("J1"), Cell::number(0.0612, 3)]);
/// let document = Document::new("Which criterion?")
///     .summary("The D-optimal design wins by **12 %**.")
///     .provenance("seed", "2024")
///     .section(Section::new("Result").text("The error is smallest for `d-optimal`.").table(table));
/// let html = document.html().unwrap();
/// assert!(html.contains("<code>d-optimal</code>") && html.contains("0.0612"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Title of the page.
    pub title: String,
    /// A line under the title; may be empty.
    pub subtitle: String,
    /// What the reader should take away, a paragraph each.
    pub summary: Vec<String>,
    /// The sections, in order.
    pub sections: Vec<Section>,
    /// What produced the report: pairs of name and value.
    pub provenance: Vec<(String, String)>,
}

/// A heading and what stands under it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// The heading.
    pub heading: String,
    /// Text, figures, tables, in order.
    pub blocks: Vec<Block>,
}

/// One part of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A bulleted list.
    List(Vec<String>),
    /// A bulleted list of links: what each is called, and its address relative to the page.
    Links(Vec<(String, String)>),
    /// A figure.
    Figure(RenderedFigure),
    /// A table.
    Table(Table),
}

/// A figure that has been drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderedFigure {
    /// Stem of its file name.
    pub name: String,
    /// What one sees.
    pub title: String,
    /// What each mark means.
    pub caption: String,
    /// One SVG element, for a screen.
    pub svg: String,
    /// The figure for a column and a page of a journal.
    papers: Box<[Drawing; 2]>,
}

impl RenderedFigure {
    /// Draws a figure.
    ///
    /// # Errors
    /// [`DocumentError::Figure`] where the figure cannot be drawn.
    pub fn draw(figure: &dyn Figure) -> Result<Self, DocumentError> {
        Ok(Self {
            svg: figure.svg()?,
            papers: Box::new([figure.draw(Sheet::Column)?, figure.draw(Sheet::Page)?]),
            name: figure.name().to_owned(),
            title: figure.title().to_owned(),
            caption: figure.caption().to_owned(),
        })
    }
}

impl Section {
    /// A section without content.
    pub fn new(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), blocks: Vec::new() }
    }

    /// Adds any block.
    #[must_use]
    pub fn block(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// Adds a paragraph.
    #[must_use]
    pub fn text(self, text: impl Into<String>) -> Self {
        self.block(Block::Text(text.into()))
    }

    /// Adds a bulleted list.
    pub fn list<I: IntoIterator<Item = S>, S: Into<String>>(self, items: I) -> Self {
        self.block(Block::List(items.into_iter().map(Into::into).collect()))
    }

    /// Adds a bulleted list of links, each a text and an address relative to the page.
    pub fn links<I: IntoIterator<Item = (S, S)>, S: Into<String>>(self, links: I) -> Self {
        self.block(Block::Links(links.into_iter().map(|(text, address)| (text.into(), address.into())).collect()))
    }

    /// Adds a table.
    #[must_use]
    pub fn table(self, table: Table) -> Self {
        self.block(Block::Table(table))
    }

    /// Draws and adds a figure.
    ///
    /// # Errors
    /// [`DocumentError::Figure`] where the figure cannot be drawn.
    pub fn figure(self, figure: &dyn Figure) -> Result<Self, DocumentError> {
        Ok(self.block(Block::Figure(RenderedFigure::draw(figure)?)))
    }
}

impl Document {
    /// A document without content.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Returns this document with a line under the title.
    #[must_use]
    pub fn subtitle(mut self, subtitle: impl Into<String>) -> Self {
        self.subtitle = subtitle.into();
        self
    }

    /// Adds a paragraph to the summary.
    #[must_use]
    pub fn summary(mut self, paragraph: impl Into<String>) -> Self {
        self.summary.push(paragraph.into());
        self
    }

    /// Adds a section.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// Adds a line of provenance.
    #[must_use]
    pub fn provenance(mut self, name: impl Into<String>, value: impl Into<String>) -> Self {
        self.provenance.push((name.into(), value.into()));
        self
    }

    /// All figures, in the order of the page.
    pub fn figures(&self) -> impl Iterator<Item = &RenderedFigure> {
        self.sections.iter().flat_map(|section| &section.blocks).filter_map(|block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        })
    }

    /// The figures for a sheet as files: name with extension, content. On paper, each is an SVG and a PDF.
    ///
    /// # Errors
    /// [`DocumentError::DuplicateFigure`] where two figures have one name.
    pub fn files(&self, sheet: Sheet) -> Result<Vec<(String, Vec<u8>)>, DocumentError> {
        self.check_names()?;
        let mut files = Vec::new();
        for figure in self.figures() {
            let drawing = match sheet {
                Sheet::Screen => {
                    files.push((format!("{}.svg", figure.name), figure.svg.clone().into_bytes()));
                    continue;
                }
                Sheet::Column => &figure.papers[0],
                Sheet::Page => &figure.papers[1],
            };
            files.extend(drawing.files()?);
        }
        Ok(files)
    }

    /// Whether every figure has a name of its own.
    pub(super) fn check_names(&self) -> Result<(), DocumentError> {
        let mut names: Vec<&str> = self.figures().map(|figure| figure.name.as_str()).collect();
        names.sort_unstable();
        match names.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(DocumentError::DuplicateFigure { name: pair[0].to_owned() }),
            None => Ok(()),
        }
    }
}
