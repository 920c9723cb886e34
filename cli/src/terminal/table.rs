//! Tables of text for a person.

/// How the cells of a column stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Right,
}

/// A table that is printed with two spaces between its columns.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    align: Vec<Align>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings.
    pub(crate) fn new(columns: &[(&str, Align)]) -> Self {
        let headings = columns.iter().map(|(heading, _)| (*heading).to_owned()).collect();
        Self { align: columns.iter().map(|(_, align)| *align).collect(), rows: vec![headings] }
    }

    /// A table by its headings, between bars: `#` begins that of a column that stands to the right.
    pub(crate) fn of(headings: &str) -> Self {
        let columns: Vec<(&str, Align)> = headings
            .split(" | ")
            .map(|heading| heading.strip_prefix('#').map_or((heading, Align::Left), |heading| (heading, Align::Right)))
            .collect();
        Self::new(&columns)
    }

    /// Adds a row.
    pub(crate) fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The text, each line indented and ended. The last column is broken between words so that no line is longer than
    /// 100 characters.
    pub(crate) fn render(&self, indent: usize) -> String {
        let columns = self.align.len();
        let widths: Vec<usize> = (0..columns)
            .map(|c| self.rows.iter().map(|row| row.get(c).map_or(0, |cell| width(cell))).max().unwrap_or(0))
            .collect();
        let before_last: usize = indent + widths[..columns - 1].iter().map(|w| w + 2).sum::<usize>();
        let room = 98_usize.saturating_sub(before_last).max(20);
        let mut text = String::new();
        for row in &self.rows {
            let mut line = " ".repeat(indent);
            for (c, cell) in row.iter().enumerate() {
                let padding = widths[c].saturating_sub(width(cell));
                if c + 1 == columns && self.align[c] == Align::Left {
                    for (k, part) in broken(cell, room).iter().enumerate() {
                        if k > 0 {
                            text.push_str(line.trim_end());
                            text.push('\n');
                            line = " ".repeat(before_last + 2);
                        }
                        line.push_str(part);
                    }
                } else if self.align[c] == Align::Left {
                    line.push_str(cell);
                    line.push_str(&" ".repeat(padding + 2));
                } else {
                    line.push_str(&" ".repeat(padding));
                    line.push_str(cell);
                    line.push_str("  ");
                }
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }
}

/// Columns that a text takes on a terminal.
fn width(text: &str) -> usize {
    text.chars().filter(|c| !('\u{300}'..='\u{36f}').contains(c)).count()
}

fn broken(text: &str, room: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("there is always a line");
        if !line.is_empty() && width(line) + 1 + width(word) > room {
            lines.push(word.to_owned());
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::{Align, Table};

    #[test]
    fn columns_stand_under_each_other_and_long_cells_are_broken() {
        let mut table = Table::new(&[("name", Align::Left), ("value", Align::Right), ("what", Align::Left)]);
        table.row(["q̇1", "1.5", "rad/s"]);
        table.row(["m", "-10", &"word ".repeat(30)]);
        let text = table.render(2);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "  name  value  what");
        assert_eq!(lines[1], "  q̇1      1.5  rad/s");
        assert!(lines.iter().all(|line| line.chars().count() <= 100), "{text}");
        assert_eq!(text.matches("word").count(), 30);
    }
}
