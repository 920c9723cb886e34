//! Which torque terms a recording decides.
//!
//! ```text
//! y = W_S β_S + W_T β_T + ε        is β_T = 0?        S the other terms, T one of them
//! ```
//! [`select`] begins with all candidates and leaves out, one by one, the term that three criteria support least, until all that
//! remain are supported by each:
//!
//! | criterion | supports a term where |
//! |---|---|
//! | F-test | the probability of an F as large without the term is below 5 % over the number of candidates |
//! | BIC | r ln N_e − N_e ln(1 + W/(N_e (1 − b/E))) < 0 |
//! | held-out torque | its squared error, weighted with the noise, is smaller with the term, by the 95 % interval of the change |
//!
//! W is the quadratic form of the r coefficients that the term alone determines with *their covariance*, correlation of the noise in time
//! included ([`restriction`]), b the number of base parameters, E of equations, N_e of independent ones: by the raw count, ten samples of
//! correlated noise would count as ten. The F-test alone would report a term that is absent in 5 % of recordings, and the other two can only
//! take away. Lags that are estimated from a short record miss part of a long correlation: with noise that remembers nine tenths of itself, 95
//! independent equations for 36 parameters, 2 of 10 recordings reported such a term.
//!
//! Static friction above Coulomb friction (Stribeck) is offered only where no coefficient of it is below zero by more than three standard
//! deviations: friction that rises from rest is a soft onset, whose speed is searched for before ([`FrictionSpeeds`](super::FrictionSpeeds)).
//!
//! What is left is exchanged, term by term, for what was left out ([`exchange`]), so that no term is reported for which another could stand
//! as well without its name beside it. Terms that depend on temperature, and the lag of the currents, are tested beside the set ([`beyond_motion`]).
//! Where the lag shows, all terms are selected again with it beside every set: a term that stood for part of it would take that part from it.
//!
//! Fails where the model errs in another way: a torque that no candidate has goes to the candidate that resembles it most. What
//! held-out torque of the same motion supports is a prediction, not yet a law of friction.
//!
//! References: G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6(2), 1978; G. V. Bayley, J. M. Hammersley, "The
//! 'effective' number of independent observations in an autocorrelated time series", Supplement to the Journal of the Royal Statistical
//! Society 8(2), 1946; N. R. Draper, H. Smith, "Applied Regression Analysis", Wiley, 1998, chapter 15, for backward elimination.

mod beyond_motion;
#[cfg(test)]
mod beyond_motion_tests;
mod current_lag;
#[cfg(test)]
mod current_lag_tests;
mod evidence;
mod exchange;
mod prediction_error;
mod restriction;
mod search;
mod step;
#[cfg(test)]
mod tests;

pub use beyond_motion::{BeyondMotion, candidate_terms};
pub use evidence::{FTest, HeldOutChange, HeldOutData, Selection, TermEvidence, Verdict};
pub(super) use prediction_error::change_between;
pub use search::select;
