//! What a figure is drawn on: a screen, a column or a page of a journal.

/// What a figure is drawn on. On paper, axis labels are 8 pt high.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sheet {
    /// A screen, 900 px wide.
    #[default]
    Screen,
    /// One column of a journal, 88 mm wide.
    Column,
    /// The whole page of a journal, 181 mm wide.
    Page,
}

const LABEL_POINTS: f64 = 8.0;
const POINTS_PER_MM: f64 = 72.0 / 25.4;

impl Sheet {
    /// Width in mm; a screen has none.
    pub(crate) const fn millimetres(self) -> Option<f64> {
        match self {
            Self::Screen => None,
            Self::Column => Some(88.0),
            Self::Page => Some(181.0),
        }
    }

    /// Width in px of a figure that is `screen` px wide on a screen and whose labels are `label` px high.
    pub(crate) fn width(self, screen: f64, label: f64) -> f64 {
        self.millimetres().map_or(screen, |width| (width * POINTS_PER_MM * label / LABEL_POINTS).round())
    }

    /// `count` panels side by side, or so many as a column of a journal has room for.
    pub(crate) fn panels(self, count: usize, in_a_column: usize) -> usize {
        if self == Self::Column { count.min(in_a_column) } else { count }
    }
}
