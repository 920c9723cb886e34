//! Title, lines under it and legend of a figure that is read at half its width, such as the first of a page.

use super::canvas::{Align, Canvas};
use super::colour::Colour;
use super::head::MARGIN;
use super::sheet::Sheet;
use super::typeface::Font;
use crate::heading::Heading;

/// Width of such a figure on a screen, px.
const WIDTH: f64 = 640.0;
const TITLE_ROW: f64 = 27.0;
const TEXT_ROW: f64 = 22.0;
const LEGEND_ROW: f64 = 24.0;

/// Title and subtitle in lines, legend in rows.
pub(crate) struct LargeHead {
    title: Vec<String>,
    subtitle: Vec<String>,
    /// Entries of the legend by number, each with its left edge.
    legend: Vec<Vec<(usize, f64)>>,
    /// Width of the figure, px.
    pub(crate) width: f64,
    /// Where what comes below begins, px.
    pub(crate) height: f64,
}

impl LargeHead {
    /// For a legend whose entries have these widths, with the gaps behind them.
    pub(crate) fn new(heading: &Heading, entries: &[f64], sheet: Sheet) -> Self {
        let width = sheet.width(WIDTH, Font::LARGE.size);
        let room = width - 2.0 * MARGIN;
        let (title, subtitle) =
            (Font::LARGE_TITLE.wrap(&heading.title, room, 3), Font::LARGE.wrap(&heading.subtitle, room, 2));
        let mut legend: Vec<Vec<(usize, f64)>> = vec![Vec::new()];
        let mut left = MARGIN;
        for (number, entry) in entries.iter().enumerate() {
            if left > MARGIN && left + entry > width {
                legend.push(Vec::new());
                left = MARGIN;
            }
            legend.last_mut().expect("a row is there").push((number, left));
            left += entry;
        }
        let lines = |of: &[String], row: f64| of.len() as f64 * row;
        let height = 16.0 + lines(&title, TITLE_ROW) + lines(&subtitle, TEXT_ROW) + legend.len() as f64 * LEGEND_ROW;
        Self { title, subtitle, legend, width, height }
    }

    /// Draws all; `entry` draws an entry of the legend from its left edge, at a height.
    pub(crate) fn draw(&self, canvas: &mut Canvas, mut entry: impl FnMut(&mut Canvas, usize, (f64, f64))) {
        let mut y = 22.0;
        for line in &self.title {
            canvas.text(line, (MARGIN, y), Font::LARGE_TITLE, Colour::TEXT, Align::Start);
            y += TITLE_ROW;
        }
        for line in &self.subtitle {
            canvas.text(line, (MARGIN, y), Font::LARGE, Colour::MUTED, Align::Start);
            y += TEXT_ROW;
        }
        y += 6.0;
        for row in &self.legend {
            for (number, left) in row {
                entry(canvas, *number, (*left, y));
            }
            y += LEGEND_ROW;
        }
    }
}
