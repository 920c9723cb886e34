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
//!
//! | to | begin at |
//! |---|---|
//! | draw one figure | a struct of [`figures`] and [`Figure::svg`] |
//! | put a page together | [`Document`], [`Section`], [`Table`] |
//! | report a study | [`study_document`] |
//! | set one study on several robots side by side | [`robots_document`] |
//! | draw criteria under single effects on several robots | [`criteria_figure`] |
//! | draw criteria over the size of an effect | [`levels_figure`] |
//! | report an estimate | [`estimate_document`] |
//! | report the comparison of two estimates | [`comparison_document`] |
//! | show a design | [`design_convergence`], [`limits_figure`] |
//!
//! ```
//! use armid_reports::{Axis, Bar, BarFigure, BarRow, Document, Group, Heading, Level, Section};
//!
//! let figure = BarFigure {
//!     heading: Heading::new("limit-use", "Torque is the binding limit"),
//!     value: Axis::linear("share of the limit", "%"),
//!     groups: Group::assign(["condition", "d-optimal"]),
//!     rows: vec![BarRow { label: "torque".into(), bars: vec![Some(Bar::new(91.0)), Some(Bar::new(98.0))] }],
//!     levels: vec![Level::new(100.0, "limit")],
//!     digits: Some(0),
//! };
//! let document = Document::new("Two designs").section(Section::new("Limits").figure(&figure)?);
//! let html = document.html()?;
//! assert!(html.contains("<svg") && html.contains("Torque is the binding limit"));
//! assert_eq!(document.figures().count(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod error;
mod heading;
mod style;
mod drawing;
pub mod figures;
pub mod document;
mod comparison;
mod curve;
mod design;
mod residual;
mod estimate;
mod study;

pub use comparison::{ComparisonInput, Prediction, comparison_document};
pub use design::{design_convergence, limits_figure, poses_figure};
pub use document::{Block, Cell, Column, Document, RenderedFigure, Section, Table};
pub use drawing::axis::{Axis, Scale};
pub use drawing::drawn::Drawing;
pub use drawing::rows::{Band, Level};
pub use drawing::sheet::Sheet;
pub use error::{DocumentError, FigureError};
pub use estimate::{EstimateInput, ParameterRow, ResidualShares, TorqueTrace, estimate_document, torque_figure};
pub use figures::*;
pub use heading::Heading;
pub use residual::{ResidualDiagnostics, ResidualTrace};
pub use study::{criteria_figure, levels_figure, robots_document, study_document};
pub use style::{Dash, Group, GroupStyle, Marker};
