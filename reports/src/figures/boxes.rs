//! Box plots and strips of points: the spread of something per row and group.

use super::Figure;
use crate::FigureError;
use crate::drawing::axis::{Axis, Span};
use crate::drawing::canvas::{Ink, Rect};
use crate::drawing::check::Check;
use crate::drawing::colour::Colour;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::{self, Swatch};
use crate::drawing::rows::{Background, Level, Rows};
use crate::drawing::sheet::Sheet;
use crate::drawing::ticks::significant;
use crate::heading::Heading;
use crate::style::Group;

/// Rows of boxes, strips of points, or both.
///
/// ```
/// use armid_reports::{Axis, BoxFigure, BoxRow, Distribution, Figure, Group, Heading, Quantiles};
/// let figure = BoxFigure {
///     heading: Heading::new("errors", "D-optimal designs spread less"),
///     value: Axis::log("RMSE", "N·m"),
///     whiskers: "5 % to 95 %".into(),
///     groups: Group::assign(["condition"]),
///     rows: vec![BoxRow {
///         label: "torque".into(),
///         cells: vec![Some(Distribution::from_quantiles(Quantiles { low: 0.1, q1: 0.2, median: 0.25, q3: 0.3, high: 0.5 }))],
///     }],
///     levels: vec![],
/// };
/// assert!(figure.svg().unwrap().contains("5 % to 95 %"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BoxFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// The axis of the values.
    pub value: Axis,
    /// What the whiskers reach, written in the legend: "5 % to 95 %", "minimum to maximum"; may be empty.
    pub whiskers: String,
    /// The groups, at most 8.
    pub groups: Vec<Group>,
    /// The rows, at most 120; more than 20 stand in two columns.
    pub rows: Vec<BoxRow>,
    /// Values to compare with.
    pub levels: Vec<Level>,
}

/// One row of boxes.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxRow {
    /// Name of the row: a parameter, a metric, a joint.
    pub label: String,
    /// One distribution per group; `None` where a group has none.
    pub cells: Vec<Option<Distribution>>,
}

/// A spread, as quantiles, as points, or both.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distribution {
    /// Drawn as a box with whiskers.
    pub quantiles: Option<Quantiles>,
    /// Drawn as a strip of points; at most 2000.
    pub points: Vec<f64>,
}

impl Distribution {
    /// A box without points.
    pub fn from_quantiles(quantiles: Quantiles) -> Self {
        Self { quantiles: Some(quantiles), points: Vec::new() }
    }

    fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.quantiles.into_iter().flat_map(Quantiles::ascending).chain(self.points.iter().copied())
    }
}

/// Five ascending numbers of a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantiles {
    /// End of the lower whisker.
    pub low: f64,
    /// First quartile.
    pub q1: f64,
    /// Median.
    pub median: f64,
    /// Third quartile.
    pub q3: f64,
    /// End of the upper whisker.
    pub high: f64,
}

impl Quantiles {
    fn ascending(self) -> [f64; 5] {
        [self.low, self.q1, self.median, self.q3, self.high]
    }
}

impl BoxFigure {
    fn check(&self) -> Result<Span, FigureError> {
        let check = Check::heading(&self.heading)?;
        let scale = self.value.scale;
        check.axis("the value axis", &self.value)?;
        check.count("the list of groups", self.groups.len(), 8)?;
        check.count("the list of rows", self.rows.len(), 120)?;
        for row in &self.rows {
            check.length(&format!("row \"{}\"", row.label), row.cells.len(), self.groups.len())?;
            for (cell, group) in row.cells.iter().zip(&self.groups) {
                let Some(cell) = cell else { continue };
                let name = format!("row \"{}\" in group \"{}\"", row.label, group.label);
                if let Some(quantiles) = cell.quantiles {
                    check.all_on_axis(&format!("quantiles of {name}"), &quantiles.ascending(), scale)?;
                    check.ascending(&format!("quantiles of {name}"), &quantiles.ascending())?;
                } else if cell.points.is_empty() {
                    return Err(check.empty(&name));
                }
                if !cell.points.is_empty() {
                    check.count(&format!("the list of points of {name}"), cell.points.len(), 2000)?;
                }
                check.all_on_axis(&format!("points of {name}"), &cell.points, scale)?;
            }
        }
        check.background(&self.background(), scale)?;
        let mut cells = self.rows.iter().flat_map(|row| row.cells.iter().flatten()).peekable();
        if cells.peek().is_none() {
            return Err(check.empty("every distribution"));
        }
        let others = self.levels.iter().map(|level| level.value).chain(self.value.include.iter().copied());
        Span::covering(scale, cells.flat_map(Distribution::values).chain(others), 0.04)
            .ok_or_else(|| check.empty("every distribution"))
    }

