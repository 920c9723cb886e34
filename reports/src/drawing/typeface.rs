//! How wide is a text that only the reader's browser will set?
//!
//! An SVG asks for the generic family `sans-serif`, which may be Helvetica, Arial, Roboto or DejaVu Sans. Space is
//! reserved for DejaVu Sans, the widest of these, so a label that fits here fits everywhere. Advance widths are those
//! of DejaVu Sans 2.37 in hundredths of an em; kerning is ignored, which errs on the wide side.

/// Advance widths of the characters U+0020 to U+007E, hundredths of an em.
const ADVANCES: [u8; 95] = [
    32, 40, 46, 84, 64, 95, 78, 27, 39, 39, 50, 84, 32, 36, 32, 34, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 34, 34, 84,
    84, 84, 53, 100, 68, 69, 70, 77, 63, 58, 77, 75, 29, 29, 66, 56, 86, 75, 79, 60, 79, 69, 63, 61, 73, 68, 99, 69,
    61, 69, 39, 34, 39, 84, 50, 50, 61, 63, 55, 63, 62, 35, 63, 63, 28, 28, 58, 28, 97, 63, 61, 63, 63, 41, 52, 39, 63,
    59, 82, 59, 59, 52, 64, 34, 64, 84,
];

/// Bold letters are wider by up to this factor.
const BOLD: f64 = 1.12;

/// Size and weight of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Font {
    /// Size, px.
    pub(crate) size: f64,
    /// Bold or regular.
    pub(crate) bold: bool,
}

impl Font {
    /// Of the figure's title.
    pub(crate) const TITLE: Self = Self { size: 17.0, bold: true };
    /// Of the line under the title.
    pub(crate) const SUBTITLE: Self = Self { size: 13.0, bold: false };
    /// Of a panel's title.
    pub(crate) const PANEL: Self = Self { size: 13.0, bold: true };
    /// Of axis labels and the legend.
    pub(crate) const LABEL: Self = Self { size: 13.0, bold: false };
    /// Of the numbers along an axis.
    pub(crate) const TICK: Self = Self { size: 12.5, bold: false };
    /// Of notes beside lines and of numbers in cells.
    pub(crate) const NOTE: Self = Self { size: 11.5, bold: false };

    /// Of the title of a figure that is read at half its width.
    pub(crate) const LARGE_TITLE: Self = Self { size: 20.0, bold: true };
    /// Of a panel's title in such a figure.
    pub(crate) const LARGE_BOLD: Self = Self { size: 16.0, bold: true };
    /// Of everything else in such a figure.
    pub(crate) const LARGE: Self = Self { size: 16.0, bold: false };

    /// Width that is safe to reserve for `text`, px.
    pub(crate) fn width(self, text: &str) -> f64 {
        let hundredths: f64 = text.chars().map(advance).sum();
        hundredths * 0.01 * self.size * if self.bold { BOLD } else { 1.0 }
    }

    /// `text`, shortened with an ellipsis where it is wider than `width` px.
    pub(crate) fn fit(self, text: &str, width: f64) -> String {
        if self.width(text) <= width {
            return text.to_owned();
        }
        let mut kept = String::new();
        for character in text.chars() {
            kept.push(character);
            if self.width(&kept) + self.width("…") > width {
                kept.pop();
                break;
            }
        }
        let mut kept = kept.trim_end().to_owned();
        kept.push('…');
        kept
    }

    /// `text` broken at spaces into at most `lines` lines of `width` px; the last is shortened where it must be.
    pub(crate) fn wrap(self, text: &str, width: f64, lines: usize) -> Vec<String> {
        let mut broken: Vec<String> = Vec::new();
        let mut line = String::new();
        for word in text.split_whitespace() {
            let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if line.is_empty() || broken.len() + 1 == lines || self.width(&longer) <= width {
                line = longer;
            } else {
                broken.push(std::mem::replace(&mut line, word.to_owned()));
            }
        }
        if !line.is_empty() {
            broken.push(line);
        }
        broken.iter().map(|line| self.fit(line, width)).collect()
    }
}

/// Advance width of one character, hundredths of an em.
fn advance(character: char) -> f64 {
    let code = u32::from(character);
    match code {
        0x20..=0x7E => f64::from(ADVANCES[(code - 0x20) as usize]),
        // Combining marks sit on the letter before them.
        0x0300..=0x036F => 0.0,
        // Superscript and subscript digits and signs; thin spaces; dots.
        0x00B2 | 0x00B3 | 0x00B9 | 0x2070..=0x209C => 53.0,
        0x2009 | 0x202F => 20.0,
        0x00B0 | 0x00B7 | 0x00A0 | 0x2013 => 50.0,
        // Latin, Greek and Cyrillic letters are at most as wide as `ω` and `Ω`; signs such as `−`, `±`, `×` too.
        0x00A1..=0x04FF => 84.0,
        _ => 100.0,
    }
}

#[cfg(test)]
mod tests {
    use super::Font;

    #[test]
    fn published_width_of_a_word_in_dejavu_sans() {
        // Advances of DejaVu Sans 2.37 in units of 1/2048 em: r 842, o 1253, b 1300, t 803.
        let exact = f64::from(842 + 1253 + 1300 + 1253 + 803) / 2048.0 * 100.0;
        assert!((Font { size: 100.0, bold: false }.width("robot") - exact).abs() < 2.5);
    }

    #[test]
    fn analytic_fit_never_exceeds_the_width() {
        let font = Font::LABEL;
        for text in ["", "short", "a long label that cannot stay whole", "βββββββββββββββββββββββββ"]
        {
            for width in [30.0, 80.0, 200.0] {
                assert!(font.width(&font.fit(text, width)) <= width, "{text:?} in {width} px");
            }
        }
    }

    #[test]
    fn analytic_wrap_keeps_every_word_where_there_is_room() {
        let text = "one two three four five six seven eight nine ten";
        let lines = Font::LABEL.wrap(text, 120.0, 10);
        assert!(lines.len() > 1);
        assert_eq!(lines.join(" "), text);
        assert_eq!(Font::LABEL.wrap(text, 120.0, 2).len(), 2);
        assert!(Font::LABEL.wrap("  ", 120.0, 2).is_empty());
    }
}
