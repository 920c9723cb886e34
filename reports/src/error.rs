//! What keeps a figure or a page from being made.

/// Why a figure cannot be drawn. Every variant names the figure and the part of its input that is at fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// There is nothing to draw.
    #[error("figure \"{figure}\": {what} is empty, expected at least one entry")]
    Empty {
        /// Name of the figure.
        figure: String,
        /// The empty part.
        what: String,
    },
    /// A number is NaN, infinite, or beyond what can be placed on an axis.
    #[error("figure \"{figure}\": {what} is {value}, expected a finite number below 1e100 in size")]
    NotFinite {
        /// Name of the figure.
        figure: String,
        /// Which number.
        what: String,
        /// The number found.
        value: f64,
    },
    /// A number that a logarithmic axis or colour map cannot show.
    #[error("figure \"{figure}\": {what} is {value}, expected a number of at least 1e-100 on a logarithmic scale")]
    NotPositive {
        /// Name of the figure.
        figure: String,
        /// Which number.
        what: String,
        /// The number found.
        value: f64,
    },
    /// Two lists that belong together differ in length.
    #[error("figure \"{figure}\": {what} has {found} entries, expected {expected}")]
    Length {
        /// Name of the figure.
        figure: String,
        /// The list.
        what: String,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// Numbers that must ascend do not: a reversed interval, unordered quartiles, time that runs backwards.
    #[error("figure \"{figure}\": {what} runs from {from} to {to}, expected ascending numbers")]
    Order {
        /// Name of the figure.
        figure: String,
        /// Which numbers.
        what: String,
        /// The number that comes first.
        from: f64,
        /// The smaller number that follows it.
        to: f64,
    },
    /// A name that cannot be a file name and an HTML id.
    #[error("figure name \"{name}\": expected lower-case letters, digits and hyphens, starting with a letter")]
    Name {
        /// The name found.
        name: String,
    },
    /// More entries than a page can show.
    #[error("figure \"{figure}\": {what} has {found} entries, expected at most {limit}")]
    TooMany {
        /// Name of the figure.
        figure: String,
        /// The list.
        what: String,
        /// Its length.
        found: usize,
        /// The largest length that stays legible.
        limit: usize,
    },
    /// The SVG writer failed.
    #[error("figure \"{figure}\": the SVG writer failed: {reason}")]
    Backend {
        /// Name of the figure.
        figure: String,
        /// Its message.
        reason: String,
    },
}

/// Why a document cannot be put together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// A figure could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// Two figures have one name, and so one file and one HTML id.
    #[error("two figures are named \"{name}\", expected each name once")]
    DuplicateFigure {
        /// The name found twice.
        name: String,
    },
    /// A table row does not have one cell per column.
    #[error("table \"{table}\": row {row} has {found} cells, expected {expected}")]
    Cells {
        /// Caption of the table.
        table: String,
        /// Row, counted from 1.
        row: usize,
        /// Its number of cells.
        found: usize,
        /// The number of columns.
        expected: usize,
    },
    /// A part that must have content has none.
    #[error("{what} is empty, expected {expected}")]
    Empty {
        /// The empty part.
        what: String,
        /// What it should hold.
        expected: &'static str,
    },
}
