//! How an objective falls with the number of evaluations, one step line per start.

use super::Figure;
use crate::FigureError;
use crate::drawing::axis::{Axis, Scale, Span};
use crate::drawing::canvas::Ink;
use crate::drawing::check::Check;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::{self, Swatch};
use crate::drawing::lattice::{Arrangement, Panel, lattice};
use crate::drawing::path::visible;
use crate::drawing::sheet::Sheet;
use crate::heading::Heading;
use crate::style::GroupStyle;

/// Step lines in one or more panels, one panel per objective.
///
/// ```
/// use armid_reports::{Axis, ConvergenceFigure, ConvergencePanel, Curve, Figure, GroupStyle, Heading};
/// let figure = ConvergenceFigure {
///     heading: Heading::new("convergence", "Most of the gain comes early"),
///     columns: 1,
///     panels: vec![ConvergencePanel {
///         title: String::new(),
///         evaluations: Axis::linear("evaluations", ""),
///         value: Axis::log("condition number", ""),
///         curves: vec![Curve::new("optimiser", GroupStyle::nth(0), vec![(1.0, 900.0), (40.0, 120.0), (200.0, 60.0)])],
///     }],
/// };
/// assert!(figure.svg().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergenceFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// Panels in a row, 1 to 3.
    pub columns: usize,
    /// The panels, row by row; at most 12. Each has axes of its own.
    pub panels: Vec<ConvergencePanel>,
}

/// The curves of one objective.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConvergencePanel {
    /// Title of the panel; may be empty.
    pub title: String,
    /// The axis of the number of evaluations.
    pub evaluations: Axis,
    /// The axis of the objective.
    pub value: Axis,
    /// The curves; at most 200.
    pub curves: Vec<Curve>,
}

/// One start of an optimiser.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name of its group; curves of one label share a legend entry.
    pub label: String,
    /// Colour and stroke of the group; the marker stands at the end of the curve.
    pub style: GroupStyle,
    /// Number of evaluations, in ascending order, and the value reached with it, which holds until the next.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// A start of group `label`.
    pub fn new(label: impl Into<String>, style: GroupStyle, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), style, points }
    }
}

impl ConvergencePanel {
    fn check(&self, check: Check<'_>, number: usize) -> Result<(), FigureError> {
        let panel = format!("panel {number} \"{}\"", self.title);
        check.axis(&format!("the axis of evaluations of {panel}"), &self.evaluations)?;
        check.axis(&format!("the value axis of {panel}"), &self.value)?;
        check.count(&format!("the list of curves in {panel}"), self.curves.len(), 200)?;
        for (index, curve) in self.curves.iter().enumerate() {
            let name = format!("curve {index} \"{}\" in {panel}", curve.label);
            if curve.points.is_empty() {
                return Err(check.empty(&name));
            }
            let (evaluations, values): (Vec<f64>, Vec<f64>) = curve.points.iter().copied().unzip();
            check.all_on_axis(&format!("evaluations of {name}"), &evaluations, self.evaluations.scale)?;
            check.all_on_axis(&format!("values of {name}"), &values, self.value.scale)?;
            check.ascending(&format!("evaluations of {name}"), &evaluations)?;
        }
        Ok(())
    }

    fn spans(&self) -> Option<(Span, Span)> {
        let points = || self.curves.iter().flat_map(|curve| curve.points.iter().copied());
        let evaluations = points().map(|point| point.0).chain(self.evaluations.include.iter().copied());
        let values = points().map(|point| point.1).chain(self.value.include.iter().copied());
        let x = Span::covering(self.evaluations.scale, evaluations, 0.03)?;
        // Counts begin at zero or one: nothing is gained by room to the left of them.
        let least = points().map(|point| point.0).fold(f64::INFINITY, f64::min);
        let x = if x.scale == Scale::Linear && least >= 0.0 { Span { low: x.low.max(0.0), ..x } } else { x };
        Some((x, Span::covering(self.value.scale, values, 0.05)?))
    }
}

/// The corners of a step line: each value holds until the next point.
fn steps(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut corners = Vec::with_capacity(2 * points.len());
    for (index, &point) in points.iter().enumerate() {
        if index > 0 {
            corners.push((point.0, points[index - 1].1));
        }
        corners.push(point);
    }
    corners
}

impl Figure for ConvergenceFigure {
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
            for curve in &panel.curves {
                head::add(&mut legend, &curve.label, Swatch::LinePoint(curve.style));
            }
            let (x_span, y_span) = panel.spans().ok_or_else(|| check.empty("the list of curves"))?;
            panels.push(Panel { title: &panel.title, x: &panel.evaluations, y: &panel.value, x_span, y_span });
        }
        let plot_height = if self.panels.len() == 1 { 380.0 } else { 260.0 };
        let arrangement = Arrangement { columns: self.columns, plot_height, share_x: false, share_y: false, sheet };
        let (mut canvas, plots) = lattice(&self.heading, &legend, &panels, arrangement);
        for (panel, plot) in self.panels.iter().zip(&plots) {
            let many = panel.curves.len() > 12;
            for curve in &panel.curves {
                let corners: Vec<(f64, f64)> = steps(&curve.points).into_iter().map(|(x, y)| plot.xy(x, y)).collect();
                let width = if many { 0.75 * curve.style.width_px } else { curve.style.width_px };
                let ink = Ink::new(curve.style.colour, width).faint(if many { 0.7 } else { 0.9 });
                canvas.dashed(&visible(&corners), curve.style.dash.pattern(), ink);
            }
            for curve in &panel.curves {
                if let Some(&(x, y)) = curve.points.last() {
                    canvas.marker(curve.style.marker, plot.xy(x, y), 4.0, curve.style.colour, 0.95);
                }
            }
        }
        Ok(Drawing::new(canvas, &self.heading, sheet))
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn analytic_a_value_holds_until_the_next() {
        let corners = super::steps(&[(0.0, 9.0), (2.0, 5.0), (7.0, 4.0)]);
        assert_eq!(corners, [(0.0, 9.0), (2.0, 9.0), (2.0, 5.0), (7.0, 5.0), (7.0, 4.0)]);
    }
}
