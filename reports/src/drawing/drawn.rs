//! A figure that has a place for each of its shapes.

use super::canvas::Canvas;
use super::pdf;
use super::sheet::Sheet;
use crate::FigureError;
use crate::heading::Heading;

/// A figure with a place for each of its shapes, to be written as SVG or PDF.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub(super) canvas: Canvas,
    pub(super) heading: Heading,
    pub(super) sheet: Sheet,
}

impl Drawing {
    /// These shapes with their heading, on the sheet whose width they have.
    pub(crate) fn new(canvas: Canvas, heading: &Heading, sheet: Sheet) -> Self {
        Self { canvas, heading: heading.clone(), sheet }
    }

    /// One SVG element; equal drawings give equal bytes.
    ///
    /// # Errors
    /// [`FigureError::Backend`] if the writer refuses a shape.
    pub fn svg(&self) -> Result<String, FigureError> {
        self.canvas.svg(&self.heading, self.sheet)
    }

    /// The drawing as files, name with extension and content: SVG, and PDF beside it on paper.
    ///
    /// # Errors
    /// [`FigureError::Backend`] if the writer refuses a shape.
    pub fn files(&self) -> Result<Vec<(String, Vec<u8>)>, FigureError> {
        let name = &self.heading.name;
        let mut files = vec![(format!("{name}.svg"), self.svg()?.into_bytes())];
        if self.sheet != Sheet::Screen {
            files.push((format!("{name}.pdf"), self.pdf()));
        }
        Ok(files)
    }

    /// One page of PDF 1.4 as large as the figure, text as text. It names the fonts Helvetica and Symbol, which every reader has,
    /// and embeds none.
    pub fn pdf(&self) -> Vec<u8> {
        pdf::page(&self.canvas, &self.heading, self.sheet)
    }
}
