//! Shapes as one page of PDF 1.4 (ISO 32000-1), in points from the lower left corner.

use super::canvas::{Align, Canvas, Ink, Shape, UNITS};
use super::colour::Colour;
use super::sheet::Sheet;
use super::typeface::Font;
use crate::heading::Heading;

/// Widths of U+0020 to U+007E in Helvetica, thousandths of an em (Adobe's font metrics of 1997).
const WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833,
    722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556,
    556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334,
    260, 334, 584,
];
/// Characters of the font Symbol, each with its code.
const SYMBOLS: &str = "−-≤£≥³∞¥→®←¬√Ö≈»∂¶∈Î∑åΔDΓGΣSΩWΦFΘQΛLΠPΨYαaβbγgδdεeζzηhθqιiκkλlμmνnξxπpρrσsτtυuφfχcψyωw";
/// Points in a px of a figure for a screen, of which 96 make an inch.
const POINTS_PER_PX: f64 = 0.75;

/// A run of characters of one font: its name, its codes, its size as a share of the text's, how far it is raised, its width in em.
struct Run {
    font: &'static str,
    codes: Vec<u8>,
    size: f64,
    rise: f64,
    width: f64,
}

/// The page of a figure.
pub(super) fn page(canvas: &Canvas, heading: &Heading, sheet: Sheet) -> Vec<u8> {
    let (width, height) = (canvas.width(), canvas.height());
    let points = sheet.millimetres().map_or(POINTS_PER_PX, |mm| mm * 72.0 / 25.4 / width);
    let place = Place { points, height };
    let mut opacities: Vec<String> = Vec::new();
    let mut content = String::from("0 J 1 j\n");
    for shape in canvas.shapes() {
        content.push_str(&place.shape(shape, &mut opacities));
    }
    let states: String = opacities.iter().enumerate().map(|(k, a)| format!("/O{k} << /ca {a} /CA {a} >> ")).collect();
    let font = |name: &str, encoding: &str| format!("<< /Type /Font /Subtype /Type1 /BaseFont /{name}{encoding} >>");
    let latin = " /Encoding /WinAnsiEncoding";
    // UTF-16 with its mark of order, so that the title may hold any character.
    let title: String = heading.title.encode_utf16().map(|unit| format!("{unit:04X}")).collect();
    let objects = [
        "<< /Type /Catalog /Pages 2 0 R >>".to_owned(),
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
        format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.2} {:.2}] /Contents 4 0 R /Resources << /Font << /R 5 0 R /B 6 0 R /S 7 0 R >> \
             /ExtGState << {states}>> >> >>",
            width * points,
            height * points
        ),
        format!("<< /Length {} >>\nstream\n{content}endstream", content.len()),
        font("Helvetica", latin),
        font("Helvetica-Bold", latin),
        font("Symbol", ""),
        format!("<< /Title <FEFF{title}> >>"),
    ];
    let mut file = String::from("%PDF-1.4\n");
    let mut offsets = String::new();
    for (index, object) in objects.iter().enumerate() {
        offsets.push_str(&format!("{:010} 00000 n \n", file.len()));
        file.push_str(&format!("{} 0 obj\n{object}\nendobj\n", index + 1));
    }
    let (start, count) = (file.len(), objects.len() + 1);
    file.push_str(&format!("xref\n0 {count}\n0000000000 65535 f \n{offsets}"));
    file.push_str(&format!("trailer\n<< /Size {count} /Root 1 0 R /Info 8 0 R >>\nstartxref\n{start}\n%%EOF\n"));
    file.into_bytes()
}

/// From units of the picture to points of the page.
struct Place {
    points: f64,
    height: f64,
}

impl Place {
    fn length(&self, units: f64) -> f64 {
        units / UNITS * self.points
    }

    fn at(&self, (x, y): (i32, i32)) -> (f64, f64) {
        (self.length(f64::from(x)), self.points * self.height - self.length(f64::from(y)))
    }

    fn path(&self, points: &[(i32, i32)]) -> String {
        let step = |(index, &point): (usize, &(i32, i32))| {
            let (x, y) = self.at(point);
            format!("{x:.2} {y:.2} {} ", if index == 0 { "m" } else { "l" })
        };
        points.iter().enumerate().map(step).collect()
    }

    fn stroke(&self, width_px: f64) -> String {
        format!("{:.2} w ", width_px * self.points)
    }