    fn background(&self) -> Background<'_> {
        Background { levels: &self.levels, band: None }
    }
}

/// Draws one distribution around `y`, in a lane `lane_px` high: the box, the points upon it, the median upon them.
fn draw(rows: &mut Rows, cell: &Distribution, (group, name): (&Group, &str), (area, y, lane_px): (usize, f64, f64)) {
    let colour = group.style.colour;
    let half = (0.36 * lane_px).min(8.0);
    if let Some(quantiles) = cell.quantiles {
        let [low, q1, _, q3, high] = quantiles.ascending().map(|value| rows.x(area, value));
        let ink = Ink::new(colour, 1.2);
        for (from, to) in [(low, q1), (q3, high)] {
            rows.canvas.line((from, y), (to, y), ink);
        }
        for end in [low, high] {
            rows.canvas.line((end, y - 0.55 * half), (end, y + 0.55 * half), ink);
        }
        let case = Rect { left: q1, top: y - half, right: q3, bottom: y + half };
        let [lowest, lower, median, upper, highest] = quantiles.ascending().map(|value| significant(value, 4));
        let text = format!("{name}: median {median}, quartiles {lower}, {upper}, whiskers {lowest}, {highest}");
        rows.canvas.hover(&text, |canvas| {
            canvas.rectangle(&case, Ink::new(Colour::WHITE, 0.0));
            canvas.rectangle(&case, Ink::new(colour, 0.0).faint(0.25));
            canvas.outline(&case, ink);
        });
    }
    let few = cell.points.len() <= 60;
    for (index, &value) in cell.points.iter().enumerate() {
        // Neighbours in the list alternate between five levels so that equal values stay apart.
        let shift = [0.0, 0.5, -0.5, 0.25, -0.25][index % 5] * half * 1.3;
        let (radius, opacity) = if few { (2.5, 0.8) } else { (1.8, 0.5) };
        rows.canvas.marker(group.style.marker, (rows.x(area, value), y + shift), radius, colour, opacity);
    }
    if let Some(quantiles) = cell.quantiles {
        let median = rows.x(area, quantiles.median);
        rows.canvas.line((median, y - half), (median, y + half), Ink::new(Colour::TEXT, 2.0));
        if cell.points.is_empty() {
            rows.canvas.marker(group.style.marker, (median, y), 2.9, colour, 1.0);
        }
    }
}

impl Figure for BoxFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        let span = self.check()?;
        let mut legend = Vec::new();
        let cells = || self.rows.iter().flat_map(|row| row.cells.iter().flatten());
        let boxes = cells().any(|cell| cell.quantiles.is_some());
        for group in &self.groups {
            head::add(
                &mut legend,
                &group.label,
                if boxes { Swatch::Box(group.style) } else { Swatch::Point(group.style) },
            );
        }
        if boxes && !self.whiskers.trim().is_empty() {
            head::add(&mut legend, &format!("whiskers: {}", self.whiskers), Swatch::Whiskers);
        }
        let background = self.background();
        background.legend(&mut legend);
        let names: Vec<&str> = self.rows.iter().map(|row| row.label.as_str()).collect();
        let count = self.rows.len() * self.groups.len();
        let lane_px = if count > 100 {
            9.0
        } else if count > 32 {
            13.0
        } else {
            20.0
        };
        let lanes = (self.groups.len(), lane_px);
        let mut rows = Rows::draw(&self.heading, &legend, &names, lanes, (&self.value, span), &background, sheet);
        for (index, row) in self.rows.iter().enumerate() {
            for (lane, (cell, group)) in row.cells.iter().zip(&self.groups).enumerate() {
                if let Some(cell) = cell {
                    let place = (rows.area_of(index), rows.y(index, lane), lane_px);
                    let name = format!("{}, {}", row.label, group.label);
                    draw(&mut rows, cell, (group, &name), place);
                }
            }
        }
        Ok(Drawing::new(rows.canvas, &self.heading, sheet))
    }
}
