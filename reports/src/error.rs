//! What keeps a figure or a page from being made.

/// Why a figure cannot be drawn. Every variant names the figure and the part of its input that is at fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
#[non_exhaustive]
pub enum FigureError {
    /// There is nothing to draw.
    #[error("figure \"{figure}\": {what} is empty, expected at least one entry")]
    Empty { figure: String, what: String },
    /// A number is NaN, infinite, or beyond what can be placed on an axis.
    #[error("figure \"{figure}\": {what} is {value}, expected a finite number below 1e100 in size")]
    NotFinite { figure: String, what: String, value: f64 },
    /// A number that a logarithmic axis or colour map cannot show.
    #[error("figure \"{figure}\": {what} is {value}, expected a number of at least 1e-100 on a logarithmic scale")]
    NotPositive { figure: String, what: String, value: f64 },
    /// Two lists that belong together differ in length.
    #[error("figure \"{figure}\": {what} has {found} entries, expected {expected}")]
    Length { figure: String, what: String, found: usize, expected: usize },
    /// Numbers that must ascend do not: a reversed interval, unordered quartiles, time that runs backwards.
    #[error("figure \"{figure}\": {what} runs from {from} to {to}, expected ascending numbers")]
    Order { figure: String, what: String, from: f64, to: f64 },
    /// A name that cannot be a file name and an HTML id.
    #[error("figure name \"{name}\": expected lower-case letters, digits and hyphens, starting with a letter")]
    Name { name: String },
    /// More entries than a page can show.
    #[error("figure \"{figure}\": {what} has {found} entries, expected at most {limit}")]
    TooMany { figure: String, what: String, found: usize, limit: usize },
    /// The SVG writer failed.
    #[error("figure \"{figure}\": the SVG writer failed: {reason}")]
    Backend { figure: String, reason: String },
}

/// Why a document cannot be put together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
#[non_exhaustive]
pub enum DocumentError {
    /// A figure could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// Two figures have one name, and so one file and one HTML id.
    #[error("two figures are named \"{name}\", expected each name once")]
    DuplicateFigure { name: String },
    /// A table row does not have one cell per column.
    #[error("table \"{table}\": row {row} has {found} cells, expected {expected}")]
    Cells { table: String, row: usize, found: usize, expected: usize },
    /// A part that must have content has none.
    #[error("{what} is empty, expected {expected}")]
    Empty { what: String, expected: &'static str },
}
