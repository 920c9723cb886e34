//! What every implementation must satisfy, and the random robots to show it on.

pub mod chains;
