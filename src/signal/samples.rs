//! The input of estimation: states, torque, and the noise of both.

use nalgebra::DMatrix;

use super::{Derivatives, NoiseModel};
use crate::dynamics::States;
use crate::provenance::Provenance;

/// Processed samples of one experiment: N instants of n joints, uniform in time.
///
/// ```text
/// τ_k = Y(q_k, q̇_k, q̈_k) φ + ε_k        mean of D of them: one equation        E[ε̄_m ε̄_{m+l}ᵀ] = R(l)
/// ```
/// Estimators see the means over blocks of D consecutive samples, on both sides: exactly as true as the equations
/// themselves, for any torque within a block, and white noise stays white.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Positions, velocities, accelerations, N × n each.
    pub states: States,
    /// Joint torque, N × n row-major, N·m (N for a prismatic joint).
    pub tau: Vec<f64>,
    /// Unit of each joint's torque.
    pub units: Vec<String>,
    /// Consecutive samples D that make one equation.
    pub block: usize,
    /// Which blocks are an equation of which joint, M × n row-major.
    pub used: Vec<bool>,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// The period that the samples cover once, s; `None` for a record without periods.
    pub period_s: Option<f64>,
    /// Periods that were averaged; 1 where nothing was.
    pub periods: usize,
    /// Covariance of one raw sample of torque, neither averaged nor filtered, n × n, (N·m)²; `None` where fewer than
    /// two periods show no scatter.
    pub torque_covariance: Option<DMatrix<f64>>,
    /// Standard deviation of one raw sample of position, per joint, rad (m); `None` as above.
    pub position_noise: Option<Vec<f64>>,
    /// Noise of the means over blocks, after averaging over periods and filter; `None` as above.
    pub noise: Option<NoiseModel>,
    /// How derivatives were taken.
    pub derivatives: Derivatives,
    /// Upper end of the band that positions were kept in, per joint, Hz.
    pub position_band_hz: Vec<f64>,
    /// Upper end of the band that torque was kept in, Hz; `None` where it was not filtered.
    pub torque_band_hz: Option<f64>,
    /// Version, robot and seed that produced it, where the recording holds them.
    pub provenance: Option<Provenance>,
}

impl Samples {
    /// Number of joints n.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.states.dof
    }

    /// Number of instants N.
    #[must_use]
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Whether there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// Torque of sample `k`, n.
    #[must_use]
    pub fn tau(&self, k: usize) -> &[f64] {
        &self.tau[k * self.dof()..(k + 1) * self.dof()]
    }

    /// Number of equations M of each joint: whole blocks.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.len() / self.block.max(1)
    }

    /// Means over blocks of a row-major table of one row per sample and `width` columns: M × `width`.
    #[must_use]
    pub fn block_means(&self, rows: &[f64], width: usize) -> Vec<f64> {
        let scale = 1.0 / self.block as f64;
        let mut means = vec![0.0; self.blocks() * width];
        for (mean, block) in means.chunks_exact_mut(width).zip(rows.chunks_exact(self.block * width)) {
            for row in block.chunks_exact(width) {
                for (mean, value) in mean.iter_mut().zip(row) {
                    *mean += value * scale;
                }
            }
        }
        means
    }

    /// Samples whose states and torque are known exactly, without noise: for tests and bounds. `tau` is N × n, every sample
    /// is an equation.
    ///
    /// # Panics
    /// If torque and states have not the same size.
    #[must_use]
    pub fn exact(states: States, tau: Vec<f64>, units: Vec<String>, rate_hz: f64) -> Self {
        assert_eq!(states.q.len(), tau.len(), "one torque per joint and sample");
        Self {
            position_band_hz: vec![0.5 * rate_hz; states.dof],
            used: vec![true; tau.len()],
            states,
            tau,
            units,
            block: 1,
            rate_hz,
            period_s: None,
            periods: 1,
            torque_covariance: None,
            position_noise: None,
            noise: None,
            derivatives: Derivatives::Fourier,
            torque_band_hz: None,
            provenance: None,
        }
    }
}
