//! Ratios to a reference in panels that share their rows, with type large enough for a telephone.

use super::{Figure, Interval};
use crate::FigureError;
use crate::drawing::axis::{Scale, Span};
use crate::drawing::canvas::{Align, Canvas, Ink, Rect};
use crate::drawing::check::Check;
use crate::drawing::colour::Colour;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::MARGIN;
use crate::drawing::large_head::LargeHead;
use crate::drawing::sheet::Sheet;
use crate::drawing::ticks::{significant, ticks};
use crate::drawing::typeface::Font;
use crate::heading::Heading;
use crate::style::{Group, Marker};

/// Ratios with intervals on a logarithmic axis; smaller is better, 1 is the reference.
///
/// The axis covers 0.5 to 2 and every point. An interval that reaches beyond it ends in an arrow. Points that are not significantly
/// different from 1 are hollow. The figure is 640 px wide: shown at 390 px, its smallest text is still 9.7 px high.
///
/// ```
/// use armid_reports::{Figure, Group, Heading, Interval, Ratio, RatioFigure, RatioPanel};
/// let ratio = Ratio { interval: Interval::new(1.8, 1.5, 2.1), is_significant: true };
/// let figure = RatioFigure {
///     heading: Heading::new("criteria", "D-optimal designs predict torque best"),
///     label: "error relative to D-optimal".into(),
///     reference: "D-optimal".into(),
///     groups: Group::assign(["condition number"]),
///     rows: vec!["exact model".into()],
///     panels: vec![RatioPanel { title: "CRS A460".into(), subtitle: String::new(), cells: vec![vec![Some(ratio)]] }],
/// };
/// assert!(figure.svg().unwrap().contains("exact model"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RatioFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// Label of the axis.
    pub label: String,
    /// What ratios are relative to.
    pub reference: String,
    /// The groups, at most 2: discs and squares.
    pub groups: Vec<Group>,
    /// Names of the rows; the first is bold.
    pub rows: Vec<String>,
    /// The panels, from left to right. All marks together are at most 24.
    pub panels: Vec<RatioPanel>,
}

/// One panel of ratios.
#[derive(Clone, Debug, PartialEq)]
pub struct RatioPanel {
    /// Its title.
    pub title: String,
    /// A line under the title.
    pub subtitle: String,
    /// One ratio per row and group; `None` if there is none.
    pub cells: Vec<Vec<Option<Ratio>>>,
}

impl RatioPanel {
    /// The lines under its title, where it is so wide, px.
    fn subtitles(&self, width: f64) -> Vec<String> {
        Font::LARGE.wrap(&self.subtitle, width, SUBTITLES)
    }
}

/// A ratio to the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The ratio with its interval.
    pub interval: Interval,
    /// Whether it differs significantly from 1.
    pub is_significant: bool,
}

/// Width of the names of rows, gap between panels, height of a row, distance between its two lanes, px.
const NAMES: f64 = 130.0;
const GAP: f64 = 18.0;
const ROW: f64 = 46.0;
const LANE: f64 = 19.0;
/// Height of a line under the title of a panel, px, and how many there may be.
const SUBTITLE: f64 = 20.0;
const SUBTITLES: usize = 2;
const RADIUS: f64 = 6.5;
const NOT_SIGNIFICANT: &str = "not significant";
/// Filled and hollow marks of the two groups.
const MARKS: [[Marker; 2]; 2] = [[Marker::Circle, Marker::OpenCircle], [Marker::Square, Marker::OpenSquare]];

impl RatioFigure {
    fn check(&self) -> Result<Span, FigureError> {
        let check = Check::heading(&self.heading)?;
        check.text("the label of the axis", &self.label)?;
        check.count("the list of groups", self.groups.len(), MARKS.len())?;
        check.count("the list of rows", self.rows.len(), 24)?;
        check.count("the list of panels", self.panels.len(), 3)?;
        let mut points = vec![0.5, 2.0];
        for panel in &self.panels {
            let name = format!("panel \"{}\"", panel.title);
            check.length(&name, panel.cells.len(), self.rows.len())?;
            for (cells, row) in panel.cells.iter().zip(&self.rows) {
                let name = format!("row \"{row}\" of {name}");
                check.length(&name, cells.len(), self.groups.len())?;
                for Ratio { interval: Interval { point, low, high }, .. } in cells.iter().flatten() {
                    check.all_on_axis(&name, &[*low, *point, *high], Scale::Log)?;
                    check.ascending(&name, &[*low, *point, *high])?;
                    points.push(*point);
                }
            }
        }
        check.count("the list of marks", points.len() - 2, 24)?;
        Span::covering(Scale::Log, points.into_iter(), 0.08).ok_or_else(|| check.empty("every ratio"))
    }

