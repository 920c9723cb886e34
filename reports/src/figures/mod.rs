//! Kinds of figures, one per file: a plain struct of numbers and names, drawn by [`Figure::svg`].

mod figure;
mod scatter;
mod time_series;

pub use figure::{Figure, Heading};
pub use scatter::{Reference, ScatterFigure, ScatterGroup, ScatterPanel, ScatterPoint};
pub use time_series::{Limit, Line, TimePanel, TimeSeriesFigure};
