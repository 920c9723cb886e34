//! Ratios to a reference over the size of an effect, panels one below the other, with type large enough for a telephone.

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
use crate::drawing::ticks::ticks;
use crate::drawing::typeface::Font;
use crate::heading::Heading;
use crate::style::{Group, Marker};

/// Ratios with bands over sizes on a logarithmic axis, on which 0 has a place of its own; smaller is better, 1 is the reference.
///
/// All panels share both axes. That of the ratios covers 0.8 to 1.25, every point, and bands from 0.4 to 4; bands are cut
/// off where they reach beyond it.
///
/// ```
/// use armid_reports::{Figure, Group, Heading, Interval, LevelFigure, LevelPanel};
/// let curve = vec![Interval::new(1.6, 1.2, 2.1), Interval::new(0.8, 0.7, 0.9)];
/// let figure = LevelFigure {
///     heading: Heading::new("levels", "A trace of friction ends the lead"),
///     label: "load friction".into(),
///     reference: "D-optimal".into(),
///     groups: Group::assign(["condition number"]),
///     sizes: vec![(0.0, "0 %".into()), (0.05, "5 %".into())],
///     panels: vec![LevelPanel { title: "predicted torque".into(), curves: vec![curve], mark: None }],
/// };
/// assert!(figure.svg().unwrap().contains("5 %"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LevelFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// Label of the axis of sizes.
    pub label: String,
    /// What ratios are relative to.
    pub reference: String,
    /// The groups, at most 3.
    pub groups: Vec<Group>,
    /// The sizes, ascending, each with the text below its place; the first may be 0.
    pub sizes: Vec<(f64, String)>,
    /// The panels, from above.
    pub panels: Vec<LevelPanel>,
}

/// One panel of ratios over sizes.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelPanel {
    /// Its title.
    pub title: String,
    /// One curve per group, one ratio per size.
    pub curves: Vec<Vec<Interval>>,
    /// A size at which the first group reaches the reference, and what to say of it.
    pub mark: Option<(f64, String)>,
}

/// Height of a panel, and of what is between two; height of what is below the last, px.
const TALL: f64 = 176.0;
const BETWEEN: f64 = 62.0;
const BELOW: f64 = 56.0;
/// Left end of the panels, px.
const LEFT: f64 = 52.0;

impl LevelFigure {
    fn check(&self) -> Result<Span, FigureError> {
        let check = Check::heading(&self.heading)?;
        check.text("the label of the axis", &self.label)?;
        check.count("the list of groups", self.groups.len(), 3)?;
        check.count("the list of panels", self.panels.len(), 3)?;
        check.count("the list of sizes", self.sizes.len().saturating_sub(1), 12)?;
        let sizes: Vec<f64> = self.sizes.iter().map(|(size, _)| *size).collect();
        check.ascending("the list of sizes", &sizes)?;
        // The first may be 0, which has no logarithm.
        check.all_on_axis("the list of sizes", &sizes[usize::from(sizes[0] <= 0.0)..], Scale::Log)?;
        let mut reached = vec![0.8, 1.25];
        for panel in &self.panels {
            let name = format!("panel \"{}\"", panel.title);
            check.length(&name, panel.curves.len(), self.groups.len())?;
            for (curve, group) in panel.curves.iter().zip(&self.groups) {
                let name = format!("curve \"{}\" of {name}", group.label);
                check.length(&name, curve.len(), self.sizes.len())?;
                for Interval { point, low, high } in curve {
                    check.all_on_axis(&name, &[*low, *point, *high], Scale::Log)?;
                    check.ascending(&name, &[*low, *point, *high])?;
                    reached.extend([*point, low.clamp(0.4, 4.0), high.clamp(0.4, 4.0)]);
                }
            }
            if let Some((size, _)) = panel.mark {
                check.finite(&format!("the mark of {name}"), size)?;
            }
        }
        // What is below the lowest curve has room for words.
        let span = Span::covering(Scale::Log, reached.into_iter(), 0.0).ok_or_else(|| check.empty("every ratio"))?;
        Ok(span.with_room(Font::LARGE.size + 8.0, 6.0, TALL))
    }

