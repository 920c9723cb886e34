//! Tables of text for a person.

/// A table that is printed with two spaces between its columns.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Whether the cells of each column stand to the right.
    is_right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table by its headings, between bars: `#` begins that of a column that stands to the right.
    pub(crate) fn of(headings: &str) -> Self {
        let columns = headings.split(" | ");
        let is_right = columns.clone().map(|heading| heading.starts_with('#')).collect();
        let headings = columns.map(|heading| heading.strip_prefix('#').unwrap_or(heading).to_owned());
        Self { is_right, rows: vec![headings.collect()] }
    }

    /// Adds a row.
    pub(crate) fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The text, each line indented and ended. The last column is broken between words so that no line is longer than
    /// 100 characters.
    pub(crate) fn render(&self, indent: usize) -> String {
        let columns = self.is_right.len();
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
                if c + 1 == columns && !self.is_right[c] {
                    for (k, part) in broken(cell, room).iter().enumerate() {
                        if k > 0 {
                            text.push_str(line.trim_end());
                            text.push('\n');
                            line = " ".repeat(before_last + 2);
                        }
                        line.push_str(part);
                    }
                } else if !self.is_right[c] {
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
    use super::Table;

    #[test]
    fn columns_stand_under_each_other_and_long_cells_are_broken() {
        let mut table = Table::of("name | #value | what");
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
