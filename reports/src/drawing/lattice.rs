//! Panels with two axes each, in rows and columns, with aligned plot areas.

use super::axis::{Axis, Span};
use super::canvas::{Align, Canvas, Ink, Rect};
use super::colour::Colour;
use super::head::{Entry, Head, MARGIN, width_on};
use super::sheet::Sheet;
use super::ticks::{Tick, minor_ticks, ticks};
use super::typeface::Font;
use crate::heading::Heading;

/// What is known about a panel before it has a place.
pub(crate) struct Panel<'a> {
    pub(crate) title: &'a str,
    pub(crate) x: &'a Axis,
    pub(crate) y: &'a Axis,
    pub(crate) x_span: Span,
    pub(crate) y_span: Span,
}

/// How panels are arranged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrangement {
    /// Panels in a row.
    pub(crate) columns: usize,
    /// Height of a plot area, px.
    pub(crate) plot_height: f64,
    /// All panels have one x span: numbers stand under the lowest of each column only.
    pub(crate) share_x: bool,
    /// All panels have one y span: numbers stand beside the leftmost of each row only.
    pub(crate) share_y: bool,
    /// What they are drawn on. A column of a journal has one panel in a row.
    pub(crate) sheet: Sheet,
}

/// A plot area with its spans.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plot {
    pub(crate) area: Rect,
    pub(crate) x: Span,
    pub(crate) y: Span,
}

impl Plot {
    pub(crate) fn x_at(&self, value: f64) -> f64 {
        self.area.left + self.x.fraction(value) * self.area.width()
    }

    pub(crate) fn y_at(&self, value: f64) -> f64 {
        self.area.bottom - self.y.fraction(value) * self.area.height()
    }

    pub(crate) fn xy(&self, x: f64, y: f64) -> (f64, f64) {
        (self.x_at(x), self.y_at(y))
    }

    /// A full-width stroke at `value` of the y axis.
    pub(crate) fn horizontal(&self, value: f64) -> [(f64, f64); 2] {
        let y = self.y_at(value);
        [(self.area.left, y), (self.area.right, y)]
    }

    /// A full-height stroke at `value` of the x axis.
    pub(crate) fn vertical(&self, value: f64) -> [(f64, f64); 2] {
        let x = self.x_at(value);
        [(x, self.area.top), (x, self.area.bottom)]
    }
}

const TICK: f64 = 4.0;
const X_GAP: f64 = 12.0;
const Y_GAP: f64 = 8.0;

/// Ticks of an x axis `length` px long.
pub(crate) fn x_ticks(span: &Span, length: f64) -> Vec<Tick> {
    ticks(span, length, X_GAP, |label| Font::TICK.width(label).max(28.0))
}

/// Ticks of a y axis `length` px long.
pub(crate) fn y_ticks(span: &Span, length: f64) -> Vec<Tick> {
    ticks(span, length, Y_GAP, |_| Font::TICK.size * 1.3)
}

/// Width to reserve for the numbers of a y axis, px.
pub(crate) fn widest(ticks: &[Tick]) -> f64 {
    ticks.iter().map(|tick| Font::TICK.width(&tick.label)).fold(0.0, f64::max)
}