    /// Where a size is between the left and the right end of a panel, from 0 to 1.
    fn place(&self, size: f64) -> f64 {
        let has_zero = self.sizes[0].0 <= 0.0;
        let (first, last) = (self.sizes[usize::from(has_zero)].0, self.sizes[self.sizes.len() - 1].0);
        let zero = if has_zero { 0.17 } else { 0.0 };
        let part = if size <= 0.0 {
            0.0
        } else if last > first {
            (zero + (1.0 - zero) * libm::log(size / first) / libm::log(last / first)).max(0.0)
        } else {
            1.0
        };
        0.04 + 0.91 * part
    }

    /// An entry of the legend.
    fn entry(&self, canvas: &mut Canvas, number: usize, (x, y): (f64, f64)) {
        let Group { label, style } = &self.groups[number];
        canvas.dashed(&[(x, y), (x + 34.0, y)], style.dash.pattern(), Ink::new(style.colour, 2.6));
        canvas.text(label, (x + 41.0, y), Font::LARGE, Colour::TEXT, Align::Start);
    }

    /// Sizes below a panel, as many as fit.
    fn sizes(&self, canvas: &mut Canvas, area: &Rect) {
        let mut free = area.left - 40.0;
        for (size, label) in &self.sizes {
            let (x, half) = (area.left + self.place(*size) * area.width(), 0.5 * Font::LARGE.width(label));
            canvas.line((x, area.bottom), (x, area.bottom + 4.0), Ink::new(Colour::FRAME, 1.0));
            if x - half > free {
                canvas.text(label, (x, area.bottom + 15.0), Font::LARGE, Colour::TEXT, Align::Middle);
                free = x + half + 6.0;
            }
        }
    }

    fn panel(&self, canvas: &mut Canvas, panel: &LevelPanel, area: &Rect, span: Span) {
        let x = |size: f64| area.left + self.place(size) * area.width();
        let y = |ratio: f64| area.bottom - span.fraction(ratio.clamp(span.low, span.high)) * area.height();
        canvas.text(
            &Font::LARGE_BOLD.fit(&panel.title, area.width()),
            (area.left, area.top - 13.0),
            Font::LARGE_BOLD,
            Colour::TEXT,
            Align::Start,
        );
        canvas.rectangle(&Rect { top: y(1.0), ..*area }, Ink::new(Colour::BAND, 0.0));
        for tick in ticks(&span, area.height(), 4.0, |_| Font::LARGE.size) {
            let at = y(tick.value);
            canvas.line((area.left, at), (area.right, at), Ink::new(Colour::GRID, 1.0));
            canvas.text(&tick.label, (area.left - 7.0, at), Font::LARGE, Colour::TEXT, Align::End);
        }
        canvas.line((area.left, y(1.0)), (area.right, y(1.0)), Ink::new(Colour::TEXT, 1.8));
        let words = format!("better than {}", self.reference);
        canvas.text(&words, (area.left + 8.0, area.bottom - 12.0), Font::LARGE, Colour::MUTED, Align::Start);
        for (curve, group) in panel.curves.iter().zip(&self.groups) {
            let at: Vec<(f64, &Interval)> = self.sizes.iter().map(|(size, _)| x(*size)).zip(curve).collect();
            let upper = at.iter().map(|(x, ratio)| (*x, y(ratio.high)));
            let lower = at.iter().rev().map(|(x, ratio)| (*x, y(ratio.low)));
            let band: Vec<(f64, f64)> = upper.chain(lower).collect();
            canvas.area(&band, Ink::new(group.style.colour, 0.0).faint(0.16));
        }
        for (curve, group) in panel.curves.iter().zip(&self.groups) {
            let line: Vec<(f64, f64)> =
                self.sizes.iter().zip(curve).map(|((size, _), ratio)| (x(*size), y(ratio.point))).collect();
            canvas.dashed(&line, group.style.dash.pattern(), Ink::new(group.style.colour, 2.6));
        }
        if let (Some((size, words)), Some(group)) = (&panel.mark, self.groups.first()) {
            let (at, colour) = ((x(*size), y(1.0)), group.style.colour);
            canvas.marker(Marker::OpenCircle, at, 6.5, colour, 1.0);
            let width = Font::LARGE.width(words);
            let left = (at.0 + 14.0).min(area.right - width);
            canvas.note(words, (left + 0.5 * width, at.1 - 18.0), Font::LARGE, colour);
        }
    }
}

