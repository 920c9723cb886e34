//! Title, line under the title, and legend: everything above the data.

use super::canvas::{Align, Canvas, Ink, Rect};
use super::colour::Colour;
use super::sheet::Sheet;
use super::typeface::Font;
use crate::heading::Heading;
use crate::style::{Dash, GroupStyle};

/// Width of most figures on a screen, px.
const WIDTH: f64 = 900.0;
/// Width of a figure on a sheet, px.
pub(crate) fn width_on(sheet: Sheet) -> f64 {
    sheet.width(WIDTH, Font::TICK.size)
}

/// Space left free at the left and right edge, px.
pub(crate) const MARGIN: f64 = 12.0;

const SWATCH: f64 = 30.0;
const ROW: f64 = 21.0;
const GAP: f64 = 24.0;

/// What a legend shows beside a label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Swatch {
    /// A line in a group's style.
    Line(GroupStyle),
    /// A point in a group's style.
    Point(GroupStyle),
    /// A line that ends in a point.
    LinePoint(GroupStyle),
    /// A level stroke through a point.
    Interval(GroupStyle),
    /// A piece of a bar.
    Bar(GroupStyle),
    /// A thin line with two ends.
    Whiskers,
    /// A box with its median.
    Box(GroupStyle),
    /// A straight line that belongs to no group.
    Reference(Dash),
    /// A shaded range.
    Band,
}

/// A label of the legend with its swatch.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) label: String,
    pub(crate) swatch: Swatch,
}

impl Entry {
    pub(crate) fn new(label: &str, swatch: Swatch) -> Self {
        Self { label: label.to_owned(), swatch }
    }
}

/// Adds an entry unless its label is empty or there already.
pub(crate) fn add(entries: &mut Vec<Entry>, label: &str, swatch: Swatch) {
    if !label.trim().is_empty() && entries.iter().all(|entry| entry.label != label) {
        entries.push(Entry::new(label, swatch));
    }
}

/// Title, subtitle and legend, broken into lines.
pub(crate) struct Head {
    title: Vec<String>,
    subtitle: Vec<String>,
    legend: Vec<Vec<Entry>>,
    pub(crate) height: f64,
}

impl Head {
    pub(crate) fn new(heading: &Heading, entries: &[Entry], sheet: Sheet) -> Self {
        let room = width_on(sheet) - 2.0 * MARGIN;
        let title = Font::TITLE.wrap(&heading.title, room, 3);
        let subtitle = Font::SUBTITLE.wrap(&heading.subtitle, room, 3);
        let mut legend: Vec<Vec<Entry>> = Vec::new();
        let mut used = f64::INFINITY;
        for entry in entries {
            let label = Font::LABEL.fit(&entry.label, room - SWATCH - GAP);
            let width = SWATCH + 7.0 + Font::LABEL.width(&label) + GAP;
            if used + width - GAP > room {
                legend.push(Vec::new());
                used = 0.0;
            }
            used += width;
            if let Some(row) = legend.last_mut() {
                row.push(Entry { label, swatch: entry.swatch });
            }
        }
        let height = 10.0
            + title.len() as f64 * 23.0
            + subtitle.len() as f64 * 18.0
            + if legend.is_empty() { 4.0 } else { 8.0 + legend.len() as f64 * ROW };
        Self { title, subtitle, legend, height }
    }

    pub(crate) fn draw(&self, canvas: &mut Canvas) {
        let mut top = 10.0;
        for line in &self.title {
            canvas.text(line, (MARGIN, top + 11.0), Font::TITLE, Colour::TEXT, Align::Start);
            top += 23.0;
        }
        for line in &self.subtitle {
            canvas.text(line, (MARGIN, top + 8.0), Font::SUBTITLE, Colour::MUTED, Align::Start);
            top += 18.0;
        }
        top += 8.0;
        for row in &self.legend {
            let mut left = MARGIN;
            let middle = top + 0.5 * ROW;
            for entry in row {
                swatch(canvas, entry.swatch, left, middle);
                canvas.text(&entry.label, (left + SWATCH + 7.0, middle), Font::LABEL, Colour::TEXT, Align::Start);
                left += SWATCH + 7.0 + Font::LABEL.width(&entry.label) + GAP;
            }
            top += ROW;
        }
    }
}

fn swatch(canvas: &mut Canvas, swatch: Swatch, left: f64, y: f64) {
    let (right, centre) = (left + SWATCH, left + 0.5 * SWATCH);
    let stroke = |style: &GroupStyle| Ink::new(style.colour, style.width_px);
    match swatch {
        Swatch::Line(style) => canvas.dashed(&[(left, y), (right, y)], style.dash.pattern(), stroke(&style)),
        Swatch::Point(style) => canvas.marker(style.marker, (centre, y), 4.5, style.colour, 1.0),
        Swatch::LinePoint(style) => {
            canvas.dashed(&[(left, y), (right, y)], style.dash.pattern(), stroke(&style));
            canvas.marker(style.marker, (centre, y), 4.5, style.colour, 1.0);
        }
        Swatch::Interval(style) => {
            canvas.line((left, y), (right, y), Ink::new(style.colour, 1.6));
            canvas.marker(style.marker, (centre, y), 4.0, style.colour, 1.0);
        }
        Swatch::Bar(style) => {
            let case = Rect { left, top: y - 6.0, right, bottom: y + 6.0 };
            canvas.rectangle(&case, Ink::new(style.colour, 0.0).faint(0.75));
            canvas.outline(&case, Ink::new(style.colour, 1.0));
            canvas.marker(style.marker, (centre, y), 3.0, Colour::WHITE, 1.0);
        }
        Swatch::Whiskers => {
            let ink = Ink::new(Colour::MUTED, 1.2);
            canvas.line((left, y), (right, y), ink);
            for end in [left, right] {
                canvas.line((end, y - 4.0), (end, y + 4.0), ink);
            }
        }
        Swatch::Box(style) => {
            canvas.line((left, y), (right, y), Ink::new(style.colour, 1.2));
            let case = Rect { left: left + 6.0, top: y - 5.0, right: right - 6.0, bottom: y + 5.0 };
            canvas.rectangle(&case, Ink::new(Colour::WHITE, 0.0));
            canvas.rectangle(&case, Ink::new(style.colour, 0.0).faint(0.3));
            canvas.outline(&case, Ink::new(style.colour, 1.2));
            canvas.marker(style.marker, (centre, y), 3.2, style.colour, 1.0);
        }
        Swatch::Reference(dash) => {
            canvas.dashed(&[(left, y), (right, y)], dash.pattern(), Ink::new(Colour::TEXT, 1.2));
        }
        Swatch::Band => {
            let case = Rect { left, top: y - 6.0, right, bottom: y + 6.0 };
            canvas.rectangle(&case, Ink::new(Colour::BAND, 0.0));
        }
    }
}
