//! What a program outside of armid can add: each trait implemented here from its public interface alone, put through its
//! law suite, and used.

#[path = "extension/arm.rs"]
mod arm;
#[path = "extension/criterion.rs"]
mod criterion;
#[path = "extension/estimator.rs"]
mod estimator;
#[path = "extension/plant.rs"]
mod plant;
#[path = "extension/term.rs"]
mod term;
#[path = "extension/trajectory.rs"]
mod trajectory;
