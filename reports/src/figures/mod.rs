//! Kinds of figures, one per file: a plain struct of numbers and names, drawn by [`Figure::svg`].

mod bars;
mod boxes;
mod convergence;
mod figure;
mod heat;
mod interval;
mod levels;
mod poses;
mod ratios;
mod scatter;
mod time_series;

pub use bars::{Bar, BarFigure, BarRow};
pub use boxes::{BoxFigure, BoxRow, Distribution, Quantiles};
pub use convergence::{ConvergenceFigure, ConvergencePanel, Curve};
pub use figure::Figure;
pub use heat::{ColourMap, HeatFigure};
pub use interval::{CoverageFigure, CoverageRow, Interval, IntervalFigure, IntervalRow};
pub use levels::{LevelFigure, LevelPanel};
pub use poses::{Pose, PosesFigure};
pub use ratios::{Ratio, RatioFigure, RatioPanel};
pub use scatter::{Reference, ScatterFigure, ScatterGroup, ScatterPanel, ScatterPoint};
pub use time_series::{Limit, Line, TimePanel, TimeSeriesFigure};
