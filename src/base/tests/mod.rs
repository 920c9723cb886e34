//! Laws of the reduction: three routes, one K.

mod agreement;
