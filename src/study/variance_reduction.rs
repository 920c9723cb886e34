//! Random numbers that runs of a study share, so that fewer of them tell as much.
//!
//! ```text
//! common noise       run r of start k has the same numbers in every family: the noise of a difference between families has the
//!                    variance 2σ²(1 − ρ), ρ the correlation of their errors
//! antithetic noise   run 2k + 1 has the opposites of the numbers of run 2k: what is odd in the noise, as the error of a linear
//!                    estimate is to first order, falls out of their mean; what is even in it, as a squared error, is the same in both
//! ```
//! (P. W. Glynn and R. Szechtman in *Monte Carlo and Quasi-Monte Carlo Methods 2000*, 2002.) Antithetic runs are therefore for
//! biases; a mean square needs as many pairs as it would runs. Wherever runs are counted as independent, pairs are.

/// A way in which runs share random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VarianceReduction {
    /// One noise in run r of start k of every family.
    CommonNoise,
    /// Opposite noise in the two runs of a pair.
    AntitheticNoise,
}
