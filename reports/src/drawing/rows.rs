//! Named rows with a lane per group over one common value axis, in one or two columns of rows.
//!
//! Box plots, forest plots and coverage share it: names stand at the left and never overlap, however many there are.

use super::axis::{Axis, Span};
use super::canvas::{Align, Canvas, Ink, Rect};
use super::colour::Colour;
use super::head::{self, Entry, Head, MARGIN, Swatch, width_on};
use super::lattice::x_ticks;
use super::sheet::Sheet;
use super::typeface::Font;
use crate::heading::Heading;
use crate::style::Dash;

/// A shaded range of the value axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Name in the legend; may be empty.
    pub label: String,
}

impl Band {
    /// The range from `low` to `high`.
    pub fn new(low: f64, high: f64, label: impl Into<String>) -> Self {
        Self { low, high, label: label.into() }
    }
}

/// A value to compare with, drawn across all rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// The value.
    pub value: f64,
    /// Name in the legend; may be empty.
    pub label: String,
}

impl Level {
    /// A level at `value`.
    pub fn new(value: f64, label: impl Into<String>) -> Self {
        Self { value, label: label.into() }
    }
}

/// What is drawn behind the data.
pub(crate) struct Background<'a> {
    pub(crate) levels: &'a [Level],
    pub(crate) band: Option<&'a Band>,
}

impl Background<'_> {
    /// The numbers it puts on the value axis.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let band = self.band.into_iter().flat_map(|band| [band.low, band.high]);
        self.levels.iter().map(|level| level.value).chain(band)
    }

    fn dash(index: usize) -> Dash {
        [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDot][index % 4]
    }

    /// Adds its entries to a legend.
    pub(crate) fn legend(&self, entries: &mut Vec<Entry>) {
        for (index, level) in self.levels.iter().enumerate() {
            head::add(entries, &level.label, Swatch::Reference(Self::dash(index)));
        }
        if let Some(band) = self.band {
            head::add(entries, &band.label, Swatch::Band);
        }
    }
}

/// Rows with places for the data.
pub(crate) struct Rows {
    pub(crate) canvas: Canvas,
    areas: Vec<Rect>,
    span: Span,
    lanes: usize,
    lane_px: f64,
    row_px: f64,
    rows_per_area: usize,
}

/// Rows in one column before a second column is opened.
const ONE_COLUMN: usize = 20;
/// Height from which on the numbers stand at the top as well, px.
const TALL: f64 = 480.0;
/// Widest name of a row, px.
const WIDEST_NAME: f64 = 300.0;

impl Rows {
    /// Draws head, names, frames, background and axis for rows of `lanes` lanes, each `lane_px` high.
    pub(crate) fn draw(
        heading: &Heading,
        legend: &[Entry],
        names: &[&str],
        (lanes, lane_px): (usize, f64),
        (axis, span): (&Axis, Span),
        background: &Background<'_>,
        sheet: Sheet,
    ) -> Self {
        let whole = width_on(sheet);
        let columns = sheet.panels(if names.len() > ONE_COLUMN { 2 } else { 1 }, 1);
        let rows_per_area = names.len().div_ceil(columns);
        let row_px = (lanes as f64 * lane_px + 8.0).max(21.0);
        let head = Head::new(heading, legend, sheet);
        let name_room = WIDEST_NAME / columns as f64 + 20.0 * (2 - columns) as f64;
        let widest =
            names.iter().map(|name| Font::TICK.width(name)).fold(0.0, f64::max).min(name_room).min(0.4 * whole);
        let (gap, right_edge) = (22.0, 26.0);
        let outer = MARGIN + right_edge + gap * (columns - 1) as f64;
        let width = (whole - outer) / columns as f64 - widest - 10.0;
        let tall = rows_per_area as f64 * row_px > TALL;
        let top = head.height + if tall { 26.0 } else { 6.0 };
        let bottom = top + rows_per_area as f64 * row_px;
        let mut canvas = Canvas::new(whole, bottom + 54.0);
        head.draw(&mut canvas);
        let areas: Vec<Rect> = (0..columns)
            .map(|column| {
                let left = MARGIN + widest + 10.0 + column as f64 * (width + widest + 10.0 + gap);
                let rows = rows_per_area.min(names.len() - column * rows_per_area);
                Rect { left, top, right: left + width, bottom: top + rows as f64 * row_px }
            })
            .collect();
        let mut rows = Self { canvas, areas, span, lanes, lane_px, row_px, rows_per_area };
        rows.behind(names, widest, background);
        rows.axis(axis, tall);
        rows
    }

