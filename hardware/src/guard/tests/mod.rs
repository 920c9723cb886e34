//! The guard on a virtual clock.

mod clean;
mod laws;
mod machine;
mod reaction;
mod stage;