impl Figure for LevelFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        let span = self.check()?;
        let entries: Vec<f64> = self.groups.iter().map(|group| 41.0 + Font::LARGE.width(&group.label) + 20.0).collect();
        let head = LargeHead::new(&self.heading, &entries, sheet);
        let (whole, top) = (head.width, head.height + 36.0);
        let label = Font::LARGE.wrap(&self.label, whole - LEFT, 2);
        let panels = self.panels.len() as f64;
        let bottom = top + panels * TALL + (panels - 1.0) * BETWEEN;
        let mut canvas = Canvas::new(whole, bottom + BELOW + 20.0 * (label.len() - 1) as f64);
        head.draw(&mut canvas, |canvas, number, at| self.entry(canvas, number, at));
        for (index, panel) in self.panels.iter().enumerate() {
            let top = top + index as f64 * (TALL + BETWEEN);
            let area = Rect { left: LEFT, top, right: whole - MARGIN, bottom: top + TALL };
            self.panel(&mut canvas, panel, &area, span);
            self.sizes(&mut canvas, &area);
        }
        for (line, words) in label.iter().enumerate() {
            let at = (0.5 * (LEFT + whole - MARGIN), bottom + 39.0 + 20.0 * line as f64);
            canvas.text(words, at, Font::LARGE, Colour::TEXT, Align::Middle);
        }
        Ok(Drawing::new(canvas, &self.heading, sheet))
    }
}

#[cfg(test)]
mod tests {
    use super::{Figure, Group, Heading, Interval, LevelFigure, LevelPanel};

    fn figure(sizes: &[f64], ratio: Interval) -> LevelFigure {
        LevelFigure {
            heading: Heading::new("levels", "Title"),
            label: "size".into(),
            reference: "b".into(),
            groups: Group::assign(["a"]),
            sizes: sizes.iter().map(|size| (*size, format!("{size}"))).collect(),
            panels: vec![LevelPanel { title: "panel".into(), curves: vec![vec![ratio; sizes.len()]], mark: None }],
        }
    }

    #[test]
    fn sizes_that_descend_and_ratios_without_a_logarithm_are_refused() {
        let ratio = Interval::new(2.0, 1.0, 3.0);
        assert!(figure(&[0.0, 0.1, 0.2], ratio).svg().is_ok());
        let error = |sizes: &[f64], ratio| figure(sizes, ratio).svg().unwrap_err().to_string();
        assert!(error(&[0.0, 0.2, 0.1], ratio).contains("the list of sizes"));
        assert!(error(&[0.1, 0.2], Interval::new(2.0, 0.0, 3.0)).contains("curve \"a\" of panel \"panel\""));
    }

    #[test]
    fn identity_zero_and_the_sizes_have_places_in_their_order() {
        let figure = figure(&[0.0, 0.1, 1.0, 10.0], Interval::new(2.0, 1.0, 3.0));
        let [zero, first, middle, last] = [0.0, 0.1, 1.0, 10.0].map(|size| figure.place(size));
        assert!(0.0 < zero && zero < first && (middle - 0.5 * (first + last)).abs() < 1e-12 && last < 1.0);
        // A mark between 0 and the first size is between both, and never left of 0.
        assert!((figure.place(1e-9) - zero).abs() < 1e-12);
    }
}
