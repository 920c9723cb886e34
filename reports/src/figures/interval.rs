//! A forest plot: a point with its interval per row and group, such as the bias of every parameter.

use super::Figure;
use crate::FigureError;
use crate::drawing::axis::{Axis, Scale, Span};
use crate::drawing::canvas::Ink;
use crate::drawing::check::Check;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::{self, Swatch};
use crate::drawing::rows::{Background, Band, Level, Rows};
use crate::drawing::sheet::Sheet;
use crate::drawing::ticks::significant;
use crate::heading::Heading;
use crate::style::Group;

/// Rows of points with intervals.
///
/// ```
/// use armid_reports::{Axis, Figure, Group, Heading, Interval, IntervalFigure, IntervalRow, Level};
/// let figure = IntervalFigure {
///     heading: Heading::new("bias", "No parameter is biased"),
///     value: Axis::linear("bias", "std"),
///     groups: Group::assign(["condition", "d-optimal"]),
///     rows: vec![IntervalRow {
///         label: "Iyy1".into(),
///         cells: vec![Some(Interval::new(0.1, -0.2, 0.4)), Some(Interval::new(0.0, -0.3, 0.3))],
///     }],
///     levels: vec![Level::new(0.0, "no bias")],
///     band: None,
/// };
/// assert!(figure.svg().unwrap().contains("Iyy1"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// The axis of points and intervals.
    pub value: Axis,
    /// The groups, at most 8.
    pub groups: Vec<Group>,
    /// The rows, at most 120; more than 20 stand in two columns.
    pub rows: Vec<IntervalRow>,
    /// Values to compare with, such as 0.
    pub levels: Vec<Level>,
    /// A range to compare with.
    pub band: Option<Band>,
}

/// One row of a forest plot.
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalRow {
    /// Name of the row, as a rule a parameter.
    pub label: String,
    /// One interval per group; `None` where a group has none.
    pub cells: Vec<Option<Interval>>,
}

/// A point with its interval, `low ≤ point ≤ high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The point.
    pub point: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Interval {
    /// A point with its interval.
    pub fn new(point: f64, low: f64, high: f64) -> Self {
        Self { point, low, high }
    }
}

impl IntervalFigure {
    fn check(&self) -> Result<Span, FigureError> {
        let check = Check::heading(&self.heading)?;
        let scale = self.value.scale;
        check.axis("the value axis", &self.value)?;
        check.count("the list of groups", self.groups.len(), 8)?;
        check.count("the list of rows", self.rows.len(), 120)?;
        for row in &self.rows {
            check.length(&format!("row \"{}\"", row.label), row.cells.len(), self.groups.len())?;
            for (cell, group) in row.cells.iter().zip(&self.groups) {
                if let Some(Interval { point, low, high }) = *cell {
                    let name = format!("interval of row \"{}\" in group \"{}\"", row.label, group.label);
                    check.all_on_axis(&name, &[low, point, high], scale)?;
                    check.ascending(&name, &[low, point, high])?;
                }
            }
        }
        check.background(&self.background(), scale)?;
        let cells = || self.rows.iter().flat_map(|row| row.cells.iter().flatten());
        if cells().next().is_none() {
            return Err(check.empty("every interval"));
        }
        let values = cells().flat_map(|cell| [cell.low, cell.point, cell.high]);
        let others =
            self.background().values().collect::<Vec<f64>>().into_iter().chain(self.value.include.iter().copied());
        Span::covering(scale, values.chain(others), 0.04).ok_or_else(|| check.empty("every interval"))
    }

    fn background(&self) -> Background<'_> {
        Background { levels: &self.levels, band: self.band.as_ref() }
    }
}

impl Figure for IntervalFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        let span = self.check()?;
        let mut legend = Vec::new();
        if self.groups.len() > 1 {
            for group in &self.groups {
                head::add(&mut legend, &group.label, Swatch::Interval(group.style));
            }
        }
        let background = self.background();
        background.legend(&mut legend);
        let names: Vec<&str> = self.rows.iter().map(|row| row.label.as_str()).collect();
        let lane_px = if self.rows.len() > 40 { 7.5 } else { 10.0 };
        let lanes = (self.groups.len(), lane_px);
        let mut rows = Rows::draw(&self.heading, &legend, &names, lanes, (&self.value, span), &background, sheet);
        for (index, row) in self.rows.iter().enumerate() {
            for (lane, (cell, group)) in row.cells.iter().zip(&self.groups).enumerate() {
                let Some(cell) = cell else { continue };
                let (area, y) = (rows.area_of(index), rows.y(index, lane));
                let (low, point, high) = (rows.x(area, cell.low), rows.x(area, cell.point), rows.x(area, cell.high));
                let [at, from, to] = [cell.point, cell.low, cell.high].map(|value| significant(value, 4));
                rows.canvas.hover(&format!("{}, {}: {at} [{from}, {to}]", row.label, group.label), |canvas| {
                    canvas.line((low, y), (high, y), Ink::new(group.style.colour, 1.6));
                    canvas.marker(group.style.marker, (point, y), 3.4, group.style.colour, 1.0);
                });
            }
        }
        Ok(Drawing::new(rows.canvas, &self.heading, sheet))
    }
}

/// Coverage of intervals per parameter against the level that they claim.
///
/// ```
/// use armid_reports::{Band, CoverageFigure, CoverageRow, Figure, Group, Heading, Interval};
/// let figure = CoverageFigure {
///     heading: Heading::new("coverage", "Intervals keep what they claim"),
///     groups: Group::assign(["OLS", "WLS"]),
///     rows: vec![CoverageRow { label: "Fv1".into(), percent: vec![Some(Interval::new(88.0, 85.0, 91.0)), Some(Interval::new(95.2, 93.0, 97.0))] }],
///     nominal_percent: 95.0,
///     band: Band::new(90.4, 98.6, "range of chance for 500 runs"),
/// };
/// assert!(figure.svg().unwrap().contains("nominal 95 %"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// The groups, at most 8.
    pub groups: Vec<Group>,
    /// The rows, at most 120; more than 20 stand in two columns.
    pub rows: Vec<CoverageRow>,
    /// The level that the intervals claim, percent.
    pub nominal_percent: f64,
    /// The range in which the coverage of a right interval falls by chance, percent.
    pub band: Band,
}

/// Coverage of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageRow {
    /// Name of the parameter.
    pub label: String,
    /// Share of runs whose interval held the true value, percent, with the uncertainty of that share (both ends equal to
    /// the point where none is known), per group.
    pub percent: Vec<Option<Interval>>,
}

impl Figure for CoverageFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        let check = Check::heading(&self.heading)?;
        for row in &self.rows {
            for cell in row.percent.iter().flatten() {
                let name = format!("coverage of \"{}\"", row.label);
                check.ascending(&format!("{name} with its bounds 0 and 100"), &[0.0, cell.low, cell.high, 100.0])?;
            }
        }
        check.finite("the nominal level", self.nominal_percent)?;
        let nominal = crate::drawing::ticks::shortest(self.nominal_percent, 2);
        IntervalFigure {
            heading: self.heading.clone(),
            value: Axis { scale: Scale::Linear, ..Axis::linear("coverage", "%") }.including(&[100.0]),
            groups: self.groups.clone(),
            rows: self
                .rows
                .iter()
                .map(|row| IntervalRow { label: row.label.clone(), cells: row.percent.clone() })
                .collect(),
            levels: vec![Level::new(self.nominal_percent, format!("nominal {nominal} %"))],
            band: Some(self.band.clone()),
        }
        .draw(sheet)
    }
}
