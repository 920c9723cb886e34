//! Least squares and rank.
