//! The live view of `armid monitor`: what is seen, as a frame of a terminal.

mod bar;
mod panel;
mod view;

pub(crate) use panel::{draw, text};
pub(crate) use view::View;
