//! One quantity against another, such as a criterion's value against the error achieved with it.

use super::Figure;
use crate::FigureError;
use crate::drawing::axis::{Axis, Span};
use crate::drawing::canvas::{Canvas, Ink, Rect};
use crate::drawing::check::Check;
use crate::drawing::colour::Colour;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::{self, Swatch};
use crate::drawing::lattice::{Arrangement, Panel, Plot, lattice};
use crate::drawing::sheet::Sheet;
use crate::drawing::ticks::significant;
use crate::drawing::typeface::Font;
use crate::heading::Heading;
use crate::style::{Dash, GroupStyle};

/// Points in one or more panels, grouped by colour and marker.
///
/// ```
/// use armid_reports::{Axis, Figure, GroupStyle, Heading, ScatterFigure, ScatterGroup, ScatterPanel, ScatterPoint};
/// let figure = ScatterFigure {
///     heading: Heading::new("condition-error", "A smaller condition number goes with a smaller error"),
///     columns: 1,
///     panels: vec![ScatterPanel {
///         title: String::new(),
///         x: Axis::log("condition number", ""),
///         y: Axis::log("torque RMSE", "N·m"),
///         groups: vec![ScatterGroup {
///             label: "condition".into(),
///             style: GroupStyle::nth(0),
///             points: vec![ScatterPoint::new(55.0, 0.11).interval(0.09, 0.14), ScatterPoint::new(210.0, 0.2)],
///         }],
///         references: Vec::new(),
///     }],
/// };
/// assert!(figure.svg().unwrap().contains("condition number"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ScatterFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// Panels in a row, 1 to 3.
    pub columns: usize,
    /// The panels, row by row; at most 12. Each has axes of its own.
    pub panels: Vec<ScatterPanel>,
}

/// One panel of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScatterPanel {
    /// Title of the panel; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The points; groups of one label share a legend entry.
    pub groups: Vec<ScatterGroup>,
    /// Lines to compare with.
    pub references: Vec<Reference>,
}

/// Points of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatterGroup {
    /// Name in the legend.
    pub label: String,
    /// Colour and marker.
    pub style: GroupStyle,
    /// The points.
    pub points: Vec<ScatterPoint>,
}

/// One point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterPoint {
    /// Place along the horizontal axis.
    pub x: f64,
    /// Place along the vertical axis.
    pub y: f64,
    /// Ends of the error bar in y, `low ≤ y ≤ high`.
    pub interval: Option<(f64, f64)>,
}

impl ScatterPoint {
    /// A point without error bar.
    pub fn new(x: f64, y: f64) -> Self {
        Self { x, y, interval: None }
    }

    /// Returns this point with an error bar from `low` to `high`.
    #[must_use]
    pub fn interval(self, low: f64, high: f64) -> Self {
        Self { interval: Some((low, high)), ..self }
    }
}

/// A line that belongs to no group.
#[derive(Clone, Debug, PartialEq)]
pub enum Reference {
    /// A vertical line at a value of x.
    X {
        /// Where.
        value: f64,
        /// Written beside it; may be empty.
        label: String,
    },
    /// A horizontal line at a value of y.
    Y {
        /// Where.
        value: f64,
        /// Written beside it; may be empty.
        label: String,
    },
    /// A line between two points, such as a fitted one.
    Segment {
        /// One end.
        from: (f64, f64),
        /// The other end.
        to: (f64, f64),
        /// Written in the legend; may be empty.
        label: String,
    },
}

impl Reference {
    fn xs(&self) -> Vec<f64> {
        match self {
            Self::X { value, .. } => vec![*value],
            Self::Y { .. } => Vec::new(),
            Self::Segment { from, to, .. } => vec![from.0, to.0],
        }
    }

    fn ys(&self) -> Vec<f64> {
        match self {
            Self::X { .. } => Vec::new(),
            Self::Y { value, .. } => vec![*value],
            Self::Segment { from, to, .. } => vec![from.1, to.1],
        }
    }

    fn label(&self) -> &str {
        match self {
            Self::X { label, .. } | Self::Y { label, .. } | Self::Segment { label, .. } => label,
        }
    }
}

