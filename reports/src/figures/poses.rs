//! How an arm moves: its poses side by side, seen from above at an angle.

use super::Figure;
use crate::FigureError;
use crate::drawing::canvas::{Align, Canvas, Ink};
use crate::drawing::check::Check;
use crate::drawing::colour::Colour;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::{self, Entry, Head, MARGIN, Swatch, width_on};
use crate::drawing::sheet::Sheet;
use crate::drawing::typeface::Font;
use crate::heading::Heading;
use crate::style::{Dash, GroupStyle, Marker};

/// Poses in a row.
const COLUMNS: usize = 4;
/// Height of a pose and its title, px.
const CELL: f64 = 190.0;
const TITLE: f64 = 24.0;
/// Direction of view: turned about z, and down from the horizon, rad.
const VIEW: [f64; 2] = [0.6, 0.35];

/// Poses of one arm, all from one side and at one scale.
///
/// ```
/// use armid_reports::{Figure, GroupStyle, Heading, Pose, PosesFigure};
/// let figure = PosesFigure {
///     heading: Heading::new("poses", "The arm reaches 1 m"),
///     poses: vec![Pose { title: "0 s".into(), points: vec![[0.0; 3], [0.0, 0.0, 0.5], [0.5, 0.0, 1.0]] }],
///     path: vec![[0.5, 0.0, 1.0], [0.4, 0.3, 1.0]],
/// };
/// assert!(figure.svg().unwrap().contains("0 s"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PosesFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// At most 16.
    pub poses: Vec<Pose>,
    /// Where the end of the arm goes, m.
    pub path: Vec<[f64; 3]>,
}

/// One pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// When it is, and why it is shown.
    pub title: String,
    /// From the base to the end of the arm, in the base frame, m.
    pub points: Vec<[f64; 3]>,
}

/// To the right and down, in metres.
fn projected([x, y, z]: [f64; 3]) -> (f64, f64) {
    let [turn, down] = VIEW;
    let (sin, cos) = (libm::sin(turn), libm::cos(turn));
    let depth = cos * x + sin * y;
    (cos * y - sin * x, -(libm::cos(down) * z - libm::sin(down) * depth))
}

/// Metres to pixels, the same in every pose.
#[derive(Clone, Copy)]
struct View {
    scale: f64,
    low: (f64, f64),
    high: (f64, f64),
}

impl View {
    fn at(&self, cell: (f64, f64), width: f64, point: [f64; 3]) -> (f64, f64) {
        let (x, y) = projected(point);
        let middle = (0.5 * (self.low.0 + self.high.0), 0.5 * (self.low.1 + self.high.1));
        (
            cell.0 + 0.5 * width + self.scale * (x - middle.0),
            cell.1 + TITLE + 0.5 * (CELL - TITLE) + self.scale * (y - middle.1),
        )
    }
}

impl PosesFigure {
    fn check(&self) -> Result<(), FigureError> {
        let check = Check::heading(&self.heading)?;
        check.count("the list of poses", self.poses.len(), 16)?;
        for pose in &self.poses {
            check.text("the title of a pose", &pose.title)?;
            if pose.points.len() < 2 {
                return Err(check.empty(&format!("pose \"{}\"", pose.title)));
            }
        }
        let points = self.poses.iter().flat_map(|pose| &pose.points).chain(&self.path);
        points.flatten().try_for_each(|&value| check.finite("a point", value))
    }

    fn view(&self, width: f64) -> View {
        let all = || {
            let points = self.poses.iter().flat_map(|pose| &pose.points).chain(&self.path).copied();
            // The shadow on the plane of the base is drawn too.
            points.flat_map(|[x, y, z]| [projected([x, y, z]), projected([x, y, 0.0])])
        };
        let low = all().fold((f64::INFINITY, f64::INFINITY), |low, at| (low.0.min(at.0), low.1.min(at.1)));
        let high = all().fold((f64::NEG_INFINITY, f64::NEG_INFINITY), |high, at| (high.0.max(at.0), high.1.max(at.1)));
        let room = |pixels: f64, metres: f64| (pixels - 16.0) / metres.max(1e-9);
        View { scale: room(width, high.0 - low.0).min(room(CELL - TITLE, high.1 - low.1)), low, high }
    }
}

