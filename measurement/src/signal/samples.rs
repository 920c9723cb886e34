//! The input of estimation: states, torque, and the noise of both.

use std::ops::Range;

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::butterworth::Butterworth;
use super::columns::{column, put_column};
use super::error::SignalError;
use super::fourier_transform::FourierTransform;
use super::harmonics::HarmonicSeries;
use super::joined_experiment::JoinedExperiment;
use super::noise::NoiseModel;
use super::processing::{Derivatives, Processing};
use crate::dynamics::States;
use crate::provenance::Provenance;

/// Processed samples of one experiment: N instants of n joints, uniform in time.
///
/// ```text
/// τ_k = Y(q_k, q̇_k, q̈_k) φ + ε_k        mean of D of them: one equation        E[ε̄_m ε̄_{m+l}ᵀ] = R(l)
/// ```
/// Estimators see the means over blocks of D consecutive samples, on both sides: exactly as true as the equations
/// themselves, for any torque within a block, and white noise stays white.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
pub struct Samples {
    /// Positions, velocities, accelerations, N × n each.
    pub states: States,
    /// Joint coordinates as measured behind the transmissions, N × n, rad (m), where `states` are those of the motors; `None` where
    /// there is one encoder for each joint.
    #[serde(default)]
    pub link_q: Option<Vec<f64>>,
    /// Joint torque, N × n row-major, N·m (N for a prismatic joint).
    pub tau: Vec<f64>,
    /// Unit of each joint's torque.
    pub units: Vec<String>,
    /// Consecutive samples D that make one equation.
    pub block: usize,
    /// Which blocks are an equation of which joint, M × n row-major.
    pub used: Vec<bool>,
    /// Which of the others are no equation only because the joint hardly moves, M × n row-major; empty where there are none.
    #[serde(default)]
    pub slow: Vec<bool>,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// The period that the samples cover once, s; `None` for a record without periods.
    pub period_s: Option<f64>,
    /// Periods that were averaged; 1 where nothing was.
    pub periods: usize,
    /// Covariance of one raw sample of torque, neither averaged nor filtered, n × n, (N·m)²; `None` where fewer than
    /// two periods show no scatter.
    #[serde(with = "crate::plain::matrix::option")]
    pub torque_covariance: Option<DMatrix<f64>>,
    /// Standard deviation of one raw sample of position, per joint, rad (m); `None` as above.
    pub position_noise: Option<Vec<f64>>,
    /// Noise of the means over blocks, after averaging over periods and filter; `None` as above.
    pub noise: Option<NoiseModel>,
    /// How derivatives were taken.
    pub derivatives: Derivatives,
    /// Upper end of the band that positions were kept in, per joint, Hz.
    pub position_band_hz: Vec<f64>,
    /// Power of a Fourier line of a position that is noise, per joint, rad² (m²); empty where it is not known. See
    /// [`HarmonicSeries::floor`](super::HarmonicSeries::floor).
    #[serde(default)]
    pub position_floor: Vec<f64>,
    /// Upper end of the band that torque was kept in, Hz; `None` where it was not filtered.
    pub torque_band_hz: Option<f64>,
    /// Order of one pass of that filter, where it is a Butterworth low pass.
    #[serde(default = "usual_order")]
    pub torque_filter_order: usize,
    /// The experiments that were [joined](Self::join), in their order; empty of one alone.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joined: Vec<JoinedExperiment>,
    /// Version, robot and seed that produced it, where the recording holds them.
    pub provenance: Option<Provenance>,
}

/// Noise over torque below which there is none: no sensor resolves so little.
const NO_NOISE: f64 = 1e-5;

fn usual_order() -> usize {
    Processing::default().filter_order
}

crate::plain::checked_when_read!(Samples, |value| value.check().map(|()| value));