    /// One shape between `q` and `Q`, so that its colour and opacity are its own.
    fn shape(&self, shape: &Shape, opacities: &mut Vec<String>) -> String {
        let mut ink = |Ink { colour: Colour(red, green, blue), opacity, .. }: Ink, operator: &str| {
            let share = |part: u8| f64::from(part) / 255.0;
            let colour = format!("{:.3} {:.3} {:.3} {operator} ", share(red), share(green), share(blue));
            if opacity >= 1.0 {
                return colour;
            }
            let opacity = format!("{opacity:.2}");
            let index = opacities.iter().position(|known| *known == opacity).unwrap_or_else(|| {
                opacities.push(opacity);
                opacities.len() - 1
            });
            format!("{colour}/O{index} gs ")
        };
        let painted = match shape {
            Shape::Line { points, ink: pen, dashes } => {
                let dashes: Vec<String> = dashes.iter().map(|length| format!("{:.2}", length * self.points)).collect();
                let dash = if dashes.is_empty() { String::new() } else { format!("[{}] 0 d ", dashes.join(" ")) };
                format!("{}{}{dash}{}S", ink(*pen, "RG"), self.stroke(pen.width), self.path(points))
            }
            Shape::Area { points, ink: pen } => format!("{}{}h f", ink(*pen, "rg"), self.path(points)),
            Shape::Disc { centre, radius, ink: pen, filled } => {
                let (operator, paint) = if *filled { ("rg", "f") } else { ("RG", "S") };
                let circle = circle(self.at(*centre), self.length(f64::from(*radius)));
                format!("{}{}{circle}{paint}", ink(*pen, operator), self.stroke(pen.width))
            }
            Shape::Dots { centres, radius, ink: pen } => {
                let dot = |&centre: &(i32, i32)| self.path(&[centre, centre]);
                let dots: String = centres.iter().map(dot).collect();
                format!("{}1 J {:.2} w {dots}S", ink(*pen, "RG"), 2.0 * self.length(f64::from(*radius)))
            }
            Shape::Text { text, at, font, colour, align, upwards } => {
                let pen = ink(Ink::new(*colour, 0.0), "rg");
                format!("{pen}{}", self.text(text, self.at(*at), *font, (*align, *upwards)))
            }
            Shape::Hover(_) | Shape::HoverEnd => return String::new(),
        };
        format!("q {painted} Q\n")
    }

    /// Runs of a text, whose capitals are centred on its place.
    fn text(&self, text: &str, (x, y): (f64, f64), font: Font, (align, upwards): (Align, bool)) -> String {
        let size = font.size * self.points;
        let runs = runs(text, font.bold);
        let width = size * runs.iter().map(|run| run.width).sum::<f64>();
        let mut along = match align {
            Align::Start => 0.0,
            Align::Middle => -0.5 * width,
            Align::End => -width,
        };
        let mut written = String::new();
        for run in runs {
            let down = 0.36 * size - run.rise * size;
            let (matrix, x, y) =
                if upwards { ("0 1 -1 0", x + down, y + along) } else { ("1 0 0 1", x + along, y - down) };
            let codes: String = run.codes.iter().map(|code| format!("{code:02X}")).collect();
            written.push_str(&format!(
                "BT /{} {:.2} Tf {matrix} {x:.2} {y:.2} Tm <{codes}> Tj ET ",
                run.font,
                run.size * size
            ));
            along += run.width * size;
        }
        written
    }
}

/// Four Bézier arcs, which leave the circle by less than a thousandth of its radius.
fn circle((x, y): (f64, f64), r: f64) -> String {
    let k = 0.552_284_75 * r;
    let arc = |a: [f64; 6]| {
        format!("{:.2} {:.2} {:.2} {:.2} {:.2} {:.2} c ", x + a[0], y + a[1], x + a[2], y + a[3], x + a[4], y + a[5])
    };
    format!(
        "{:.2} {y:.2} m {}{}{}{}",
        x + r,
        arc([r, k, k, r, 0.0, r]),
        arc([-k, r, -r, k, -r, 0.0]),
        arc([-r, -k, -k, -r, 0.0, -r]),
        arc([k, -r, r, -k, r, 0.0])
    )
}

/// Characters in a row that share font, size and height.
fn runs(text: &str, bold: bool) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for character in text.chars() {
        let Some(next) = run(character, bold) else { continue };
        match runs.last_mut() {
            Some(last) if (last.font, last.size, last.rise) == (next.font, next.size, next.rise) => {
                last.codes.extend(next.codes);
                last.width += next.width;
            }
            _ => runs.push(next),
        }
    }
    runs
}

