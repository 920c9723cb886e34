//! Laws of the reduction on many robots: three routes, one K.

mod a460;
mod agreement;
mod chains;
mod formulas;
mod gautier_khalil;
mod moving_base;
mod trajectory;
