//! A matrix of numbers as coloured cells: correlations, or what a wrong model does to every parameter.

use super::Figure;
use crate::FigureError;
use crate::drawing::axis::{Axis, Scale, Span};
use crate::drawing::canvas::{Align, Canvas, Ink, Rect};
use crate::drawing::check::Check;
use crate::drawing::colour::Colour;
use crate::drawing::drawn::Drawing;
use crate::drawing::head::{Head, MARGIN, width_on};
use crate::drawing::lattice::x_ticks;
use crate::drawing::sheet::Sheet;
use crate::drawing::ticks::{compact, powered};
use crate::drawing::typeface::Font;
use crate::heading::Heading;

/// Coloured cells with row and column names and a colour bar.
///
/// ```
/// use armid_reports::{Axis, ColourMap, Figure, HeatFigure, Heading};
/// let figure = HeatFigure {
///     heading: Heading::new("correlation", "m5 and m6 are not identifiable one by one"),
///     rows: vec!["m5".into(), "m6".into()],
///     columns: vec!["m5".into(), "m6".into()],
///     groups: Vec::new(),
///     values: vec![Some(1.0), Some(-0.98), Some(-0.98), Some(1.0)],
///     value: Axis::linear("correlation", "").including(&[-1.0, 1.0]),
///     colours: ColourMap::Signed,
///     digits: 2,
/// };
/// assert!(figure.svg().unwrap().contains("−0.98"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HeatFigure {
    /// Name, title and caption.
    pub heading: Heading,
    /// Names of the rows, at most 120.
    pub rows: Vec<String>,
    /// Names of the columns, at most 80.
    pub columns: Vec<String>,
    /// Names over neighbouring columns, each with their number, from the left; empty for none.
    pub groups: Vec<(String, usize)>,
    /// rows × columns numbers, row by row; `None` is a grey cell.
    pub values: Vec<Option<f64>>,
    /// Name, unit and scale of the numbers; a signed colour map is linear.
    pub value: Axis,
    /// Which colours.
    pub colours: ColourMap,
    /// Digits after the point in the cells, which are printed where they fit.
    pub digits: usize,
}

/// From numbers to colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMap {
    /// White to dark blue.
    Sequential,
    /// Blue below zero, white at zero, vermilion above, symmetric about zero.
    Signed,
}

/// White, and three ever darker blues around that of Okabe and Ito.
const BLUES: [Colour; 4] =
    [Colour(0xFA, 0xFC, 0xFE), Colour(0x9A, 0xC9, 0xE6), Colour(0x00, 0x72, 0xB2), Colour(0x03, 0x24, 0x47)];
/// From white to vermilion.
const REDS: [Colour; 4] =
    [Colour(0xFE, 0xFC, 0xFA), Colour(0xF4, 0xBE, 0x93), Colour(0xD5, 0x5E, 0x00), Colour(0x5C, 0x1F, 0x00)];
/// Cell without a number.
const MISSING: Colour = Colour(0xE2, 0xE2, 0xE2);

