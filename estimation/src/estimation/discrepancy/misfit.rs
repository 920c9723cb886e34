//! What a joint's own fit leaves beyond noise: how much, and at which speed or load.
//!
//! ```text
//! s² = σ² (mean r̃² − 1)        over all blocks, and over each fifth of them by |q̇| and by |τ_l|
//! ```
//! r̃ is the whitened residual of the joint's own equations and σ² the variance of a block's noise, so that s is the root mean
//! square of what repeats and no parameter explains.

use super::joint::JointResidual;
use crate::estimation::finding::{Finding, MisfitPart};
use crate::estimation::residual_shape::Against;
use crate::statistics::{holm_adjusted, mean};

/// Chance that a recording without model error has such a finding at all.
const FALSE_ALARM: f64 = 0.05;
/// Parts of the blocks, of equal size, in order of speed or load.
const PARTS: usize = 5;

/// One joint, as its own fit leaves it.
pub(super) struct JointMisfit<'a> {
    /// From zero.
    pub(super) joint: usize,
    pub(super) residual: &'a JointResidual,
    /// Probability that noise alone leaves as much.
    pub(super) p: f64,
    /// Of each block.
    pub(super) speed: &'a [f64],
    /// What its links take of the torque, of each block.
    pub(super) load: &'a [f64],
    /// RMS of its torque.
    pub(super) torque_rms: f64,
    /// Of the torque.
    pub(super) unit: &'a str,
}

/// Findings of all joints whose fit is worse than chance explains, at 5 % over all of them.
pub(super) fn findings(joints: &[JointMisfit<'_>]) -> Vec<Finding> {
    let p: Vec<f64> = joints.iter().map(|of| of.p).collect();
    let found = joints.iter().zip(holm_adjusted(&p)).filter(|(_, p)| *p < FALSE_ALARM);
    found.map(|(of, p)| of.finding(p)).collect()
}

impl JointMisfit<'_> {
    fn finding(&self, p_adjusted: f64) -> Finding {
        let noise = self.residual.unit;
        let beyond = |mean_square: f64| (noise * (mean_square - 1.0).max(0.0)).sqrt();
        let squares = self.residual.squares();
        let speed_unit = if self.unit == "N" { "m/s" } else { "rad/s" };
        let parts = [(Against::Speed, self.speed, speed_unit), (Against::Load, self.load, self.unit)];
        let most = parts
            .into_iter()
            .filter_map(|(against, values, unit)| Some((against, unit, worst_part(&squares, values)?)))
            .max_by(|(_, _, a), (_, _, b)| a.mean_square.total_cmp(&b.mean_square));
        let used: Vec<f64> = squares.iter().flatten().copied().collect();
        Finding::LackOfFit {
            joint: self.joint + 1,
            beyond_noise_rms: beyond(mean(&used)),
            noise_rms: noise.sqrt(),
            torque_rms: self.torque_rms,
            p_adjusted,
            most: most.map(|(against, unit, part)| MisfitPart {
                against,
                range: part.range,
                range_unit: unit.to_owned(),
                rms: beyond(part.mean_square),
            }),
            unit: self.unit.to_owned(),
        }
    }
}

/// The part of the blocks, ordered by size of a value, with the largest mean square.
struct Part {
    range: [f64; 2],
    mean_square: f64,
}

/// `None` where no block is used.
fn worst_part(squares: &[Option<f64>], values: &[f64]) -> Option<Part> {
    let mut used: Vec<(f64, f64)> =
        values.iter().zip(squares).filter_map(|(value, square)| Some((value.abs(), (*square)?))).collect();
    used.sort_by(|a, b| a.0.total_cmp(&b.0));
    let parts = (0..PARTS).filter_map(|k| {
        let part = &used[k * used.len() / PARTS..(k + 1) * used.len() / PARTS];
        let (first, last) = (part.first()?, part.last()?);
        let squares: Vec<f64> = part.iter().map(|(_, square)| *square).collect();
        Some(Part { range: [first.0, last.0], mean_square: mean(&squares) })
    });
    parts.max_by(|a, b| a.mean_square.total_cmp(&b.mean_square))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_worst_fifth_of_the_values_is_found_and_unused_blocks_are_left_out() {
        // Values 20 to 1, of which 18 and 5 are not used: 12 to 15 are the fourth fifth of the others.
        let values: Vec<f64> = (0..20).map(|k| f64::from(20 - k)).collect();
        let square = |value: f64| if (12.0..=15.0).contains(&value) { 9.0 } else { 1.0 };
        let squares: Vec<Option<f64>> =
            values.iter().map(|&value| (value != 5.0 && value != 18.0).then(|| square(value))).collect();
        let worst = worst_part(&squares, &values).unwrap();
        assert_eq!((worst.range, worst.mean_square), ([12.0, 15.0], 9.0));
        assert!(worst_part(&[None], &[1.0]).is_none());
    }
}
