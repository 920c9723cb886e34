//! Lines over time, one panel per joint: a trajectory against its limits, or a measured against a predicted torque.

use super::Figure;
use crate::FigureError;
use crate::drawing::axis::{Axis, Scale, Span};
use crate::drawing::canvas::{Align, Ink};
use crate::drawing::check::Check;
use crate::drawing::colour::Colour;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::{self, Swatch};
use crate::drawing::lattice::{Arrangement, Panel, lattice};
use crate::drawing::path::visible;
use crate::drawing::sheet::Sheet;
use crate::drawing::typeface::Font;
use crate::heading::Heading;
use crate::style::{Dash, GroupStyle};

/// Panels of lines over one common time axis.
///
/// ```
/// use armid_reports::{Axis, Figure, GroupStyle, Heading, Limit, Line, TimePanel, TimeSeriesFigure};
/// let figure = TimeSeriesFigure {
///     heading: Heading::new("speed", "The elbow stays below its speed limit"),
///     time: Axis::linear("time", "s"),
///     value: Axis::linear("velocity", "% of limit"),
///     columns: 1,
///     same_range: true,
///     panels: vec![TimePanel {
///         title: "elbow".into(),
///         lines: vec![Line::new("velocity", GroupStyle::nth(0), vec![0.0, 1.0, 2.0], vec![0.0, 80.0, -10.0])],
///         limits: vec![Limit::new(100.0, "limit"), Limit::new(-100.0, "limit")],
///     }],
/// };
/// assert!(figure.svg().unwrap().starts_with("<svg"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TimeSeriesFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// The time axis of every panel.
    pub time: Axis,
    /// The value axis of every panel.
    pub value: Axis,
    /// Panels in a row, 1 to 3.
    pub columns: usize,
    /// One value range for all panels (`true`), or one each.
    pub same_range: bool,
    /// The panels, row by row; at most 12.
    pub panels: Vec<TimePanel>,
}

/// One panel, as a rule one joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimePanel {
    /// Title of the panel; may be empty.
    pub title: String,
    /// Its lines, painted in this order; lines of one label and style share a legend entry.
    pub lines: Vec<Line>,
    /// Its limits, drawn dashed.
    pub limits: Vec<Limit>,
}

/// One line over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub label: String,
    /// Colour, stroke, width.
    pub style: GroupStyle,
    /// Times in ascending order.
    pub times: Vec<f64>,
    /// One value per time.
    pub values: Vec<f64>,
}

impl Line {
    /// A line through `(times[k], values[k])`.
    pub fn new(label: impl Into<String>, style: GroupStyle, times: Vec<f64>, values: Vec<f64>) -> Self {
        Self { label: label.into(), style, times, values }
    }
}

/// A value that must not be passed, or any other level to compare with.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// The level, in the unit of the value axis.
    pub value: f64,
    /// Written beside the line; may be empty.
    pub label: String,
}

impl Limit {
    /// A limit at `value`.
    pub fn new(value: f64, label: impl Into<String>) -> Self {
        Self { value, label: label.into() }
    }
}

impl TimeSeriesFigure {
    fn check(&self) -> Result<(), FigureError> {
        let check = Check::heading(&self.heading)?;
        check.axis("the time axis", &self.time)?;
        check.axis("the value axis", &self.value)?;
        check.count("the list of panels", self.panels.len(), 12)?;
        check.count("the number of columns", self.columns, 3)?;
        for (number, panel) in self.panels.iter().enumerate() {
            let panel_name = format!("panel {} \"{}\"", number + 1, panel.title);
            check.count(&format!("the list of lines in {panel_name}"), panel.lines.len(), 12)?;
            for line in &panel.lines {
                let name = format!("line \"{}\" in {panel_name}", line.label);
                if line.times.is_empty() {
                    return Err(check.empty(&name));
                }
                check.length(&format!("values of {name}"), line.values.len(), line.times.len())?;
                check.all_on_axis(&format!("times of {name}"), &line.times, self.time.scale)?;
                check.all_on_axis(&format!("values of {name}"), &line.values, self.value.scale)?;
                check.ascending(&format!("time of {name}"), &line.times)?;
            }
            for limit in &panel.limits {
                check.on_axis(&format!("limit \"{}\" in {panel_name}", limit.label), limit.value, self.value.scale)?;
            }
        }
        Ok(())
    }

