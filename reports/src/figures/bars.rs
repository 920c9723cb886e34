//! Bars from zero, per row and group: shares, counts, anything whose length is the message.

use super::Figure;
use crate::FigureError;
use crate::drawing::axis::{Axis, Scale, Span};
use crate::drawing::canvas::{Align, Ink, Rect};
use crate::drawing::check::Check;
use crate::drawing::colour::Colour;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::{self, Swatch};
use crate::drawing::rows::{Background, Level, Rows};
use crate::drawing::sheet::Sheet;
use crate::drawing::ticks::{compact, significant};
use crate::drawing::typeface::Font;
use crate::heading::Heading;
use crate::style::Group;

/// Rows of bars.
///
/// ```
/// use armid_reports::{Axis, Bar, BarFigure, BarRow, Figure, Group, Heading, Level};
/// let figure = BarFigure {
///     heading: Heading::new("limit-use", "Torque is the binding limit"),
///     value: Axis::linear("share of the limit", "%"),
///     groups: Group::assign(["d-optimal"]),
///     rows: vec![BarRow { label: "torque".into(), bars: vec![Some(Bar::new(98.0))] }],
///     levels: vec![Level::new(100.0, "limit")],
///     digits: Some(0),
/// };
/// assert!(figure.svg().unwrap().contains("98"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BarFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// The axis of the bars; always linear, since a bar begins at zero.
    pub value: Axis,
    /// The groups, at most 8.
    pub groups: Vec<Group>,
    /// The rows, at most 120; more than 20 stand in two columns.
    pub rows: Vec<BarRow>,
    /// Values to compare with.
    pub levels: Vec<Level>,
    /// Digits after the point of the numbers written beside the bars; `None` writes no numbers.
    pub digits: Option<usize>,
}

/// One row of bars.
#[derive(Clone, Debug, PartialEq)]
pub struct BarRow {
    /// Name of the row.
    pub label: String,
    /// One bar per group; `None` where a group has none.
    pub bars: Vec<Option<Bar>>,
}

/// A bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Where the bar ends.
    pub value: f64,
    /// Ends of an error bar, `low ≤ value ≤ high`.
    pub interval: Option<(f64, f64)>,
}

impl Bar {
    /// A bar from zero to `value`.
    pub fn new(value: f64) -> Self {
        Self { value, interval: None }
    }

    /// Returns this bar with an error bar from `low` to `high`.
    #[must_use]
    pub fn interval(self, low: f64, high: f64) -> Self {
        Self { interval: Some((low, high)), ..self }
    }

    fn ends(self) -> [f64; 3] {
        let (low, high) = self.interval.unwrap_or((self.value, self.value));
        [low, self.value, high]
    }
}

impl BarFigure {
    fn check(&self, sheet: Sheet) -> Result<Span, FigureError> {
        let check = Check::heading(&self.heading)?;
        check.axis("the value axis", &Axis { scale: Scale::Linear, ..self.value.clone() })?;
        check.count("the list of groups", self.groups.len(), 8)?;
        check.count("the list of rows", self.rows.len(), 120)?;
        for row in &self.rows {
            check.length(&format!("row \"{}\"", row.label), row.bars.len(), self.groups.len())?;
            for (bar, group) in row.bars.iter().zip(&self.groups) {
                if let Some(bar) = bar {
                    let name = format!("bar of row \"{}\" in group \"{}\"", row.label, group.label);
                    check.all_on_axis(&name, &bar.ends(), Scale::Linear)?;
                    check.ascending(&name, &bar.ends())?;
                }
            }
        }
        check.background(&self.background(), Scale::Linear)?;
        let bars = || self.rows.iter().flat_map(|row| row.bars.iter().flatten());
        if bars().next().is_none() {
            return Err(check.empty("every bar"));
        }
        let others = self.levels.iter().map(|level| level.value).chain(self.value.include.iter().copied());
        let values = bars().flat_map(|bar| bar.ends()).chain(others).chain([0.0]);
        let span = Span::covering(Scale::Linear, values, 0.02).ok_or_else(|| check.empty("every bar"))?;
        // The numbers stand beyond the ends of the bars.
        let widest = self.digits.map_or(0.0, |digits| {
            bars().map(|bar| Font::NOTE.width(&compact(bar.value, digits))).fold(0.0, f64::max) + 10.0
        });
        let (below, above) = (bars().any(|bar| bar.value < 0.0), bars().any(|bar| bar.value >= 0.0));
        let room = |wanted: bool| if wanted { widest } else { 0.0 };
        let share = if self.rows.len() > 20 && sheet != Sheet::Column { 340.0 / 900.0 } else { 600.0 / 900.0 };
        Ok(span.with_room(room(below), room(above), share * head::width_on(sheet)))
    }

