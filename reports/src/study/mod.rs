//! The report of a study: from its stored result to a page, one file per section.

mod effect_levels;
mod effect_sensitivity;
mod estimators;
mod conditions;
mod convergence;
mod correlations;
mod criteria;
mod criteria_on_robots;
mod grid;
mod limits;
mod motions;
mod overview;
mod page;
mod parameters;
mod prediction;
mod radkhah2007;
mod robots;
mod rounds;
mod selection;
mod titles;

pub use criteria_on_robots::criteria_figure;
pub use effect_levels::levels_figure;
pub use page::study_document;
pub use robots::robots_document;