    /// The numbers a panel shows along its value axis.
    fn values<'a>(&'a self, panel: &'a TimePanel) -> impl Iterator<Item = f64> + 'a {
        let lines = panel.lines.iter().flat_map(|line| line.values.iter().copied());
        lines.chain(panel.limits.iter().map(|limit| limit.value)).chain(self.value.include.iter().copied())
    }
}

/// Whether a limit's label goes above its line: away from the data.
fn label_above(panel: &TimePanel, limit: &Limit) -> bool {
    let values = || panel.lines.iter().flat_map(|line| line.values.iter().copied());
    let above = values().filter(|&value| value > limit.value).count();
    2 * above <= values().count()
}

impl Figure for TimeSeriesFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        self.check()?;
        let check = Check::heading(&self.heading)?;
        let plot_height = if self.panels.len() <= self.columns { 260.0 } else { 170.0 };
        let times = self.panels.iter().flat_map(|panel| panel.lines.iter().flat_map(|line| line.times.iter().copied()));
        let time_span = Span::covering(self.time.scale, times.chain(self.time.include.iter().copied()), 0.0)
            .ok_or_else(|| check.empty("the time axis"))?;
        let room = |span: Span, panels: &[TimePanel]| {
            let labelled = |above: bool| {
                let mut limits = panels.iter().flat_map(|panel| panel.limits.iter().map(move |limit| (panel, limit)));
                limits.any(|(panel, limit)| !limit.label.is_empty() && label_above(panel, limit) == above)
            };
            let pixels = |labelled: bool| if labelled { 17.0 } else { 8.0 };
            span.with_room(pixels(labelled(false)), pixels(labelled(true)), plot_height)
        };
        let mut spans = Vec::with_capacity(self.panels.len());
        for panel in &self.panels {
            let span = if self.same_range {
                let all = self.panels.iter().flat_map(|panel| self.values(panel));
                Span::covering(self.value.scale, all, 0.0).map(|span| room(span, &self.panels))
            } else {
                Span::covering(self.value.scale, self.values(panel), 0.0)
                    .map(|span| room(span, std::slice::from_ref(panel)))
            };
            spans.push(span.ok_or_else(|| check.empty("the value axis"))?);
        }

        let mut legend = Vec::new();
        for line in self.panels.iter().flat_map(|panel| &panel.lines) {
            head::add(&mut legend, &line.label, Swatch::Line(line.style));
        }
        let panels: Vec<Panel<'_>> = self
            .panels
            .iter()
            .zip(&spans)
            .map(|(panel, &y_span)| Panel {
                title: &panel.title,
                x: &self.time,
                y: &self.value,
                x_span: time_span,
                y_span,
            })
            .collect();
        let arrangement =
            Arrangement { columns: self.columns, plot_height, share_x: true, share_y: self.same_range, sheet };
        let (mut canvas, plots) = lattice(&self.heading, &legend, &panels, arrangement);
        for (panel, plot) in self.panels.iter().zip(&plots) {
            if plot.y.scale == Scale::Linear && plot.y.contains(0.0) {
                canvas.polyline(&plot.horizontal(0.0), Ink::new(Colour::FRAME, 0.7));
            }
            for limit in &panel.limits {
                canvas.dashed(&plot.horizontal(limit.value), Dash::Dashed.pattern(), Ink::new(Colour::TEXT, 1.1));
            }
            for line in &panel.lines {
                let points: Vec<(f64, f64)> =
                    line.times.iter().zip(&line.values).map(|(&time, &value)| plot.xy(time, value)).collect();
                let points = visible(&points);
                canvas.dashed(&points, line.style.dash.pattern(), Ink::new(line.style.colour, line.style.width_px));
                if let [only] = points[..] {
                    canvas.marker(line.style.marker, only, 3.5, line.style.colour, 1.0);
                }
            }
            for limit in &panel.limits {
                let away = if label_above(panel, limit) { -8.5 } else { 8.5 };
                let at = (plot.area.right - 3.0, plot.y_at(limit.value) + away);
                let label = Font::NOTE.fit(&limit.label, plot.area.width() - 8.0);
                canvas.text(&label, at, Font::NOTE, Colour::MUTED, Align::End);
            }
        }
        Ok(Drawing::new(canvas, &self.heading, sheet))
    }
}