    fn background(&self) -> Background<'_> {
        Background { levels: &self.levels, band: None }
    }
}

impl Figure for BarFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        let span = self.check(sheet)?;
        let mut legend = Vec::new();
        if self.groups.len() > 1 {
            for group in &self.groups {
                head::add(&mut legend, &group.label, Swatch::Bar(group.style));
            }
        }
        let background = self.background();
        background.legend(&mut legend);
        let names: Vec<&str> = self.rows.iter().map(|row| row.label.as_str()).collect();
        let lane_px = if self.rows.len() * self.groups.len() > 40 { 13.0 } else { 17.0 };
        let lanes = (self.groups.len(), lane_px);
        let mut rows = Rows::draw(&self.heading, &legend, &names, lanes, (&self.value, span), &background, sheet);
        for (index, row) in self.rows.iter().enumerate() {
            for (lane, (bar, group)) in row.bars.iter().zip(&self.groups).enumerate() {
                let Some(bar) = bar else { continue };
                let (area, y) = (rows.area_of(index), rows.y(index, lane));
                let [low, end, high] = bar.ends().map(|value| rows.x(area, value));
                let (zero, half) = (rows.x(area, 0.0), 0.4 * lane_px);
                let case = Rect { left: zero.min(end), top: y - half, right: zero.max(end), bottom: y + half };
                let text = format!("{}, {}: {}", row.label, group.label, significant(bar.value, 4));
                rows.canvas.hover(&text, |canvas| {
                    canvas.rectangle(&case, Ink::new(group.style.colour, 0.0).faint(0.75));
                    canvas.outline(&case, Ink::new(group.style.colour, 1.0));
                });
                // The marker distinguishes groups without colour.
                let inside = if bar.value < 0.0 { zero - 9.0 } else { zero + 9.0 };
                if case.width() > 18.0 && self.groups.len() > 1 {
                    rows.canvas.marker(group.style.marker, (inside, y), 3.0, Colour::WHITE, 1.0);
                }
                if bar.interval.is_some() {
                    rows.canvas.line((low, y), (high, y), Ink::new(Colour::TEXT, 1.2));
                    for place in [low, high] {
                        rows.canvas.line((place, y - 3.0), (place, y + 3.0), Ink::new(Colour::TEXT, 1.2));
                    }
                }
                if let Some(digits) = self.digits {
                    let text = compact(bar.value, digits);
                    // A level's line that would cross the number pushes it outwards.
                    let side = if bar.value < 0.0 { -1.0 } else { 1.0 };
                    let mut x = if bar.value < 0.0 { low } else { high } + 5.0 * side;
                    for level in &self.levels {
                        let line = (rows.x(area, level.value) - x) * side;
                        if line > -3.0 && line < Font::NOTE.width(&text) + 2.0 {
                            x += (line + 4.0) * side;
                        }
                    }
                    let align = if bar.value < 0.0 { Align::End } else { Align::Start };
                    rows.canvas.text(&text, (x, y), Font::NOTE, Colour::TEXT, align);
                }
            }
        }
        Ok(Drawing::new(rows.canvas, &self.heading, sheet))
    }
}