    /// Widths of the entries of the legend: a mark of each group, and all hollow ones together.
    fn legend(&self) -> Vec<f64> {
        let words = |label: &str, behind: f64| Font::LARGE.width(label) + behind;
        let mut widths: Vec<f64> = self.groups.iter().map(|group| words(&group.label, 13.0 + 22.0)).collect();
        widths.push(18.0 * self.groups.len() as f64 + words(NOT_SIGNIFICANT, 4.0));
        widths
    }

    fn entry(&self, canvas: &mut Canvas, number: usize, (left, y): (f64, f64)) {
        let mut x = left + RADIUS;
        if let Some(group) = self.groups.get(number) {
            canvas.marker(MARKS[number][0], (x, y), RADIUS, group.style.colour, 1.0);
            canvas.text(&group.label, (x + 13.0, y), Font::LARGE, Colour::TEXT, Align::Start);
            return;
        }
        for (group, [_, hollow]) in self.groups.iter().zip(MARKS) {
            canvas.marker(hollow, (x, y), RADIUS, group.style.colour, 1.0);
            x += 18.0;
        }
        canvas.text(NOT_SIGNIFICANT, (x - 4.0, y), Font::LARGE, Colour::TEXT, Align::Start);
    }

    /// Names of the rows on stripes.
    fn names(&self, canvas: &mut Canvas, top: f64) {
        for (index, name) in self.rows.iter().enumerate() {
            let row = top + index as f64 * ROW;
            if index % 2 == 1 {
                let stripe = Rect { left: 0.0, top: row, right: canvas.width(), bottom: row + ROW };
                canvas.rectangle(&stripe, Ink::new(Colour::STRIPE, 0.0));
            }
            let font = if index == 0 { Font::LARGE_BOLD } else { Font::LARGE };
            let lines = font.wrap(name, NAMES, 2);
            for (line, text) in lines.iter().enumerate() {
                let y = row + 0.5 * ROW + 19.0 * (line as f64 - 0.5 * (lines.len() - 1) as f64);
                canvas.text(text, (MARGIN, y), font, Colour::TEXT, Align::Start);
            }
        }
    }

    /// One panel: titles above `area`, zone and grid, numbers below, marks.
    fn panel(&self, canvas: &mut Canvas, panel: &RatioPanel, area: &Rect, span: Span) {
        let x = |value: f64| area.left + span.fraction(value) * area.width();
        let middle = area.centre().0;
        let mut y = area.top - 13.0;
        for line in panel.subtitles(area.width()).iter().rev() {
            canvas.text(line, (middle, y), Font::LARGE, Colour::MUTED, Align::Middle);
            y -= SUBTITLE;
        }
        let title = Font::LARGE_BOLD.fit(&panel.title, area.width());
        canvas.text(&title, (middle, y - 1.0), Font::LARGE_BOLD, Colour::TEXT, Align::Middle);
        canvas.rectangle(&Rect { right: x(1.0), ..*area }, Ink::new(Colour::BAND, 0.0));
        for tick in ticks(&span, area.width(), 5.0, |label| Font::LARGE.width(label)) {
            let at = x(tick.value);
            canvas.line((at, area.top), (at, area.bottom), Ink::new(Colour::GRID, 1.0));
            canvas.text(&tick.label, (at, area.bottom + 14.0), Font::LARGE, Colour::TEXT, Align::Middle);
        }
        for (from, to) in [(area.top, area.bottom + 5.0), (area.bottom + 28.0, area.bottom + 48.0)] {
            canvas.line((x(1.0), from), (x(1.0), to), Ink::new(Colour::TEXT, 1.8));
        }
        canvas.text("better", (x(1.0) - 6.0, area.bottom + 38.0), Font::LARGE, Colour::TEXT, Align::End);
        let long = format!("worse than {}", self.reference);
        let fits = x(1.0) + 6.0 + Font::LARGE.width(&long) <= area.right + 0.5 * GAP;
        let worse = if fits { &long } else { "worse" };
        canvas.text(worse, (x(1.0) + 6.0, area.bottom + 38.0), Font::LARGE, Colour::TEXT, Align::Start);
        for (row, cells) in panel.cells.iter().enumerate() {
            for (lane, (cell, group)) in cells.iter().zip(&self.groups).enumerate() {
                let Some(Ratio { interval, is_significant }) = cell else { continue };
                let lanes = 0.5 * (self.groups.len() - 1) as f64;
                let y = area.top + (row as f64 + 0.5) * ROW + LANE * (lane as f64 - lanes);
                let colour = group.style.colour;
                let ends = [interval.low, interval.high].map(|end| end.clamp(span.low, span.high));
                canvas.line((x(ends[0]), y), (x(ends[1]), y), Ink::new(colour, 2.4));
                for (end, whole, inwards) in [(ends[0], interval.low, 9.0), (ends[1], interval.high, -9.0)] {
                    if !span.contains(whole) {
                        let base = x(end) + inwards;
                        canvas.area(&[(x(end), y), (base, y - 5.0), (base, y + 5.0)], Ink::new(colour, 0.0));
                    }
                }
                let mark = MARKS[lane][usize::from(!is_significant)];
                let [at, from, to] = [interval.point, interval.low, interval.high].map(|value| significant(value, 3));
                canvas.hover(&format!("{}, {}: {at} [{from}, {to}]", self.rows[row], group.label), |canvas| {
                    canvas.marker(mark, (x(interval.point), y), RADIUS, colour, 1.0);
                });
            }
        }
    }
}

