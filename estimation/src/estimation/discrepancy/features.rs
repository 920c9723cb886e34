//! Functions that a missing torque is made of, as groups that share a size.
//!
//! ```text
//! Φ_c(x) = Π_d exp(−(x_d − c_d)² / 2 h_d²)        centres c on a grid of spacing h: Φ Φᵀ is close to a
//!                                                 squared-exponential kernel of length √2 h
//! ```
//! - speed: friction that no law of the model has, finer near rest (inverse hyperbolic sine of the speed)
//! - speed and load: friction of gears under load
//! - position: cogging, converter ripple, springs; load: torque constants that saturate
//! - acceleration and position: elasticity, and motion that is measured with errors
//! - harmonics of the record's own length, by two spectra that fall like those of smooth functions: everything else
//!
//! Three laws have one size in all joints, since drives of one arm are alike: friction in proportion to the load, the rate of the
//! torque (a current loop that lags) and its curvature (elasticity, a lag of second order).
//!
//! Load is the torque of the rigid parameters of the estimate.

use nalgebra::{DMatrix, DVector};

use super::blocks::BlockedEquations;
use crate::estimation::observation::Observation;
use crate::model::term::{LOAD_FRICTION, Scale, TermInput, VISCOUS};

/// Laws whose size all joints share.
pub(super) const SHARED: usize = 3;
/// Speed, as a part of its RMS, at which friction under load has changed its sign.
const AT_REST: f64 = 0.03;
/// Speeds below this part of their RMS are resolved.
const REST: f64 = 0.1;
/// Harmonics at which the weights of the two spectra have fallen to e^-1/4; twice as many are held.
const SPECTRA: [f64; 2] = [3.0, 10.0];

/// Functions of one joint, blocks × functions each.
pub(super) struct Functions {
    /// One function each, N·m for a size of 1: by the same law in every joint.
    pub(super) shared: [DMatrix<f64>; SHARED],
    /// The mean of the squares over a group's rows, summed over its columns, is 1.
    pub(super) own: Vec<DMatrix<f64>>,
    /// What the joint's links take of the torque, of each block.
    pub(super) load: Vec<f64>,
}

/// The functions of each joint.
pub(super) fn of_joints(blocks: &BlockedEquations, observation: &Observation, beta: &[f64]) -> Vec<Functions> {
    // Those of time are the same for all.
    let of_time = SPECTRA.map(|spread| harmonics(blocks.count, spread));
    (0..observation.dof).map(|joint| of_joint(blocks, observation, joint, beta, &of_time)).collect()
}

fn of_joint(
    blocks: &BlockedEquations,
    observation: &Observation,
    joint: usize,
    beta: &[f64],
    of_time: &[DMatrix<f64>],
) -> Functions {
    let column = |matrix: &DMatrix<f64>| -> Vec<f64> { matrix.column(joint).iter().copied().collect() };
    let (q, qd, qdd) = (column(&blocks.q), column(&blocks.qd), column(&blocks.qdd));
    let regressor = blocks.regressor(joint);
    let rigid = DVector::from_fn(beta.len(), |j, _| {
        let id = observation.base.parameters[observation.base.kept[j]];
        if id.kind.link_place().is_some() { beta[j] } else { 0.0 }
    });
    let load: Vec<f64> = (&regressor * rigid).iter().copied().collect();
    let rms = (qd.iter().map(|v| v * v).sum::<f64>() / qd.len() as f64).sqrt();
    let speed: Vec<f64> = qd.iter().map(|v| libm::asinh(v / (REST * rms))).collect();
    // Friction that changes its sign within a block has no rate there.
    let smooth = DVector::from_fn(beta.len(), |j, _| {
        let kind = observation.base.parameters[observation.base.kept[j]].kind;
        if kind.term().is_none_or(|term| term.is_inertia() || term == VISCOUS) { beta[j] } else { 0.0 }
    });
    let torque: Vec<f64> = (&regressor * smooth).iter().copied().collect();
    let rate = differences(&torque, blocks.periodic);
    let curvature = differences(&rate, blocks.periodic);
    let shape = [Scale::new(AT_REST * rms), Scale::new(0.0)];
    let input = |(&qd, &load)| TermInput { q: 0.0, qd, qdd: 0.0, load, warmth: 0.0, shape };
    let friction: Vec<f64> = qd.iter().zip(&load).map(|at| LOAD_FRICTION.torque(&input(at))).collect();
    let shared = [friction, rate, curvature].map(|function| DMatrix::from_column_slice(function.len(), 1, &function));
    let mut own = vec![
        bumps(&[(&speed, 12)]),
        bumps(&[(&speed, 6), (&load, 5)]),
        bumps(&[(&q, 14)]),
        bumps(&[(&load, 8)]),
        bumps(&[(&qdd, 5), (&q, 4)]),
    ];
    own.extend(of_time.iter().cloned());
    for group in &mut own {
        let scale = (group.norm_squared() / blocks.count as f64).sqrt();
        if scale > 0.0 {
            group.unscale_mut(scale);
        }
    }
    Functions { shared, own, load }
}

