//! regressor
