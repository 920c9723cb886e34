//! How much the guess counts: the largest weight that costs no significant error.
//!
//! ```text
//! e_b(w) = misfit of block b by the fit to all other blocks        w* = max { w : Σ e(w) − Σ e(w°) ≤ max(s, 0.01 Σ e(w°)) }
//! ```
//! w° is the weight of the least sum, s the standard error of the sum of differences over the blocks. A hundredth of the sum of squares is
//! half a percent of the error.

use nalgebra::DVector;

use super::equations::NormalEquations;
use super::minimum::Divergence;
use crate::estimation::error::EstimationError;
use crate::observer::{Observer, Progress, Work};

/// Blocks of the log, one after the other.
pub(super) const BLOCKS: usize = 5;

/// Weights that are tried: half decades from 10⁴ down to 10⁻².
const LARGEST_POWER: i32 = 8;
const SMALLEST_POWER: i32 = -4;

/// Part of the least sum of squares that counts as none.
const NO_ERROR: f64 = 0.01;

/// The weights that are tried, from the largest, as far as they are not below `least`.
pub(super) fn down_to(least: f64) -> impl Iterator<Item = f64> {
    let powers = (SMALLEST_POWER..=LARGEST_POWER).rev();
    powers.map(|power| libm::pow(10.0, 0.5 * f64::from(power))).take_while(move |&w| w >= least * (1.0 - 1e-9))
}

/// Which weight was taken, and why.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PriorWeight {
    /// The weight, in nats for each χ² of 2.
    pub taken: f64,
    /// The weight of the least error.
    pub least: f64,
    /// Weights that were tried, from the largest, with their error on blocks that the fit had not seen, as a part of the torque.
    pub tried: Vec<(f64, f64)>,
}

impl PriorWeight {
    /// By cross-validation over the blocks.
    pub(super) fn chosen(
        blocks: &[NormalEquations],
        prior: &Divergence,
        observer: &dyn Observer,
    ) -> Result<Self, EstimationError> {
        let all = NormalEquations::sum(blocks);
        let weights: Vec<f64> = down_to(0.0).collect();
        let centre = prior.centre(all.moment.len());
        let mut starts: Vec<DVector<f64>> = vec![centre; blocks.len()];
        let others: Vec<NormalEquations> = blocks.iter().map(|block| all.without(block)).collect();
        let mut errors = Vec::with_capacity(weights.len());
        for (done, &w) in weights.iter().enumerate() {
            if observer.observe(Progress { work: Work::Steps, done, total: weights.len() }).is_break() {
                return Err(EstimationError::Interrupted);
            }
            let mut of_blocks = Vec::with_capacity(blocks.len());
            for ((block, others), start) in blocks.iter().zip(&others).zip(&mut starts) {
                *start = prior.minimise(others, w, start).x;
                of_blocks.push(block.misfit(start));
            }
            errors.push(of_blocks);
        }
        let sums: Vec<f64> = errors.iter().map(|errors| errors.iter().sum()).collect();
        let best = (0..sums.len()).fold(0, |best, k| if sums[k] < sums[best] { k } else { best });
        let taken = (0..=best).find(|&k| {
            let differences: Vec<f64> = errors[k].iter().zip(&errors[best]).map(|(a, b)| a - b).collect();
            sums[k] - sums[best] <= standard_error_of_sum(&differences).max(NO_ERROR * sums[best])
        });
        let square = all.square.max(f64::MIN_POSITIVE);
        let tried = weights.iter().zip(&sums).map(|(&w, sum)| (w, (sum / square).sqrt())).collect();
        Ok(Self { taken: weights[taken.unwrap_or(best)], least: weights[best], tried })
    }
}

/// Of so many numbers, that of their sum.
fn standard_error_of_sum(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0).max(1.0);
    (count * variance).sqrt()
}

#[cfg(test)]
mod tests {
    use super::standard_error_of_sum;

    #[test]
    fn analytic_standard_error_of_a_sum() {
        // Sums of four with a sample variance of 20/3.
        assert!((standard_error_of_sum(&[1.0, 3.0, 5.0, 7.0]) - (4.0_f64 * 20.0 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(standard_error_of_sum(&[2.0]), 0.0);
    }
}