impl ScatterPanel {
    fn check(&self, check: Check<'_>, number: usize) -> Result<(), FigureError> {
        let panel = format!("panel {number} \"{}\"", self.title);
        check.axis(&format!("the x axis of {panel}"), &self.x)?;
        check.axis(&format!("the y axis of {panel}"), &self.y)?;
        check.count(&format!("the list of groups in {panel}"), self.groups.len(), 24)?;
        for group in &self.groups {
            let name = format!("group \"{}\" in {panel}", group.label);
            check.count(&name, group.points.len(), 20_000)?;
            for (index, point) in group.points.iter().enumerate() {
                check.on_axis(&format!("x of point {index} of {name}"), point.x, self.x.scale)?;
                check.on_axis(&format!("y of point {index} of {name}"), point.y, self.y.scale)?;
                if let Some((low, high)) = point.interval {
                    let bar = format!("error bar of point {index} of {name}");
                    check.on_axis(&bar, low, self.y.scale)?;
                    check.on_axis(&bar, high, self.y.scale)?;
                    check.ascending(&bar, &[low, point.y, high])?;
                }
            }
        }
        for reference in &self.references {
            let name = format!("reference line \"{}\" in {panel}", reference.label());
            check.all_on_axis(&name, &reference.xs(), self.x.scale)?;
            check.all_on_axis(&name, &reference.ys(), self.y.scale)?;
        }
        Ok(())
    }

    fn x_span(&self) -> Option<Span> {
        let points = self.groups.iter().flat_map(|group| group.points.iter().map(|point| point.x));
        let others = self.references.iter().flat_map(Reference::xs).chain(self.x.include.iter().copied());
        Span::covering(self.x.scale, points.chain(others), 0.05)
    }

    fn y_span(&self) -> Option<Span> {
        let points = self.groups.iter().flat_map(|group| {
            group.points.iter().flat_map(|point| {
                let (low, high) = point.interval.unwrap_or((point.y, point.y));
                [low, point.y, high]
            })
        });
        let others = self.references.iter().flat_map(Reference::ys).chain(self.y.include.iter().copied());
        Span::covering(self.y.scale, points.chain(others), 0.06)
    }

    fn draw(&self, canvas: &mut Canvas, plot: &Plot) {
        let ink = Ink::new(Colour::TEXT, 1.1);
        let mut fitted = 0;
        for reference in &self.references {
            match reference {
                Reference::X { value, .. } => canvas.dashed(&plot.vertical(*value), Dash::Dashed.pattern(), ink),
                Reference::Y { value, .. } => canvas.dashed(&plot.horizontal(*value), Dash::Dashed.pattern(), ink),
                Reference::Segment { from, to, .. } => {
                    canvas.dashed(&[plot.xy(from.0, from.1), plot.xy(to.0, to.1)], segment_dash(fitted).pattern(), ink);
                    fitted += 1;
                }
            }
        }
        let count: usize = self.groups.iter().map(|group| group.points.len()).sum();
        let (radius, opacity) = if count > MANY { (3.2, 0.6) } else { (4.3, 0.92) };
        for group in &self.groups {
            for point in &group.points {
                if let Some((low, high)) = point.interval {
                    let bar = Ink::new(group.style.colour, 1.1);
                    let (x, bottom) = plot.xy(point.x, low);
                    let top = plot.y_at(high);
                    canvas.line((x, bottom), (x, top), bar);
                    canvas.line((x - 3.0, bottom), (x + 3.0, bottom), bar);
                    canvas.line((x - 3.0, top), (x + 3.0, top), bar);
                }
            }
        }
        for group in &self.groups {
            if count > MANY && self.groups.len() == 1 {
                let centres: Vec<(f64, f64)> = group.points.iter().map(|point| plot.xy(point.x, point.y)).collect();
                canvas.dots(&centres, 0.6 * radius, Ink::new(group.style.colour, 0.0).faint(opacity));
                continue;
            }
            for point in &group.points {
                let at = plot.xy(point.x, point.y);
                let [x, y] = [point.x, point.y].map(|value| significant(value, 4));
                let draw = |canvas: &mut Canvas| {
                    canvas.marker(group.style.marker, at, radius, group.style.colour, opacity);
                };
                if count > MANY {
                    draw(canvas);
                } else {
                    canvas.hover(&format!("{}: {x}, {y}", group.label), draw);
                }
            }
        }
        self.label_references(canvas, plot);
    }

