//! The report of a study: from its stored result to a page, one file per section.

mod atlas;
mod conditions;
mod convergence;
mod criteria;
mod grid;
mod limits;
mod overview;
mod page;
mod paper;
mod parameters;
mod prediction;
mod rounds;

pub use page::study_document;
