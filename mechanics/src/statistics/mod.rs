//! The few statistics that estimates and studies report.
//!
//! ```text
//! x̄ ± t_{n−1} s/√n        Welch's interval of a difference, Holm's p-values of many        Wilson's interval of a proportion
//! Spearman's ρ with its interval        two-layer bootstrap
//! ```
//! Distributions, intervals and resampling stand here once, for every module below. Everything that is summed is summed
//! in the order in which it is given, and every function of a distribution comes from `libm`, so that a result depends
//! neither on the number of threads nor on the CPU.

mod bootstrap;
mod chi_squared;
mod difference;
mod distribution;
mod f_distribution;
mod interval;
mod rank_correlation;
mod repeated_interval;
mod sample;

pub use bootstrap::{TwoLayerDraws, percentile_interval};
pub use chi_squared::chi_squared_quantile;
pub use difference::{
    MeanDifference, crossed_difference, holm_adjusted, paired_difference, student_p_value, welch_difference,
};
pub use distribution::{normal_quantile, student_quantile};
pub use f_distribution::f_tail;
pub use interval::{Interval, share_interval, t_interval, wilson_interval};
pub use rank_correlation::{rank_correlation, rank_correlation_interval};
pub use repeated_interval::{pocock_bounds, repeated_interval};
pub use sample::{Spread, mean, quantile, root_mean_square, variance};