/// One character; a mark that stands over another is left out, and what neither font has is a question mark.
fn run(character: char, bold: bool) -> Option<Run> {
    let latin = if bold { "B" } else { "R" };
    let plain = |code: u8| {
        let width = WIDTHS.get(usize::from(code).wrapping_sub(32)).map_or(0.556, |&width| f64::from(width) / 1000.0);
        Run { font: latin, codes: vec![code], size: 1.0, rise: 0.0, width: if bold { 1.07 * width } else { width } }
    };
    let small = |code: u8, rise: f64| {
        let run = plain(code);
        Run { size: 0.65, rise, width: 0.65 * run.width, ..run }
    };
    let position = |list: &str| list.chars().position(|known| known == character).map(|index| b"0123456789-+"[index]);
    if let Some(digit) = position("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺") {
        return Some(small(digit, 0.35));
    }
    if let Some(digit) = position("₀₁₂₃₄₅₆₇₈₉₋₊") {
        return Some(small(digit, -0.15));
    }
    let pairs: Vec<char> = SYMBOLS.chars().collect();
    if let Some(pair) = pairs.chunks_exact(2).find(|pair| pair[0] == character) {
        return Some(Run { font: "S", codes: vec![u32::from(pair[1]) as u8], size: 1.0, rise: 0.0, width: 0.57 });
    }
    Some(match u32::from(character) {
        0x0300..=0x036F => return None,
        code @ (0x20..=0x7E | 0xA0..=0xFF) => plain(code as u8),
        0x2009 | 0x202F => Run { size: 0.6, width: 0.17, ..plain(b' ') },
        0x2026 => Run { width: 1.0, ..plain(0x85) },
        0x2013 => plain(0x96),
        0x2014 => Run { width: 1.0, ..plain(0x97) },
        0x2019 => Run { width: 0.222, ..plain(0x92) },
        0x201C => Run { width: 0.333, ..plain(0x93) },
        0x201D => Run { width: 0.333, ..plain(0x94) },
        _ => plain(b'?'),
    })
}

#[cfg(test)]
mod tests {
    use super::{Canvas, Colour, Font, Heading, Ink, Sheet, page, runs};
    use crate::drawing::canvas::Align;

    #[test]
    fn published_offsets_of_objects_are_those_of_the_table() {
        let mut canvas = Canvas::new(390.0, 200.0);
        canvas.text("τ₁ = −1.5×10⁻⁷ N·m (a\\b)", (195.0, 100.0), Font::LABEL, Colour::TEXT, Align::Middle);
        canvas.dots(&[(10.0, 10.0)], 2.0, Ink::new(Colour::TEXT, 0.0).faint(0.5));
        let file = page(&canvas, &Heading::new("name", "Größe"), Sheet::Column);
        let text = String::from_utf8(file).expect("no code above 127 stands in the file");
        // 88 mm are 249.45 pt.
        assert!(text.contains("/MediaBox [0 0 249.45 127.92]"), "{text}");
        let (_, table) = text.split_once("65535 f \n").expect("a table");
        for (index, line) in table.lines().take_while(|line| line.ends_with("n ")).enumerate() {
            let offset: usize = line[..10].parse().expect("ten digits");
            assert!(text[offset..].starts_with(&format!("{} 0 obj\n", index + 1)), "object {}", index + 1);
        }
        let start: usize = text.lines().rev().nth(1).and_then(|line| line.parse().ok()).expect("startxref");
        assert!(text[start..].starts_with("xref\n0 9\n"));
        let (_, rest) = text.split_once("/Length ").expect("a stream");
        let length: usize = rest.split(' ').next().and_then(|digits| digits.parse().ok()).expect("its length");
        let (_, stream) = text.split_once("stream\n").expect("a stream");
        assert!(stream[length..].starts_with("endstream"));
        // The shapes are in it: words, and a dot that is not opaque.
        assert!(stream[..length].contains("Tj") && stream[..length].contains(" gs"), "{stream}");
    }

    #[test]
    fn published_widths_of_a_word_in_helvetica() {
        // Helvetica's metrics: r 333, o 556, b 556, o 556, t 278.
        let width: f64 = runs("robot", false).iter().map(|run| run.width).sum();
        assert!((width - 2.279).abs() < 1e-12);
        let found: Vec<(&str, Vec<u8>)> = runs("ß−β²", false).into_iter().map(|run| (run.font, run.codes)).collect();
        assert_eq!(found, [("R", vec![0xDF]), ("S", vec![b'-', b'b']), ("R", vec![b'2'])]);
    }
}
