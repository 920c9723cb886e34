//! MuJoCo against independent references: its own headers and access functions, Newton–Euler, the other plant.

mod dynamics;
mod layout;
mod loading;
mod motion;
mod refusal;
mod robots;