/// Colour at `fraction` (0 to 1) of a ramp, linear between its entries.
fn ramp(colours: &[Colour; 4], fraction: f64) -> Colour {
    let place = fraction.clamp(0.0, 1.0) * 3.0;
    let index = (place.floor() as usize).min(2);
    let part = place - index as f64;
    let mix = |from: u8, to: u8| (f64::from(from) + part * (f64::from(to) - f64::from(from))).round() as u8;
    let (from, to) = (colours[index], colours[index + 1]);
    Colour(mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}

impl ColourMap {
    fn colour(self, span: &Span, value: f64) -> Colour {
        match self {
            Self::Sequential => ramp(&BLUES, span.fraction(value)),
            Self::Signed => {
                let size = 2.0 * (span.fraction(value) - 0.5).abs();
                // The darkest quarter of the ramps is left out: white print on it would hide the sign's hue.
                ramp(if value < 0.0 { &BLUES } else { &REDS }, 0.85 * size)
            }
        }
    }
}

/// Whether white print reads better on `colour` than black: relative luminance, with squares for the sRGB curve.
fn dark(Colour(red, green, blue): Colour) -> bool {
    let part = |channel: u8| (f64::from(channel) / 255.0) * (f64::from(channel) / 255.0);
    0.2126 * part(red) + 0.7152 * part(green) + 0.0722 * part(blue) < 0.25
}

impl HeatFigure {
    fn check(&self) -> Result<Span, FigureError> {
        let check = Check::heading(&self.heading)?;
        check.axis("the values", &self.value)?;
        check.count("the list of rows", self.rows.len(), 120)?;
        check.count("the list of columns", self.columns.len(), 80)?;
        if !self.groups.is_empty() {
            let grouped = self.groups.iter().map(|(_, count)| count).sum();
            check.length("the columns of all groups", grouped, self.columns.len())?;
        }
        check.length("the list of values", self.values.len(), self.rows.len() * self.columns.len())?;
        let scale = if self.colours == ColourMap::Signed { Scale::Linear } else { self.value.scale };
        for (index, value) in self.values.iter().enumerate() {
            if let Some(value) = *value {
                let (row, column) = (index / self.columns.len(), index % self.columns.len());
                let name = format!("the value of row \"{}\", column \"{}\"", self.rows[row], self.columns[column]);
                check.on_axis(&name, value, scale)?;
            }
        }
        let values = self.values.iter().flatten().copied();
        if values.clone().next().is_none() {
            return Err(check.empty("every cell"));
        }
        let values = values.chain(self.value.include.iter().copied());
        if self.colours == ColourMap::Signed {
            let size = values.fold(0.0_f64, |size, value| size.max(value.abs()));
            let size = if size > 0.0 { size } else { 1.0 };
            return Ok(Span { scale, low: -size, high: size });
        }
        Span::covering(scale, values, 0.0).ok_or_else(|| check.empty("every cell"))
    }

    /// A number as printed in a cell.
    fn printed(&self, value: f64) -> String {
        if self.value.scale != Scale::Log {
            return compact(value, self.digits);
        }
        // As many digits that count, without a power where the number is of ordinary size.
        let size = value.abs();
        let decade = |limit: &&f64| size >= **limit;
        let decades = [0.1, 1.0, 10.0, 100.0, 1000.0, 1e4];
        if !(0.01..1e5).contains(&size) {
            return powered(value, self.digits.min(3));
        }
        let past = decades.iter().filter(decade).count();
        compact(value, (self.digits + 2).saturating_sub(past))
    }

    fn bar(&self, canvas: &mut Canvas, span: &Span, top: f64, (left, right): (f64, f64)) {
        let steps = 60;
        let width = (right - left) / f64::from(steps);
        for step in 0..steps {
            let fraction = (f64::from(step) + 0.5) / f64::from(steps);
            let colour = match self.colours {
                ColourMap::Sequential => ramp(&BLUES, fraction),
                ColourMap::Signed => self.colours.colour(span, span.low + fraction * (span.high - span.low)),
            };
            let from = left + f64::from(step) * width;
            // Each strip reaches the end and is painted over by the next: no seams.
            let strip = Rect { left: from, top, right, bottom: top + 12.0 };
            canvas.rectangle(&strip, Ink::new(colour, 0.0));
        }
        canvas.outline(&Rect { left, top, right, bottom: top + 12.0 }, Ink::new(Colour::FRAME, 0.8));
        for tick in x_ticks(span, right - left) {
            let x = left + span.fraction(tick.value) * (right - left);
            canvas.line((x, top + 12.0), (x, top + 15.5), Ink::new(Colour::FRAME, 0.9));
            canvas.text(&tick.label, (x, top + 24.0), Font::TICK, Colour::TEXT, Align::Middle);
        }
        let label = Font::LABEL.fit(&self.value.text(), 0.53 * canvas.width());
        canvas.text(&label, (left - 12.0, top + 6.0), Font::LABEL, Colour::TEXT, Align::End);
    }
}

impl Figure for HeatFigure {
    fn heading(&self) -> &Heading {
        &self.heading
    }

    fn draw(&self, sheet: Sheet) -> Result<Drawing, FigureError> {
        let span = self.check()?;
        let (head, width) = (Head::new(&self.heading, &[], sheet), width_on(sheet));
        let widest = |names: &[String], limit: f64| {
            names.iter().map(|name| Font::TICK.width(name)).fold(0.0, f64::max).min(limit)
        };
        let row_names = widest(&self.rows, (0.4 * width).min(220.0));
        let left = MARGIN + row_names + 8.0;
        let cell_width = ((width - 20.0 - left) / self.columns.len() as f64).min(84.0);
        let cell_height = (0.62 * cell_width).clamp(15.5, 34.0);
        let level = widest(&self.columns, 400.0) + 8.0 <= cell_width;
        let column_names = if level { 18.0 } else { widest(&self.columns, 160.0) + 10.0 };
        let bar_top = head.height + 4.0;
        let group_names = if self.groups.is_empty() { 0.0 } else { 24.0 };
        let top = bar_top + 38.0 + column_names + group_names;
        let bottom = top + cell_height * self.rows.len() as f64;
        let mut canvas = Canvas::new(width, bottom + 14.0);
        head.draw(&mut canvas);
        let label = Font::LABEL.width(&self.value.text());
        let bar_left = left.max(MARGIN + label.min(0.53 * width) + 12.0);
        self.bar(&mut canvas, &span, bar_top, (bar_left, (bar_left + 320.0).min(width - 30.0)));

        let printed: Vec<Option<String>> =
            self.values.iter().map(|value| value.map(|value| self.printed(value))).collect();
        let widest_number = printed.iter().flatten().map(|text| Font::NOTE.width(text)).fold(0.0, f64::max);
        let numbers = widest_number + 5.0 <= cell_width;
        for (index, value) in self.values.iter().enumerate() {
            let (row, column) = (index / self.columns.len(), index % self.columns.len());
            let from = (left + column as f64 * cell_width, top + row as f64 * cell_height);
            let cell = Rect { left: from.0, top: from.1, right: from.0 + cell_width, bottom: from.1 + cell_height };
            let colour = value.map_or(MISSING, |value| self.colours.colour(&span, value));
            let text = printed[index].as_deref().unwrap_or("–");
            canvas.hover(&format!("{}, {}: {text}", self.rows[row], self.columns[column]), |canvas| {
                canvas.rectangle(&cell, Ink::new(colour, 0.0));
                if numbers {
                    let ink = if dark(colour) { Colour::WHITE } else { Colour::ON_LIGHT };
                    canvas.text(text, cell.centre(), Font::NOTE, ink, Align::Middle);
                }
            });
        }
        let right = left + cell_width * self.columns.len() as f64;
        let rule = Ink::new(Colour::WHITE, if cell_width > 20.0 { 1.2 } else { 0.6 });
        for row in 1..self.rows.len() {
            let y = top + row as f64 * cell_height;
            canvas.line((left, y), (right, y), rule);
        }
        for column in 1..self.columns.len() {
            let x = left + column as f64 * cell_width;
            canvas.line((x, top), (x, bottom), rule);
        }
        canvas.outline(&Rect { left, top, right, bottom }, Ink::new(Colour::FRAME, 0.8));
        let mut first = 0;
        for (name, count) in &self.groups {
            let edge = |column: usize| left + column as f64 * cell_width;
            let (from, to) = (edge(first), edge(first + count));
            let y = bar_top + 50.0;
            canvas.text(
                &Font::LABEL.fit(name, to - from),
                ((from + to) / 2.0, y),
                Font::LABEL,
                Colour::TEXT,
                Align::Middle,
            );
            canvas.line((from + 4.0, y + 10.0), (to - 4.0, y + 10.0), Ink::new(Colour::FRAME, 0.9));
            if first > 0 {
                canvas.line((from, y + 10.0), (from, bottom), Ink::new(Colour::WHITE, 6.0));
                canvas.line((from, top), (from, bottom), Ink::new(Colour::FRAME, 0.8));
            }
            first += count;
        }
        for (row, name) in self.rows.iter().enumerate() {
            let at = (left - 7.0, top + (row as f64 + 0.5) * cell_height);
            canvas.text(&Font::TICK.fit(name, row_names), at, Font::TICK, Colour::TEXT, Align::End);
        }
        for (column, name) in self.columns.iter().enumerate() {
            let x = left + (column as f64 + 0.5) * cell_width;
            if level {
                canvas.text(name, (x, top - 10.0), Font::TICK, Colour::TEXT, Align::Middle);
            } else {
                let name = Font::TICK.fit(name, column_names - 10.0);
                canvas.text_upwards(&name, (x, top - 6.0), Font::TICK, Colour::TEXT, Align::Start);
            }
        }
        Ok(Drawing::new(canvas, &self.heading, sheet))
    }
}

#[cfg(test)]
mod tests {
    use super::{BLUES, Colour, ColourMap, HeatFigure, Scale, Span, dark, ramp};
    use crate::{Axis, Figure, FigureError, Heading};

    fn grouped(second: usize) -> HeatFigure {
        HeatFigure {
            heading: Heading::new("errors", "Errors at two levels"),
            rows: vec!["tool".into()],
            columns: ["a", "b", "c"].map(str::to_owned).to_vec(),
            groups: vec![("mild".into(), 1), ("severe".into(), second)],
            values: vec![Some(0.954), Some(10.66), Some(1182.3)],
            value: Axis::log("ratio", "").including(&[1.0]),
            colours: ColourMap::Sequential,
            digits: 1,
        }
    }

    #[test]
    fn analytic_groups_stand_over_their_columns_and_numbers_have_the_digits_that_count() {
        let svg = grouped(2).svg().expect("three columns in two groups");
        for text in ["mild", "severe", "0.95", "11", "1182"] {
            assert!(svg.lines().any(|line| line == text), "{text}");
        }
        assert!(matches!(grouped(3).svg(), Err(FigureError::Length { found: 4, expected: 3, .. })));
    }

    #[test]
    fn analytic_ends_and_middle_of_the_maps() {
        assert_eq!(ramp(&BLUES, 0.0), BLUES[0]);
        assert_eq!(ramp(&BLUES, 1.0), BLUES[3]);
        let span = Span { scale: Scale::Linear, low: -2.0, high: 2.0 };
        let Colour(red, green, blue) = ColourMap::Signed.colour(&span, 0.0);
        assert!(red > 0xF8 && green > 0xF8 && blue > 0xF8);
        assert!(!dark(Colour::WHITE) && dark(BLUES[3]));
    }
}