    /// Writes the labels of level and upright lines beside them, where they cover the fewest points.
    fn label_references(&self, canvas: &mut Canvas, plot: &Plot) {
        let points: Vec<(f64, f64)> = self
            .groups
            .iter()
            .flat_map(|group| &group.points)
            .flat_map(|point| {
                let (low, high) = point.interval.unwrap_or((point.y, point.y));
                [plot.xy(point.x, point.y), plot.xy(point.x, low), plot.xy(point.x, high)]
            })
            .collect();
        let area = &plot.area;
        let mut taken: Vec<Rect> = Vec::new();
        for reference in &self.references {
            let label = Font::NOTE.fit(reference.label(), 0.6 * area.width());
            let (width, reach) = (Font::NOTE.width(&label), 0.5 * Font::NOTE.size + 1.0);
            let centres: Vec<(f64, f64)> = match reference {
                Reference::Y { value, .. } => {
                    let y = plot.y_at(*value);
                    let xs = [area.right - 3.0 - 0.5 * width, area.left + 4.0 + 0.5 * width, area.centre().0];
                    xs.iter().flat_map(|&x| [(x, y - 9.0), (x, y + 9.0)]).collect()
                }
                Reference::X { value, .. } => {
                    let x = plot.x_at(*value);
                    let ys = [area.top + 9.0, area.bottom - 9.0, area.top + 27.0, area.bottom - 27.0];
                    ys.iter().flat_map(|&y| [(x + 5.0 + 0.5 * width, y), (x - 5.0 - 0.5 * width, y)]).collect()
                }
                Reference::Segment { .. } => continue,
            };
            let label_box = |(x, y): (f64, f64)| Rect {
                left: x - 0.5 * width,
                top: y - reach,
                right: x + 0.5 * width,
                bottom: y + reach,
            };
            let cost = |rect: &Rect| {
                let inside = rect.left >= area.left
                    && rect.right <= area.right + 20.0
                    && rect.top >= area.top
                    && rect.bottom <= area.bottom;
                let covered = points.iter().filter(|&&(x, y)| {
                    x > rect.left - 5.0 && x < rect.right + 5.0 && y > rect.top - 5.0 && y < rect.bottom + 5.0
                });
                let crossed = self.references.iter().filter(|other| match other {
                    Reference::X { value, .. } => (rect.left - 2.0..rect.right + 2.0).contains(&plot.x_at(*value)),
                    Reference::Y { value, .. } => (rect.top..rect.bottom).contains(&plot.y_at(*value)),
                    Reference::Segment { .. } => false,
                });
                let clashes = taken.iter().filter(|other| rect.overlaps(other)).count();
                covered.count() + 3 * crossed.count() + 1000 * clashes + if inside { 0 } else { 10_000 }
            };
            let best = centres.into_iter().map(label_box).min_by_key(|rect| cost(rect));
            if let Some(rect) = best {
                canvas.note(&label, rect.centre(), Font::NOTE, Colour::MUTED);
                taken.push(rect);
            }
        }
    }
}

/// Stroke of the `index`-th reference line that is neither upright nor level.
fn segment_dash(index: usize) -> Dash {
    [Dash::Dashed, Dash::Dotted, Dash::DashDot, Dash::Solid][index % 4]
}

/// Points of a panel beyond which they are small, say nothing under the pointer, and are one element if they are one group.
const MANY: usize = 200;

impl Figure for ScatterFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        let check = Check::heading(&self.heading)?;
        check.count("the list of panels", self.panels.len(), 12)?;
        check.count("the number of columns", self.columns, 3)?;
        let mut legend = Vec::new();
        let mut panels = Vec::with_capacity(self.panels.len());
        for (number, panel) in self.panels.iter().enumerate() {
            panel.check(check, number + 1)?;
            for group in &panel.groups {
                head::add(&mut legend, &group.label, Swatch::Point(group.style));
            }
            panels.push(Panel {
                title: &panel.title,
                x: &panel.x,
                y: &panel.y,
                x_span: panel.x_span().ok_or_else(|| check.empty("the x axis"))?,
                y_span: panel.y_span().ok_or_else(|| check.empty("the y axis"))?,
            });
        }
        for panel in &self.panels {
            let segments = panel.references.iter().filter(|line| matches!(line, Reference::Segment { .. }));
            for (index, reference) in segments.enumerate() {
                head::add(&mut legend, reference.label(), Swatch::Reference(segment_dash(index)));
            }
        }
        let plot_height = if self.panels.len() == 1 { 420.0 } else { 270.0 };
        let arrangement = Arrangement { columns: self.columns, plot_height, share_x: false, share_y: false, sheet };
        let (mut canvas, plots) = lattice(&self.heading, &legend, &panels, arrangement);
        for (panel, plot) in self.panels.iter().zip(&plots) {
            panel.draw(&mut canvas, plot);
        }
        Ok(Drawing::new(canvas, &self.heading, sheet))
    }
}
