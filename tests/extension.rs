//! What a program outside of armid can add: each trait implemented here from its public interface alone, and put through
//! its law suite.

#[path = "extension/estimator.rs"]
mod estimator;
#[path = "extension/plant.rs"]
mod plant;
#[path = "extension/term.rs"]
mod term;
