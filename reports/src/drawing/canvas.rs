//! A list of shapes in pixels, written as SVG by plotters.
//!
//! plotters places everything on whole pixels, which makes a smooth curve wobble. So shapes are written in tenths of a
//! pixel and shown through a view box ten times as large as the picture. The opening tag with that view box, the title and
//! the description for screen readers is ours, and so are dashes; every element inside is written by plotters.

use plotters::backend::SVGBackend;
use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontFamily, FontStyle, FontTransform, IntoFont, RGBAColor, ShapeStyle, TextStyle};

use super::colour::{Colour, dark_style};
use super::sheet::Sheet;
use super::typeface::Font;
use crate::FigureError;
use crate::heading::Heading;
use crate::style::Marker;

/// Units of the view box per pixel.
pub(super) const UNITS: f64 = 10.0;

/// Colour and width of a stroke, or of a filled shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ink {
    pub(crate) colour: Colour,
    pub(crate) width: f64,
    pub(crate) opacity: f64,
}

impl Ink {
    pub(crate) const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, width, opacity: 1.0 }
    }

    pub(crate) const fn faint(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    fn shape_style(self, filled: bool) -> ShapeStyle {
        let Colour(red, green, blue) = self.colour;
        let stroke_width = (self.width * UNITS).round() as u32;
        ShapeStyle { color: RGBAColor(red, green, blue, self.opacity), filled, stroke_width }
    }
}

/// Where a text stands relative to its anchor point, along the direction of reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    Start,
    Middle,
    End,
}

/// A rectangle, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rect {
    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    pub(crate) fn centre(&self) -> (f64, f64) {
        (0.5 * (self.left + self.right), 0.5 * (self.top + self.bottom))
    }
}

/// What a picture is made of.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    Line {
        points: Vec<(i32, i32)>,
        ink: Ink,
        dashes: &'static [f64],
    },
    Area {
        points: Vec<(i32, i32)>,
        ink: Ink,
    },
    Disc {
        centre: (i32, i32),
        radius: u32,
        ink: Ink,
        filled: bool,
    },
    Dots {
        centres: Vec<(i32, i32)>,
        radius: u32,
        ink: Ink,
    },
    Text {
        text: String,
        at: (i32, i32),
        font: Font,
        colour: Colour,
        align: Align,
        upwards: bool,
    },
    /// What follows shows this text under the pointer, until the end.
    Hover(String),
    HoverEnd,
}

/// The shapes of one picture, in the order in which they are painted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Canvas {
    width: f64,
    height: f64,
    shapes: Vec<Shape>,
}

fn units((x, y): (f64, f64)) -> (i32, i32) {
    // Every coordinate comes from a layout that keeps it near the page; `as` saturates should one not.
    ((x * UNITS).round() as i32, (y * UNITS).round() as i32)
}

impl Canvas {
    pub(crate) fn new(width: f64, height: f64) -> Self {
        let mut canvas = Self { width, height, shapes: Vec::new() };
        canvas.rectangle(&Rect { left: 0.0, top: 0.0, right: width, bottom: height }, Ink::new(Colour::WHITE, 0.0));
        canvas
    }

    /// Width, px.
    pub(crate) const fn width(&self) -> f64 {
        self.width
    }

    pub(super) const fn height(&self) -> f64 {
        self.height
    }

    pub(super) fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    pub(crate) fn line(&mut self, from: (f64, f64), to: (f64, f64), ink: Ink) {
        self.polyline(&[from, to], ink);
    }

    pub(crate) fn polyline(&mut self, points: &[(f64, f64)], ink: Ink) {
        self.dashed(points, &[], ink);
    }

    /// A polyline in strokes and gaps of the given lengths, px.
    pub(crate) fn dashed(&mut self, points: &[(f64, f64)], dashes: &'static [f64], ink: Ink) {
        let mut points: Vec<(i32, i32)> = points.iter().map(|&point| units(point)).collect();
        points.dedup();
        if points.len() > 1 {
            self.shapes.push(Shape::Line { points, ink, dashes });
        }
    }

    pub(crate) fn outline(&mut self, rect: &Rect, ink: Ink) {
        let corners = [
            (rect.left, rect.top),
            (rect.right, rect.top),
            (rect.right, rect.bottom),
            (rect.left, rect.bottom),
            (rect.left, rect.top),
        ];
        self.polyline(&corners, ink);
    }

    pub(crate) fn area(&mut self, points: &[(f64, f64)], ink: Ink) {
        self.shapes.push(Shape::Area { points: points.iter().map(|&point| units(point)).collect(), ink });
    }

    pub(crate) fn rectangle(&mut self, rect: &Rect, ink: Ink) {
        self.area(
            &[(rect.left, rect.top), (rect.right, rect.top), (rect.right, rect.bottom), (rect.left, rect.bottom)],
            ink,
        );
    }

    fn disc(&mut self, centre: (f64, f64), radius: f64, ink: Ink, filled: bool) {
        self.shapes.push(Shape::Disc { centre: units(centre), radius: (radius * UNITS).round() as u32, ink, filled });
    }