impl Samples {
    /// Tables that have the size that they say.
    pub(super) fn check(&self) -> Result<(), String> {
        let (n, samples) = (self.states.dof, self.states.len());
        if n == 0 || self.block == 0 || !(self.rate_hz.is_finite() && self.rate_hz > 0.0) {
            let (block, rate) = (self.block, self.rate_hz);
            return Err(format!("{n} joints, blocks of {block}, rate_hz {rate}, expected all above zero"));
        }
        let joined = self.joined.iter().fold(0_usize, |sum, of| sum.saturating_add(of.samples));
        if self.joined.iter().any(|of| of.position_band_hz.len() != n || ![0, n].contains(&of.position_floor.len())) {
            return Err(format!("bands or floors of joined experiments, expected {n} entries each"));
        }
        let sizes = [
            ("states.q", self.states.q.len(), samples * n),
            ("states.qd", self.states.qd.len(), samples * n),
            ("states.qdd", self.states.qdd.len(), samples * n),
            ("link_q", self.link_q.as_ref().map_or(samples * n, Vec::len), samples * n),
            ("tau", self.tau.len(), samples * n),
            ("units", self.units.len(), n),
            ("used", self.used.len(), self.blocks() * n),
            ("slow", if self.slow.is_empty() { self.used.len() } else { self.slow.len() }, self.blocks() * n),
            ("position_band_hz", self.position_band_hz.len(), n),
            ("position_floor", self.position_floor.len().max(n), n),
            ("position_noise", self.position_noise.as_ref().map_or(n, Vec::len), n),
            ("rows of torque_covariance", self.torque_covariance.as_ref().map_or(n, DMatrix::nrows), n),
            ("columns of torque_covariance", self.torque_covariance.as_ref().map_or(n, DMatrix::ncols), n),
            ("joints of noise", self.noise.as_ref().map_or(n, NoiseModel::dof), n),
            ("joined", if self.joined.is_empty() { samples } else { joined }, samples),
        ];
        match sizes.into_iter().find(|(_, found, expected)| found != expected) {
            Some((what, found, expected)) => {
                Err(format!("{what} has {found} entries, expected {expected} for {samples} samples of {n} joints"))
            }
            None => Ok(()),
        }
    }

    /// Number of joints n.
    pub fn dof(&self) -> usize {
        self.states.dof
    }

    /// Number of instants N.
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// Torque of sample `k`, n.
    pub fn tau(&self, k: usize) -> &[f64] {
        &self.tau[k * self.dof()..(k + 1) * self.dof()]
    }

    /// Number of equations M of each joint: whole blocks.
    pub fn blocks(&self) -> usize {
        self.len() / self.block.max(1)
    }

    /// Whether the torque has no noise, as that of a rehearsal: its scatter over periods is below 1e-5 of it at every joint. Without
    /// periods it is not known: a log that was smoothed has no noise in its torque, and model errors all the same.
    pub fn is_noise_free(&self) -> bool {
        let n = self.dof();
        let rms = |i: usize| {
            let squares: f64 = self.tau.iter().skip(i).step_by(n).map(|x| x * x).sum();
            (squares / self.len().max(1) as f64).sqrt()
        };
        let covariance = self.torque_covariance.as_ref();
        covariance.is_some_and(|of| (0..n).all(|i| of[(i, i)].max(0.0).sqrt() <= NO_NOISE * rms(i)))
    }

    /// Means over blocks of a row-major table of one row per sample and `width` columns: M × `width`.
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

    /// Torque that was computed from the states, N × n, behind the low pass that the measured one went through; as it is where there was none.
    ///
    /// # Errors
    /// [`SignalError`] where the band is no frequency below half of the rate.
    pub fn filtered_as_torque(&self, torque: Vec<f64>, n: usize) -> Result<Vec<f64>, SignalError> {
        if !self.joined.is_empty() {
            let part = |range: Range<usize>| torque[range.start * n..range.end * n].to_vec();
            let each = self.experiments().map(|(range, of)| self.low_passed(part(range), n, &of));
            return Ok(each.collect::<Result<Vec<_>, _>>()?.concat());
        }
        self.low_passed(torque, n, &self.whole())
    }

    fn low_passed(&self, mut torque: Vec<f64>, n: usize, of: &JoinedExperiment) -> Result<Vec<f64>, SignalError> {
        let Some(band_hz) = of.torque_band_hz else { return Ok(torque) };
        let butterworth = || Butterworth::new(self.torque_filter_order, band_hz, self.rate_hz);
        Ok(match (self.derivatives, of.period_s) {
            (Derivatives::Fourier, Some(period_s)) => {
                let transform = FourierTransform::new(torque.len() / n);
                let last = (band_hz * period_s).round() as usize;
                for i in 0..n {
                    let series = HarmonicSeries::new(&transform, &column(&torque, n, i), period_s).up_to(last);
                    put_column(&mut torque, n, i, &series.samples(&transform).q);
                }
                torque
            }
            (_, Some(_)) => butterworth()?.zero_phase_periodic(&torque, n),
            (_, None) => butterworth()?.zero_phase_reflected(&torque, n),
        })
    }