/// Draws head, frames, grid lines, numbers and labels of all panels; the data are for the caller to draw on the plots.
pub(crate) fn lattice(
    heading: &Heading,
    legend: &[Entry],
    panels: &[Panel<'_>],
    arrangement: Arrangement,
) -> (Canvas, Vec<Plot>) {
    let head = Head::new(heading, legend, arrangement.sheet);
    let width = width_on(arrangement.sheet);
    let columns = arrangement.sheet.panels(arrangement.columns.clamp(1, panels.len().max(1)), 1);
    let plot_height = arrangement.plot_height.min(0.62 * width);
    let rows = panels.len().div_ceil(columns);
    let one_x_label = panels.windows(2).all(|pair| pair[0].x.text() == pair[1].x.text());
    let one_y_label = panels.windows(2).all(|pair| pair[0].y.text() == pair[1].y.text());
    let lowest = |index: usize| index + columns >= panels.len();
    let leftmost = |index: usize| index.is_multiple_of(columns);
    let numbers_x = |index: usize| !arrangement.share_x || lowest(index);
    let numbers_y = |index: usize| !arrangement.share_y || leftmost(index);
    let label_x = |index: usize| !one_x_label || lowest(index);
    let label_y = |index: usize| !one_y_label || leftmost(index);

    let all_y_ticks: Vec<Vec<Tick>> = panels.iter().map(|panel| y_ticks(&panel.y_span, plot_height)).collect();
    let mut lefts = vec![0.0_f64; columns];
    let (mut tops, mut bottoms) = (vec![0.0_f64; rows], vec![0.0_f64; rows]);
    for (index, panel) in panels.iter().enumerate() {
        let left = if numbers_y(index) { widest(&all_y_ticks[index]) + TICK + 6.0 } else { 6.0 }
            + if label_y(index) { 22.0 } else { 0.0 };
        let bottom = if numbers_x(index) { 22.0 } else { 8.0 } + if label_x(index) { 21.0 } else { 0.0 };
        let (row, column) = (index / columns, index % columns);
        lefts[column] = lefts[column].max(left);
        bottoms[row] = bottoms[row].max(bottom);
        tops[row] = tops[row].max(if panel.title.trim().is_empty() { 10.0 } else { 26.0 });
    }
    let (gap, right_edge) = (26.0, 26.0);
    let free = width - MARGIN - right_edge - lefts.iter().sum::<f64>() - gap * (columns - 1) as f64;
    let plot_width = (free / columns as f64).max(40.0);
    let inner: f64 = tops.iter().sum::<f64>() + bottoms.iter().sum::<f64>() + plot_height * rows as f64;
    let mut canvas = Canvas::new(width, head.height + inner + 8.0);
    head.draw(&mut canvas);

    let mut plots = Vec::with_capacity(panels.len());
    let mut top = head.height;
    for row in 0..rows {
        top += tops[row];
        let mut left = MARGIN;
        for column in 0..columns {
            left += lefts[column];
            let index = row * columns + column;
            if let Some(panel) = panels.get(index) {
                let area = Rect { left, top, right: left + plot_width, bottom: top + plot_height };
                let plot = Plot { area, x: panel.x_span, y: panel.y_span };
                grid(
                    &mut canvas,
                    &plot,
                    &x_ticks(&plot.x, plot_width),
                    &all_y_ticks[index],
                    (numbers_x(index), numbers_y(index)),
                );
                let title = Font::PANEL.fit(panel.title, plot_width);
                canvas.text(&title, (left, top - 12.0), Font::PANEL, Colour::TEXT, Align::Start);
                if label_x(index) {
                    let text = Font::LABEL.fit(&panel.x.text(), plot_width + 20.0);
                    let y = area.bottom + if numbers_x(index) { 34.0 } else { 16.0 };
                    canvas.text(&text, (area.centre().0, y), Font::LABEL, Colour::TEXT, Align::Middle);
                }
                if label_y(index) {
                    let text = Font::LABEL.fit(&panel.y.text(), plot_height + 24.0);
                    let x = left - lefts[column] + 8.0;
                    canvas.text_upwards(&text, (x, area.centre().1), Font::LABEL, Colour::TEXT, Align::Middle);
                }
                plots.push(plot);
            }
            left += plot_width + gap;
        }
        top += plot_height + bottoms[row];
    }
    (canvas, plots)
}

/// Grid lines, frame, tick marks, and the numbers where they are wanted (along x, along y).
fn grid(canvas: &mut Canvas, plot: &Plot, x_ticks: &[Tick], y_ticks: &[Tick], numbers: (bool, bool)) {
    let area = &plot.area;
    for tick in y_ticks {
        canvas.polyline(&plot.horizontal(tick.value), Ink::new(Colour::GRID, 0.8));
    }
    for tick in x_ticks {
        canvas.polyline(&plot.vertical(tick.value), Ink::new(Colour::GRID, 0.8));
    }
    let mark = Ink::new(Colour::FRAME, 0.9);
    for (value, length) in minor_ticks(&plot.x)
        .into_iter()
        .map(|value| (value, 0.55 * TICK))
        .chain(x_ticks.iter().map(|tick| (tick.value, TICK)))
    {
        let x = plot.x_at(value);
        canvas.line((x, area.bottom), (x, area.bottom + length), mark);
    }
    for (value, length) in minor_ticks(&plot.y)
        .into_iter()
        .map(|value| (value, 0.55 * TICK))
        .chain(y_ticks.iter().map(|tick| (tick.value, TICK)))
    {
        let y = plot.y_at(value);
        canvas.line((area.left - length, y), (area.left, y), mark);
    }
    canvas.polyline(
        &[(area.left, area.top), (area.left, area.bottom), (area.right, area.bottom)],
        Ink::new(Colour::FRAME, 1.1),
    );
    if numbers.0 {
        for tick in x_ticks {
            let half = 0.5 * Font::TICK.width(&tick.label);
            let x = plot.x_at(tick.value).clamp(half + 2.0, (canvas.width() - half - 2.0).max(half + 2.0));
            canvas.text(&tick.label, (x, area.bottom + 14.0), Font::TICK, Colour::TEXT, Align::Middle);
        }
    }
    if numbers.1 {
        for tick in y_ticks {
            let at = (area.left - TICK - 3.0, plot.y_at(tick.value));
            canvas.text(&tick.label, at, Font::TICK, Colour::TEXT, Align::End);
        }
    }
}
