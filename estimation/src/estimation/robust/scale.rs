//! Scales of residuals with a breakdown point of one half: the median of absolute values, and the M-scale of Tukey's
//! loss.

use nalgebra::DVector;

use super::loss::biweight_loss;
use crate::estimation::observation::Observation;
use crate::statistics::quantile;

/// Median of |z| for a standard normal z.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Constant of Tukey's loss at which its mean over a standard normal is ½.
pub(super) const S_CONSTANT: f64 = 1.547_64;

/// A scale is not taken for less than this part of the joint's torque: what lies below is rounding.
const ROUNDING: f64 = 1e-14;

/// Relative change of an M-scale at which it is found.
const FOUND: f64 = 1e-14;

/// What the scale of each joint is at least, n: rounding of its torque.
pub(super) fn least_scales(observation: &Observation) -> Vec<f64> {
    let n = observation.dof;
    let rms = |i: usize| {
        let of = observation.y.iter().skip(i).step_by(n);
        (of.clone().map(|y| y * y).sum::<f64>() / of.len().max(1) as f64).sqrt()
    };
    let all: Vec<f64> = (0..n).map(rms).collect();
    let largest = all.iter().fold(0.0_f64, |a, &b| a.max(b));
    let floor = |rms: f64| ROUNDING * [rms, largest].into_iter().find(|size| *size > 0.0).unwrap_or(1.0);
    all.into_iter().map(floor).collect()
}

/// Absolute residuals of joint i's equations.
fn of_joint<'a>(observation: &'a Observation, r: &'a DVector<f64>, i: usize) -> impl Iterator<Item = f64> + 'a {
    let rows = (i..r.len()).step_by(observation.dof);
    rows.filter(|&row| observation.used[row]).map(|row| r[row].abs())
}

/// `median |r| / 0.6745` of each joint, n.
pub(super) fn median_scales(observation: &Observation, r: &DVector<f64>) -> Vec<f64> {
    let least = least_scales(observation);
    let of = |(i, least): (usize, f64)| {
        let all: Vec<f64> = of_joint(observation, r, i).collect();
        let median = quantile(&all, 0.5).unwrap_or(0.0);
        (median / NORMAL_MEDIAN).max(least)
    };
    least.into_iter().enumerate().map(of).collect()
}

/// The M-scale of each joint, n.
pub(super) fn m_scales(observation: &Observation, r: &DVector<f64>) -> Vec<f64> {
    let left = 1.0 - observation.base.rank() as f64 / observation.equations().max(1) as f64;
    let of = |(i, least): (usize, f64)| {
        let all: Vec<f64> = of_joint(observation, r, i).collect();
        m_scale(&all, all.len() as f64 * left).max(least)
    };
    least_scales(observation).into_iter().enumerate().map(of).collect()
}

/// The s with `Σ ρ(r/(c s)) = ½ freedom`; 0 where too few residuals differ from zero.
pub(super) fn m_scale(r: &[f64], freedom: f64) -> f64 {
    if r.is_empty() {
        return 0.0;
    }
    let mut s = quantile(r, 0.5).unwrap_or(0.0) / NORMAL_MEDIAN;
    if s == 0.0 {
        s = r.iter().fold(0.0_f64, |a, &b| a.max(b));
    }
    for _ in 0..10_000 {
        if s == 0.0 {
            return 0.0;
        }
        let sum: f64 = r.iter().map(|r| biweight_loss(r / (S_CONSTANT * s))).sum();
        let next = s * (2.0 * sum / freedom).sqrt();
        if (next - s).abs() <= FOUND * s {
            return next;
        }
        s = next;
    }
    s
}
