//! Sections of text, figures and tables, put together as one self-contained page.
//!
//! A [`Document`] owns everything it shows: figures are drawn when they are added, so a page that exists is a page
//! without gaps. [`Document::html`] needs no file and no network beside itself; [`Document::files`] gives the same
//! figures as separate files.

mod page;
mod paragraph;
mod section;
mod table;

pub use section::{Block, Document, RenderedFigure, Section};
pub use table::{Cell, Column, Table};