    /// Horizontal text whose capitals are centred on `at.1`.
    pub(crate) fn text(&mut self, text: &str, at: (f64, f64), font: Font, colour: Colour, align: Align) {
        self.push_text(text, at, font, colour, align, false);
    }

    /// Text that reads upwards, centred on `at`.
    pub(crate) fn text_upwards(&mut self, text: &str, at: (f64, f64), font: Font, colour: Colour, align: Align) {
        self.push_text(text, at, font, colour, align, true);
    }

    fn push_text(&mut self, text: &str, at: (f64, f64), font: Font, colour: Colour, align: Align, upwards: bool) {
        let text = printable(text);
        if !text.trim().is_empty() {
            self.shapes.push(Shape::Text { text, at: units(at), font, colour, align, upwards });
        }
    }

    /// Text centred on a white rectangle, so that it stays legible on top of lines and points.
    pub(crate) fn note(&mut self, text: &str, at: (f64, f64), font: Font, colour: Colour) {
        let (half_width, half_height) = (0.5 * font.width(text) + 2.0, 0.5 * font.size + 1.0);
        let background = Rect {
            left: at.0 - half_width,
            top: at.1 - half_height,
            right: at.0 + half_width,
            bottom: at.1 + half_height,
        };
        self.rectangle(&background, Ink::new(Colour::WHITE, 0.0).faint(0.8));
        self.text(text, at, font, colour, Align::Middle);
    }

    /// Many discs as one element: half the size of a page of markers, and a tenth when it is printed.
    pub(crate) fn dots(&mut self, centres: &[(f64, f64)], radius: f64, ink: Ink) {
        let centres = centres.iter().map(|&centre| units(centre)).collect();
        self.shapes.push(Shape::Dots { centres, radius: (radius * UNITS).round() as u32, ink });
    }

    /// What `draw` adds shows `text` under the pointer.
    pub(crate) fn hover(&mut self, text: &str, draw: impl FnOnce(&mut Self)) {
        self.shapes.push(Shape::Hover(printable(text)));
        draw(self);
        self.shapes.push(Shape::HoverEnd);
    }

    /// A marker of about `radius` px with a thin white rim that keeps neighbours apart.
    pub(crate) fn marker(&mut self, marker: Marker, at: (f64, f64), radius: f64, colour: Colour, opacity: f64) {
        let rim = 0.8;
        let solid = Ink::new(colour, 0.0).faint(opacity);
        let white = Ink::new(Colour::WHITE, 0.0).faint(opacity);
        let stroke = Ink::new(colour, 1.5).faint(opacity);
        match marker {
            Marker::Circle => {
                self.disc(at, radius + rim, white, true);
                self.disc(at, radius, solid, true);
            }
            Marker::OpenCircle => {
                self.disc(at, radius, white, true);
                self.disc(at, radius - 0.5, stroke, false);
            }
            Marker::Square => {
                self.area(&square(at, radius * 0.9 + rim), white);
                self.area(&square(at, radius * 0.9), solid);
            }
            Marker::OpenSquare => {
                self.area(&square(at, radius * 0.9), white);
                let mut corners = square(at, radius * 0.9 - 0.5).to_vec();
                corners.push(corners[0]);
                self.polyline(&corners, stroke);
            }
            Marker::Triangle => {
                self.area(&triangle(at, radius * 1.2 + 1.6 * rim, -1.0), white);
                self.area(&triangle(at, radius * 1.2, -1.0), solid);
            }
            Marker::TriangleDown => {
                self.area(&triangle(at, radius * 1.2 + 1.6 * rim, 1.0), white);
                self.area(&triangle(at, radius * 1.2, 1.0), solid);
            }
            Marker::Diamond => {
                self.area(&diamond(at, radius * 1.3 + 1.3 * rim), white);
                self.area(&diamond(at, radius * 1.3), solid);
            }
            Marker::Plus => {
                let (x, y) = at;
                self.line((x - radius * 1.1, y), (x + radius * 1.1, y), stroke);
                self.line((x, y - radius * 1.1), (x, y + radius * 1.1), stroke);
            }
            Marker::Cross => {
                let ((x, y), d) = (at, radius * 0.85);
                self.line((x - d, y - d), (x + d, y + d), stroke);
                self.line((x - d, y + d), (x + d, y - d), stroke);
            }
        }
    }

    /// The picture as one SVG element; equal shapes give equal bytes.
    pub(super) fn svg(&self, heading: &Heading, sheet: Sheet) -> Result<String, FigureError> {
        let size = units((self.width, self.height));
        let mut body = String::new();
        for shape in &self.shapes {
            let element =
                element(shape).map_err(|reason| FigureError::Backend { figure: heading.name.clone(), reason })?;
            body.push_str(&element);
        }
        let name = &heading.name;
        let [width, height] = match sheet.millimetres() {
            None => [self.width, self.height].map(|length| length.round().to_string()),
            Some(mm) => [mm, mm * self.height / self.width].map(|length| format!("{length:.2}mm")),
        };
        // Paper is white.
        let style = if sheet == Sheet::Screen { dark_style() } else { String::new() };
        Ok(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\" role=\"img\" stroke-linejoin=\"round\" \
             aria-labelledby=\"{name}-title {name}-desc\">\n<title id=\"{name}-title\">{}</title>\n\
             <desc id=\"{name}-desc\">{}</desc>\n{style}{body}</svg>\n",
            size.0,
            size.1,
            escape(&heading.title),
            escape(&heading.caption),
        ))
    }
}

