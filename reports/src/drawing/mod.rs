//! What every figure is drawn with: canvas, letters, axes, ticks, legend, panels.

pub(crate) mod axis;
pub(crate) mod canvas;
pub(crate) mod check;
pub(crate) mod colour;
pub(crate) mod drawn;
pub(crate) mod head;
pub(crate) mod large_head;
pub(crate) mod lattice;
pub(crate) mod path;
mod pdf;
pub(crate) mod rows;
pub(crate) mod sheet;
pub(crate) mod ticks;
pub(crate) mod typeface;
