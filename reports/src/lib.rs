//! Figures, tables and pages of armid. This crate computes nothing.
//!
//! Every number that is drawn or printed (a quantile, an interval, a regression line) arrives in the input; what happens here
//! is placing it. So no figure can influence a result, and a report can be made again from stored results alone.
//!
//! Two layers:
//!
//! - [`figures`]: kinds of figures, each a plain struct that [`Figure::svg`] turns into one SVG element. Equal input gives
//!   equal bytes on every machine: coordinates are tenths of a pixel, logarithms come from `libm`. Input that cannot be
//!   drawn gives a [`FigureError`] that names the offending number, never a panic and never an empty picture.
//! - [`document`]: sections of text, figures and tables become one self-contained HTML page and a list of SVG files.

#![forbid(unsafe_code)]

mod error;
mod heading;
mod style;
mod drawing;
pub mod figures;
pub mod document;
mod comparison;
mod design;
mod estimate;
mod study;

pub use comparison::{ComparisonInput, Prediction, comparison_document};
pub use design::{design_convergence, limits_figure};
pub use document::{Block, Cell, Column, Document, RenderedFigure, Section, Table};
pub use drawing::axis::{Axis, Scale};
pub use drawing::rows::{Band, Level};
pub use error::{DocumentError, FigureError};
pub use estimate::{EstimateInput, ParameterRow, ResidualShares, TorqueTrace, estimate_document};
pub use figures::*;
pub use heading::Heading;
pub use study::study_document;
pub use style::{Dash, Group, GroupStyle, Marker};