/// One shape as an SVG element, without the picture that the writer puts around it.
fn element(shape: &Shape) -> Result<String, String> {
    match shape {
        Shape::Hover(text) => return Ok(format!("<g><title>{}</title>\n", escape(text))),
        Shape::HoverEnd => return Ok("</g>\n".to_owned()),
        Shape::Dots { centres, radius, ink } => return Ok(dots(centres, *radius, *ink)),
        _ => {}
    }
    let mut written = String::new();
    {
        let mut backend = SVGBackend::with_string(&mut written, (1, 1));
        paint(&mut backend, shape)?;
        backend.present().map_err(|error| error.to_string())?;
    }
    let element = written.split_once(">\n").map_or("", |(_, rest)| rest);
    let element = element.strip_suffix("</svg>\n").unwrap_or(element);
    // Quotes in texts are escaped, so only attributes match.
    let element = element.replace(" opacity=\"1\"", "");
    Ok(match shape {
        // The writer has no dashes.
        Shape::Line { dashes, .. } if !dashes.is_empty() => {
            let lengths: Vec<String> = dashes.iter().map(|length| format!("{}", (length * UNITS).round())).collect();
            element.replacen("<polyline", &format!("<polyline stroke-dasharray=\"{}\"", lengths.join(" ")), 1)
        }
        _ => element,
    })
}

/// Strokes without length, whose round ends are the discs. The writer has no such element.
fn dots(centres: &[(i32, i32)], radius: u32, Ink { colour: Colour(red, green, blue), opacity, .. }: Ink) -> String {
    let path: String = centres.iter().map(|(x, y)| format!("M{x} {y}h0")).collect();
    let width = 2 * radius;
    format!(
        "<path fill=\"none\" opacity=\"{opacity}\" stroke=\"#{red:02X}{green:02X}{blue:02X}\" stroke-width=\"{width}\" stroke-linecap=\"round\" d=\"{path}\"/>\n"
    )
}

fn paint(backend: &mut SVGBackend<'_>, shape: &Shape) -> Result<(), String> {
    let painted = match shape {
        Shape::Line { points, ink, .. } => backend.draw_path(points.iter().copied(), &ink.shape_style(false)),
        Shape::Area { points, ink } => backend.fill_polygon(points.iter().copied(), &ink.shape_style(true)),
        Shape::Disc { centre, radius, ink, filled } => {
            backend.draw_circle(*centre, *radius, &ink.shape_style(*filled), *filled)
        }
        Shape::Text { text, at, font, colour, align, upwards } => {
            // The writer divides the size by 1.24.
            let described = (FontFamily::SansSerif, font.size * UNITS * 1.24).into_font();
            let described = described.style(if font.bold { FontStyle::Bold } else { FontStyle::Normal });
            let described = if *upwards { described.transform(FontTransform::Rotate270) } else { described };
            let horizontal = match align {
                Align::Start => HPos::Left,
                Align::Middle => HPos::Center,
                Align::End => HPos::Right,
            };
            let colour = RGBAColor(colour.0, colour.1, colour.2, 1.0);
            let style = TextStyle::from(described).color(&colour).pos(Pos::new(horizontal, VPos::Center));
            // With `VPos::Center` the writer lowers the baseline by half an x-height; capitals and digits, which most
            // labels are made of, need a little more.
            let drop = (0.09 * font.size * UNITS).round() as i32;
            let at = if *upwards { (at.0 + drop, at.1) } else { (at.0, at.1 + drop) };
            backend.draw_text(text, &style, at)
        }
        Shape::Dots { .. } | Shape::Hover(_) | Shape::HoverEnd => Ok(()),
    };
    painted.map_err(|error| error.to_string())
}

fn square((x, y): (f64, f64), d: f64) -> [(f64, f64); 4] {
    [(x - d, y - d), (x + d, y - d), (x + d, y + d), (x - d, y + d)]
}

fn diamond((x, y): (f64, f64), d: f64) -> [(f64, f64); 4] {
    [(x, y - d), (x + d, y), (x, y + d), (x - d, y)]
}

/// Equilateral triangle with circumradius `r`; its point is up where `direction` is -1.
fn triangle((x, y): (f64, f64), r: f64, direction: f64) -> [(f64, f64); 3] {
    [(x, y + direction * r), (x + 0.866 * r, y - direction * 0.5 * r), (x - 0.866 * r, y - direction * 0.5 * r)]
}

/// `text` on one line without characters that XML forbids.
fn printable(text: &str) -> String {
    text.chars()
        .map(|character| match character {
            '\n' | '\r' | '\t' => ' ',
            '\u{FFFE}' | '\u{FFFF}' => '\u{FFFD}',
            control if control.is_control() => '\u{FFFD}',
            other => other,
        })
        .collect()
}

/// `text` for the inside of an XML element.
fn escape(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