/// Products of bumps over grids of some variables.
fn bumps(variables: &[(&[f64], usize)]) -> DMatrix<f64> {
    let grids = variables.iter().map(|(values, count)| grid(values, *count));
    let product = |of: DMatrix<f64>, with: DMatrix<f64>| {
        let (rows, columns) = (of.nrows(), of.ncols() * with.ncols());
        let mut out = Vec::with_capacity(rows * columns);
        for b in with.as_slice().chunks_exact(rows.max(1)) {
            for a in of.as_slice().chunks_exact(rows.max(1)) {
                out.extend(a.iter().zip(b).map(|(a, b)| a * b));
            }
        }
        DMatrix::from_vec(rows, columns, out)
    };
    grids.reduce(product).unwrap_or_else(|| DMatrix::zeros(0, 0))
}

/// Bumps over one variable, from its least to its largest value.
fn grid(values: &[f64], count: usize) -> DMatrix<f64> {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    let spacing = (high - low) / (count - 1) as f64;
    DMatrix::from_fn(values.len(), count, |row, at| {
        if spacing > 0.0 {
            let x = (values[row] - low) / spacing - at as f64;
            libm::exp(-0.5 * x * x)
        } else {
            1.0
        }
    })
}

/// Half the difference of the values after and before.
fn differences(values: &[f64], periodic: bool) -> Vec<f64> {
    let m = values.len();
    (0..m)
        .map(|k| {
            let (before, after) =
                if periodic { ((k + m - 1) % m, (k + 1) % m) } else { (k.saturating_sub(1), (k + 1).min(m - 1)) };
            0.5 * (values[after] - values[before])
        })
        .collect()
}

/// Sines and cosines over the record, whose weights fall with the harmonic.
fn harmonics(count: usize, spread: f64) -> DMatrix<f64> {
    let most = ((2.0 * spread) as usize).min(count / 4).max(1);
    DMatrix::from_fn(count, 2 * most, |row, at| {
        let h = (at / 2 + 1) as f64;
        let phase = std::f64::consts::TAU * h * (row as f64 + 0.5) / count as f64;
        let weight = libm::exp(-0.25 * (h / spread) * (h / spread));
        weight * if at % 2 == 0 { libm::cos(phase) } else { libm::sin(phase) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_harmonics_are_orthogonal_and_weigh_less_the_higher_they_are() {
        let (count, spread) = (48, 4.0);
        let columns = harmonics(count, spread);
        let gram = columns.tr_mul(&columns);
        for i in 0..columns.ncols() {
            for j in 0..columns.ncols() {
                // Sampled at the middles, ∑ cos² = ∑ sin² = count/2, and all other products are zero.
                let h = (i / 2 + 1) as f64;
                let expected = if i == j { 0.5 * count as f64 * (-0.5 * (h / spread).powi(2)).exp() } else { 0.0 };
                assert!((gram[(i, j)] - expected).abs() < 1e-12 * count as f64, "{i} {j}: {}", gram[(i, j)]);
            }
        }
    }
}
