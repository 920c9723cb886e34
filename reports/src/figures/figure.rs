//! What all figures have in common.

use crate::FigureError;
use crate::drawing::drawn::Drawing;
use crate::drawing::sheet::Sheet;
use crate::heading::Heading;

/// A figure that can be drawn.
pub trait Figure {
    /// Name, title, subtitle, caption.
    fn heading(&self) -> &Heading;

    /// The figure on a sheet; equal input gives equal drawings.
    ///
    /// # Errors
    /// [`FigureError`] where the input holds nothing to draw, numbers that are not finite or cannot stand on a
    /// logarithmic axis, lists that differ in length, or ranges that run backwards.
    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError>;

    /// The figure for a screen as one SVG element; equal input gives equal bytes.
    ///
    /// # Errors
    /// [`FigureError`] as of [`Figure::draw`].
    fn svg(&self) -> Result<String, FigureError> {
        self.draw(Sheet::Screen)?.svg()
    }

    /// Stem of the figure's file name.
    fn name(&self) -> &str {
        &self.heading().name
    }

    /// What one sees.
    fn title(&self) -> &str {
        &self.heading().title
    }

    /// What each mark means.
    fn caption(&self) -> &str {
        &self.heading().caption
    }
}