    /// Names, stripes, grid, band and levels.
    fn behind(&mut self, names: &[&str], widest: f64, background: &Background<'_>) {
        for (index, name) in names.iter().enumerate() {
            let area = self.areas[index / self.rows_per_area];
            let top = area.top + (index % self.rows_per_area) as f64 * self.row_px;
            if index % self.rows_per_area % 2 == 1 {
                let stripe =
                    Rect { left: area.left - widest - 10.0, top, right: area.right, bottom: top + self.row_px };
                self.canvas.rectangle(&stripe, Ink::new(Colour::STRIPE, 0.0));
            }
            let name = Font::TICK.fit(name, widest);
            let at = (area.left - 8.0, top + 0.5 * self.row_px);
            self.canvas.text(&name, at, Font::TICK, Colour::TEXT, Align::End);
        }
        for index in 0..self.areas.len() {
            let area = self.areas[index];
            if let Some(band) = background.band {
                let shaded = Rect { left: self.x(index, band.low), right: self.x(index, band.high), ..area };
                self.canvas.rectangle(&shaded, Ink::new(Colour::BAND, 0.0));
            }
            for tick in x_ticks(&self.span, area.width()) {
                let x = self.x(index, tick.value);
                self.canvas.line((x, area.top), (x, area.bottom), Ink::new(Colour::GRID, 0.8));
            }
            for (number, level) in background.levels.iter().enumerate() {
                let x = self.x(index, level.value);
                let points = [(x, area.top), (x, area.bottom)];
                self.canvas.dashed(&points, Background::dash(number).pattern(), Ink::new(Colour::MUTED, 1.1));
            }
        }
    }

    /// Frame, marks, numbers (at the top too where `both_ends`), label.
    fn axis(&mut self, axis: &Axis, both_ends: bool) {
        let mark = Ink::new(Colour::FRAME, 0.9);
        for index in 0..self.areas.len() {
            let area = self.areas[index];
            let corners = [(area.left, area.top), (area.left, area.bottom), (area.right, area.bottom)];
            self.canvas.polyline(&corners, Ink::new(Colour::FRAME, 1.1));
            for value in super::ticks::minor_ticks(&self.span) {
                let x = self.x(index, value);
                self.canvas.line((x, area.bottom), (x, area.bottom + 2.2), mark);
            }
            for tick in x_ticks(&self.span, area.width()) {
                let x = self.x(index, tick.value);
                self.canvas.line((x, area.bottom), (x, area.bottom + 4.0), mark);
                let half = 0.5 * Font::TICK.width(&tick.label);
                let x = x.clamp(half + 2.0, (self.canvas.width() - half - 2.0).max(half + 2.0));
                self.canvas.text(&tick.label, (x, area.bottom + 14.0), Font::TICK, Colour::TEXT, Align::Middle);
                if both_ends {
                    self.canvas.text(&tick.label, (x, area.top - 10.0), Font::TICK, Colour::TEXT, Align::Middle);
                }
            }
            let label = Font::LABEL.fit(&axis.text(), area.width() + 60.0);
            let at = (area.centre().0, area.bottom + 35.0);
            self.canvas.text(&label, at, Font::LABEL, Colour::TEXT, Align::Middle);
        }
    }

    /// Column of rows that holds `row`.
    pub(crate) fn area_of(&self, row: usize) -> usize {
        row / self.rows_per_area
    }

    /// Place of `value` in a column of rows.
    pub(crate) fn x(&self, area: usize, value: f64) -> f64 {
        let rect = &self.areas[area];
        rect.left + self.span.fraction(value) * rect.width()
    }

    /// Middle of a row's lane.
    pub(crate) fn y(&self, row: usize, lane: usize) -> f64 {
        let middle = self.areas[self.area_of(row)].top + ((row % self.rows_per_area) as f64 + 0.5) * self.row_px;
        middle + (lane as f64 - 0.5 * (self.lanes - 1) as f64) * self.lane_px
    }
}