    /// Returns these samples with some joints (from one) held where they are on average: their own rows are no equations, since friction at
    /// rest is anything up to its largest value.
    #[must_use]
    pub fn with_joints_at_rest(mut self, joints: &[usize]) -> Self {
        let (n, len) = (self.dof(), self.len().max(1) as f64);
        for i in joints.iter().map(|joint| joint - 1) {
            let mean = self.states.q.iter().skip(i).step_by(n).sum::<f64>() / len;
            self.states.q.iter_mut().skip(i).step_by(n).for_each(|q| *q = mean);
            self.states.qd.iter_mut().skip(i).step_by(n).for_each(|qd| *qd = 0.0);
            self.states.qdd.iter_mut().skip(i).step_by(n).for_each(|qdd| *qdd = 0.0);
            for rows in [&mut self.used, &mut self.slow] {
                rows.iter_mut().skip(i).step_by(n).for_each(|row| *row = false);
            }
        }
        self
    }

    /// Returns these samples with the blocks as equations in which a joint hardly moves: a model that is to be used predicts those too.
    #[must_use]
    pub fn with_slow_blocks(mut self) -> Self {
        for (used, slow) in self.used.iter_mut().zip(std::mem::take(&mut self.slow)) {
            *used |= slow;
        }
        self
    }

    /// Returns these samples with the positions of the links from other samples: of the same record, processed with the encoders
    /// behind the transmissions instead of the motors'.
    ///
    /// # Panics
    /// If they are not as many.
    #[must_use]
    pub fn with_link_positions(self, links: &Self) -> Self {
        assert_eq!(links.states.q.len(), self.states.q.len(), "a position of each link beside that of its motor");
        Self { link_q: Some(links.states.q.clone()), ..self }
    }

    /// Leaves out the samples behind the last whole block.
    pub(super) fn keep_whole_blocks(&mut self) {
        let values = self.blocks() * self.block * self.dof();
        let tables = [&mut self.states.q, &mut self.states.qd, &mut self.states.qdd, &mut self.tau];
        for table in tables.into_iter().chain(&mut self.link_q) {
            table.truncate(values);
        }
    }

    /// Samples whose states and torque are known exactly, without noise: for tests and bounds. `tau` is N × n, every sample
    /// is an equation.
    ///
    /// # Panics
    /// If torque and states have not the same size.
    pub fn exact(states: States, tau: Vec<f64>, units: Vec<String>, rate_hz: f64) -> Self {
        assert_eq!(states.q.len(), tau.len(), "one torque per joint and sample");
        Self {
            position_band_hz: vec![0.5 * rate_hz; states.dof],
            used: vec![true; tau.len()],
            slow: Vec::new(),
            states,
            link_q: None,
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
            position_floor: Vec::new(),
            torque_band_hz: None,
            torque_filter_order: usual_order(),
            joined: Vec::new(),
            provenance: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::Samples;
    use crate::dynamics::States;

    #[test]
    fn a_log_has_no_noise_where_its_periods_are_alike_to_the_last_digits() {
        let mut states = States::new(1);
        (0..100).for_each(|_| states.push(&[0.0], &[0.0], &[0.0]));
        let plain = Samples::exact(states, vec![3.0; 100], vec!["N·m".to_owned()], 100.0);
        assert!(!plain.is_noise_free());
        let scattered =
            |std: f64| Samples { torque_covariance: Some(DMatrix::from_element(1, 1, std * std)), ..plain.clone() };
        assert!(scattered(0.0).is_noise_free() && scattered(1e-5).is_noise_free());
        assert!(!scattered(1e-4).is_noise_free());
    }

    #[test]
    fn analytic_means_of_blocks_and_a_low_pass_keep_what_is_constant() {
        let mut states = States::new(1);
        (0..100).for_each(|_| states.push(&[0.0], &[0.0], &[0.0]));
        let plain = Samples::exact(states, vec![3.0; 100], vec!["N·m".to_owned()], 100.0);
        let in_blocks = Samples { block: 4, torque_band_hz: Some(20.0), ..plain };
        let ramp: Vec<f64> = (0..100).map(f64::from).collect();
        let means = in_blocks.block_means(&ramp, 1);
        assert!(
            means.len() == 25 && means.iter().enumerate().all(|(k, mean)| *mean == 4.0 * k as f64 + 1.5),
            "{means:?}"
        );
        let filtered = in_blocks.filtered_as_torque(vec![3.0; 100], 1).unwrap();
        assert!(filtered.len() == 100 && filtered.iter().all(|tau| (tau - 3.0).abs() < 1e-9), "{filtered:?}");
    }
}