impl Figure for PosesFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        self.check()?;
        let (arm, path) = (
            GroupStyle::nth(0).with_width(2.4),
            GroupStyle { dash: Dash::Solid, ..GroupStyle::nth(1).with_width(1.0) },
        );
        let mut entries = Vec::new();
        head::add(&mut entries, "arm", Swatch::Line(arm));
        head::add(&mut entries, "path of its end", Swatch::Line(path));
        entries.push(Entry::new("shadow on the plane of the base", Swatch::Reference(Dash::Dotted)));
        let head = Head::new(&self.heading, &entries, sheet);
        let (columns, whole) = (sheet.panels(COLUMNS, 2), width_on(sheet));
        let rows = self.poses.len().div_ceil(columns);
        let mut canvas = Canvas::new(whole, head.height + rows as f64 * CELL + 30.0);
        head.draw(&mut canvas);
        let width = (whole - 2.0 * MARGIN) / columns as f64;
        let view = self.view(width);
        for (index, pose) in self.poses.iter().enumerate() {
            let cell = (MARGIN + (index % columns) as f64 * width, head.height + (index / columns) as f64 * CELL);
            let title = Font::LABEL.fit(&pose.title, width - 6.0);
            canvas.text(&title, (cell.0 + 0.5 * width, cell.1 + 12.0), Font::LABEL, Colour::TEXT, Align::Middle);
            let line = |points: &[[f64; 3]]| -> Vec<(f64, f64)> {
                points.iter().map(|&point| view.at(cell, width, point)).collect()
            };
            let shadow: Vec<[f64; 3]> = pose.points.iter().map(|&[x, y, _]| [x, y, 0.0]).collect();
            canvas.dashed(&line(&shadow), Dash::Dotted.pattern(), Ink::new(Colour::FRAME, 1.0));
            canvas.polyline(&line(&self.path), Ink::new(path.colour, path.width_px).faint(0.6));
            let points = line(&pose.points);
            canvas.polyline(&points, Ink::new(arm.colour, arm.width_px));
            for &at in &points {
                canvas.marker(Marker::Circle, at, 3.0, arm.colour, 1.0);
            }
        }
        let (bar, below) = (0.5, head.height + rows as f64 * CELL + 14.0);
        let ends = [(MARGIN, below), (MARGIN + bar * view.scale, below)];
        canvas.line(ends[0], ends[1], Ink::new(Colour::TEXT, 2.0));
        canvas.text("0.5 m", (ends[1].0 + 8.0, below), Font::NOTE, Colour::TEXT, Align::Start);
        Ok(Drawing::new(canvas, &self.heading, sheet))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_view_turns_and_keeps_heights_above_each_other() {
        assert_eq!(projected([0.0; 3]), (0.0, -0.0));
        let (x, y) = projected([0.0, 0.0, 1.0]);
        assert!(x == 0.0 && (y + libm::cos(VIEW[1])).abs() < 1e-15, "up is up: {y}");
        // What lies along the line of sight, seen from above, is one point.
        let [turn, down] = VIEW;
        let sight = [libm::cos(turn), libm::sin(turn), libm::tan(down)];
        let (x, y) = projected(sight);
        assert!(x.abs() < 1e-15 && y.abs() < 1e-15, "{x} {y}");
    }

    #[test]
    fn what_cannot_be_drawn_is_named() {
        let pose = |points: Vec<[f64; 3]>| Pose { title: "0 s".into(), points };
        let of = |poses| PosesFigure { heading: Heading::new("poses", "The arm stands"), poses, path: Vec::new() };
        assert!(of(Vec::new()).svg().unwrap_err().to_string().contains("poses"));
        assert!(of(vec![pose(vec![[0.0; 3]])]).svg().unwrap_err().to_string().contains("0 s"));
        assert!(of(vec![pose(vec![[0.0; 3], [f64::NAN, 0.0, 0.0]])]).svg().is_err());
        assert!(of(vec![pose(vec![[0.0; 3], [0.0, 0.0, 1.0]])]).svg().is_ok());
    }
}