impl Figure for RatioFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        let span = self.check()?;
        let head = LargeHead::new(&self.heading, &self.legend(), sheet);
        let whole = head.width;
        let left = MARGIN + NAMES + 6.0;
        let width = (whole - MARGIN - left + GAP) / self.panels.len() as f64 - GAP;
        let lines = self.panels.iter().map(|panel| panel.subtitles(width).len()).max().unwrap_or(0);
        let top = head.height + 32.0 + SUBTITLE * lines.max(1) as f64;
        let bottom = top + self.rows.len() as f64 * ROW;
        let mut canvas = Canvas::new(whole, bottom + 80.0);
        head.draw(&mut canvas, |canvas, number, at| self.entry(canvas, number, at));
        self.names(&mut canvas, top);
        for (index, panel) in self.panels.iter().enumerate() {
            let left = left + index as f64 * (width + GAP);
            self.panel(&mut canvas, panel, &Rect { left, top, right: left + width, bottom }, span);
        }
        let at = (0.5 * (left + whole - MARGIN), bottom + 64.0);
        canvas.text(&Font::LARGE.fit(&self.label, whole - left), at, Font::LARGE, Colour::TEXT, Align::Middle);
        Ok(Drawing::new(canvas, &self.heading, sheet))
    }
}

#[cfg(test)]
mod tests {
    use super::{Figure, Group, Heading, Interval, Ratio, RatioFigure, RatioPanel, Sheet};

    fn figure(rows: usize, interval: Interval) -> RatioFigure {
        let ratio = Some(Ratio { interval, is_significant: false });
        RatioFigure {
            heading: Heading::new("ratios", "Title"),
            label: "error".into(),
            reference: "b".into(),
            groups: Group::assign(["a"]),
            rows: (0..rows).map(|row| format!("row {row}")).collect(),
            panels: vec![RatioPanel { title: "robot".into(), subtitle: String::new(), cells: vec![vec![ratio]; rows] }],
        }
    }

    #[test]
    fn more_marks_than_a_reader_takes_in_are_refused() {
        assert!(figure(24, Interval::new(2.0, 1.0, 3.0)).svg().is_ok());
        let error = figure(25, Interval::new(2.0, 1.0, 3.0)).svg().unwrap_err();
        assert_eq!(error.to_string(), "figure \"ratios\": the list of rows has 25 entries, expected at most 24");
    }

    #[test]
    fn what_is_worse_is_named_where_there_is_room_for_it() {
        let is_named = |reference: &str| {
            let figure = RatioFigure { reference: reference.into(), ..figure(1, Interval::new(2.0, 1.5, 2.5)) };
            figure.svg().unwrap().contains(&format!("worse than {reference}"))
        };
        assert!(is_named("D-optimal"));
        assert!(!is_named("a reference whose name is far too long for the half of a panel that is left to it"));
    }

    #[test]
    fn a_line_under_a_title_is_broken_where_a_column_has_no_room_for_it() {
        let mut figure = figure(1, Interval::new(2.0, 1.5, 2.5));
        figure.panels[0].subtitle = "80 designs per criterion".into();
        figure.panels.push(figure.panels[0].clone());
        for (sheet, lines) in [(Sheet::Page, 1), (Sheet::Column, 2)] {
            let svg = figure.draw(sheet).unwrap().svg().unwrap();
            assert!(!svg.contains('…'), "{svg}");
            assert_eq!(svg.matches("criterion").count(), 2, "{svg}");
            assert_eq!(svg.matches("80 designs per criterion").count(), 2 * (2 - lines), "{svg}");
        }
    }

    #[test]
    fn an_interval_that_leaves_the_axis_ends_in_an_arrow() {
        let polygons = |high| figure(1, Interval::new(2.0, 1.5, high)).svg().unwrap().matches("<polygon").count();
        assert_eq!(polygons(1e6), polygons(2.0) + 1);
    }
}
