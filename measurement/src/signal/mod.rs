//! From a recording to samples: period averaging with the noise it reveals, derivatives, joint torque, decimation.
//!
//! ```text
//! x̄[k] = 1/P Σ_p x_p[k]        Σ = 1/(N (P−1)) Σ_p Σ_k e_p[k] e_p[k]ᵀ,   e_p = x_p − x̄
//! ```
//! An experiment repeats one period P times. The average is the signal, the scatter over the periods is the noise:
//! its covariance between joints and its correlation in time are measured, not assumed. Averages of a periodic signal
//! are periodic, so filters run in their steady state and nothing happens at the ends.
//!
//! Two routes to velocity and acceleration: through the Fourier coefficients of the measured positions (Swevers et
//! al.), or zero-phase low pass and central differences (`radkhah2007` IV.B). Torque passes the same low pass.
//! A record without periods goes through [`process_aperiodic`]; its noise is left to the estimator's residual, and its low pass is chosen
//! by the noise of its positions ([`find_cutoff`]).
//!
//! Uneven stamps are brought onto an even grid first ([`resample`]); a break in a record ends a segment, and filters stay
//! inside it. Not here: outliers. Reference: J. Swevers, C. Ganseman, D. B. Tükel, J. De
//! Schutter, H. Van Brussel, *Optimal robot excitation and identification*, IEEE T-RA 13(5), 1997, eqs. 19-22.

mod aperiodic;
mod butterfly;
mod butterworth;
mod calm;
mod columns;
mod covariance_operator;
mod cutoff;
mod differences;
mod error;
mod fourier_transform;
mod harmonics;
mod jerk;
mod join;
mod joined_experiment;
mod lag_products;
mod noise;
mod noise_spectrum;
mod period_average;
mod periodic;
mod processing;
mod recorded;
mod recurrence;
mod resampling;
mod samples;
mod scatter;
mod torque;

pub use aperiodic::{AperiodicRecord, process_aperiodic};
pub use butterworth::Butterworth;
pub use covariance_operator::CovarianceOperator;
pub use cutoff::find_cutoff;
pub use differences::{differences, differences_periodic};
pub use error::SignalError;
pub use fourier_transform::FourierTransform;
pub use harmonics::{Bandwidth, HarmonicSeries};
pub use joined_experiment::JoinedExperiment;
pub use lag_products::LagProducts;
pub use noise::NoiseModel;
pub use period_average::{PeriodAverage, PeriodicRecord};
pub use periodic::process_periods;
pub use processing::{Derivatives, Processing, TorqueFilter};
pub use recorded::process;
pub use recurrence::{Recurrence, recurrence};
pub use resampling::{Interpolation, resample};
pub use samples::Samples;
pub use torque::torque_map;
