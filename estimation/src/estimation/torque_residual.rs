//! How much of the measured torque an estimate leaves unexplained, in a band that does not depend on the processing.
//!
//! ```text
//! e = L (τ − Y_b β̂)        share_i = ‖e_i‖ / ‖L τ_i‖        total = ‖e‖ / ‖L τ‖  over all joints
//! ```
//! L is a zero-phase low pass of order four with a fixed cut-off (that of one pass), the same for measured and predicted
//! torque. A residual of block means is smaller the longer the blocks are, and blocks follow from the cut-off of the
//! positions: this one is comparable between settings, logs and publications that state their band.
//!
//! Shares are given twice: over all samples, and over those in blocks that were equations, which leave out where a joint
//! hardly moves or a channel was at fault.

use super::error::EstimationError;
use super::estimate::Estimate;
use super::prediction::{Model, predict, predict_each};
use crate::regressor::JointTorqueRegressor;
use crate::signal::{Butterworth, Samples};

/// Cut-off of the low pass unless another is asked for, Hz: publications on industrial arms compare torque below it.
pub const DEFAULT_BANDWIDTH_HZ: f64 = 20.0;
/// Largest part of the sampling rate that the cut-off may be.
const LARGEST_PART: f64 = 0.4;

/// Residual and measured torque over some rows.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RowShares {
    /// Samples of each joint, n.
    pub samples: Vec<usize>,
    /// RMS of the residual, n.
    pub rms: Vec<f64>,
    /// RMS of the measured torque, n.
    pub measured_rms: Vec<f64>,
    /// The first over the second, n; `None` where nothing was measured.
    pub share: Vec<Option<f64>>,
    /// RMS of the residual over that of the measured torque, over all joints; `None` where their units differ or nothing was measured.
    pub total: Option<f64>,
}

/// The residual of an estimate on some experiments.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TorqueResidual {
    /// Cut-off of one pass of the low pass, Hz.
    pub bandwidth_hz: f64,
    /// Over the samples of blocks that are equations.
    #[serde(rename = "used_rows")]
    pub used: RowShares,
    /// Over all samples.
    #[serde(rename = "all_rows")]
    pub all: RowShares,
}

/// Measured and predicted torque over time, N × n each, below the same cut-off.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueSeries {
    /// Measured.
    pub measured: Vec<f64>,
    /// Predicted.
    pub predicted: Vec<f64>,
}

/// Sums of squares.
struct Sums {
    residual: Vec<f64>,
    measured: Vec<f64>,
    samples: Vec<usize>,
}

impl Sums {
    fn new(n: usize) -> Self {
        Self { residual: vec![0.0; n], measured: vec![0.0; n], samples: vec![0; n] }
    }

    fn add(&mut self, i: usize, residual: f64, measured: f64) {
        self.residual[i] += residual * residual;
        self.measured[i] += measured * measured;
        self.samples[i] += 1;
    }

    fn shares(self, one_unit: bool) -> RowShares {
        let rms = |sums: &[f64]| -> Vec<f64> {
            sums.iter().zip(&self.samples).map(|(sum, &count)| (sum / count.max(1) as f64).sqrt()).collect()
        };
        let part = |residual: f64, measured: f64| (measured > 0.0).then(|| (residual / measured).sqrt());
        let share = self.residual.iter().zip(&self.measured).map(|(&r, &m)| part(r, m)).collect();
        let total = part(self.residual.iter().sum(), self.measured.iter().sum()).filter(|_| one_unit);
        RowShares { rms: rms(&self.residual), measured_rms: rms(&self.measured), share, total, samples: self.samples }
    }
}

impl TorqueResidual {
    /// The residual on the samples of one or more experiments. `bandwidth_hz` becomes 0.4 of the lowest sampling rate where
    /// that is less.
    ///
    /// # Errors
    /// As [`predict`], and [`EstimationError::Signal`] where the bandwidth is no frequency.
    pub fn new(
        estimate: &Estimate,
        regressor: &JointTorqueRegressor,
        parts: &[Samples],
        bandwidth_hz: f64,
    ) -> Result<Self, EstimationError> {
        Ok(Self::of_each(std::slice::from_ref(estimate), regressor, parts, bandwidth_hz)?.swap_remove(0))
    }

    /// [`Self::new`] of several estimates that share a regressor, which is evaluated once.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_each(
        estimates: &[Estimate],
        regressor: &JointTorqueRegressor,
        parts: &[Samples],
        bandwidth_hz: f64,
    ) -> Result<Vec<Self>, EstimationError> {
        let predicted: Result<Vec<_>, _> =
            parts.iter().map(|part| predict_each(estimates, regressor, &part.states)).collect();
        Self::of_predicted(&predicted?, estimates.len(), parts, bandwidth_hz)
    }

    /// The residual of a model, a robot with all of its parameters, whose torque is its inverse dynamics.
    ///
    /// # Errors
    /// [`EstimationError::Count`] where the samples are of another arm, [`EstimationError::Signal`] as above.
    pub fn of_model(model: &Model<'_>, parts: &[Samples], bandwidth_hz: f64) -> Result<Self, EstimationError> {
        let predicted: Result<Vec<_>, _> =
            parts.iter().map(|part| model.predict(&part.states).map(|one| vec![one])).collect();
        Ok(Self::of_predicted(&predicted?, 1, parts, bandwidth_hz)?.swap_remove(0))
    }

    /// Of `count` predictions of each part.
    fn of_predicted(
        predicted: &[Vec<Vec<f64>>],
        count: usize,
        parts: &[Samples],
        bandwidth_hz: f64,
    ) -> Result<Vec<Self>, EstimationError> {
        let n = parts.first().map_or(0, Samples::dof);
        let bandwidth_hz = parts.iter().fold(bandwidth_hz, |band, part| band.min(LARGEST_PART * part.rate_hz));
        let mut sums: Vec<[Sums; 2]> = (0..count).map(|_| [Sums::new(n), Sums::new(n)]).collect();
        for (samples, predicted) in parts.iter().zip(predicted) {
            let measured = low_passed(samples, &samples.tau, bandwidth_hz)?;
            // A joint without an equation and without torque was not measured.
            let of = |i: usize| (samples.tau.iter().skip(i).step_by(n), samples.used.iter().skip(i).step_by(n));
            let is_measured: Vec<bool> = (0..n)
                .map(|i| {
                    let (mut tau, mut used) = of(i);
                    tau.any(|tau| *tau != 0.0) || used.any(|used| *used)
                })
                .collect();
            for (sums, predicted) in sums.iter_mut().zip(predicted) {
                add_residual(sums, samples, &is_measured, [&measured, &low_passed(samples, predicted, bandwidth_hz)?]);
            }
        }
        let one_unit = parts.iter().all(|part| part.units.iter().all(|unit| *unit == parts[0].units[0]));
        let of = |[used, all]: [Sums; 2]| Self { bandwidth_hz, used: used.shares(one_unit), all: all.shares(one_unit) };
        Ok(sums.into_iter().map(of).collect())
    }
}

impl TorqueSeries {
    /// Both on the samples of one experiment, below a cut-off.
    ///
    /// # Errors
    /// As [`TorqueResidual::new`].
    pub fn new(
        estimate: &Estimate,
        regressor: &JointTorqueRegressor,
        samples: &Samples,
        bandwidth_hz: f64,
    ) -> Result<Self, EstimationError> {
        let predicted = predict(estimate, regressor, &samples.states)?;
        let low_passed = |torque: &[f64]| low_passed(samples, torque, bandwidth_hz);
        Ok(Self { measured: low_passed(&samples.tau)?, predicted: low_passed(&predicted)? })
    }
}

/// Adds to the sums over used and over all rows what some joints (n) leave of measured and predicted torque, N × n each.
fn add_residual(
    [used, all]: &mut [Sums; 2],
    samples: &Samples,
    is_measured: &[bool],
    [measured, predicted]: [&[f64]; 2],
) {
    let n = is_measured.len();
    for (at, (measured, predicted)) in measured.iter().zip(predicted).enumerate().filter(|(at, _)| is_measured[at % n])
    {
        let (k, i) = (at / n, at % n);
        let residual = measured - predicted;
        all.add(i, residual, *measured);
        if samples.used.get(k / samples.block * n + i).is_some_and(|used| *used) {
            used.add(i, residual, *measured);
        }
    }
}

/// Torque of the samples, N × n, below a cut-off.
fn low_passed(samples: &Samples, torque: &[f64], bandwidth_hz: f64) -> Result<Vec<f64>, EstimationError> {
    let filter = Butterworth::new(4, bandwidth_hz, samples.rate_hz)?;
    let is_periodic = samples.period_s.is_some();
    let (filter, n) = (&filter, samples.dof());
    Ok(if is_periodic { filter.zero_phase_periodic(torque, n) } else { filter.zero_phase_reflected(torque, n) })
}

#[cfg(test)]
mod tests {
    use super::TorqueResidual;
    use crate::chains;
    use crate::dynamics::{Dynamics, States};
    use crate::estimation::{EstimatorKind, Identification};
    use crate::model::Columns;
    use crate::regressor::JointTorqueRegressor;
    use crate::seed::Seed;
    use crate::signal::Samples;

    /// An arm that moves slowly, 4000 samples at 500 Hz, and a disturbance of `amplitude` N·m at `hz` on its torque.
    fn samples(hz: f64, amplitude: f64) -> (crate::model::Robot, Samples) {
        let (robot, truth) = chains::random_robot(&mut Seed::new(8).stream("residual", 0), 3);
        let (mut states, mut tau) = (States::new(3), Vec::new());
        for k in 0..4000 {
            let t = f64::from(k) / 500.0;
            let (mut q, mut qd, mut qdd) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for i in 0..3 {
                for l in 1..4 {
                    let w = f64::from(l) * (2.0 + 0.3 * i as f64);
                    q[i] += libm::sin(w * t + i as f64);
                    qd[i] += w * libm::cos(w * t + i as f64);
                    qdd[i] -= w * w * libm::sin(w * t + i as f64);
                }
            }
            let mut one = [0.0; 3];
            Dynamics::new(&robot, &truth).inverse(&q, &qd, &qdd, &mut one);
            states.push(&q, &qd, &qdd);
            tau.extend(one.map(|tau| tau + amplitude * libm::sin(std::f64::consts::TAU * hz * t)));
        }
        (robot, Samples::exact(states, tau, vec!["N·m".to_owned(); 3], 500.0))
    }

    #[test]
    fn analytic_a_disturbance_inside_the_band_is_the_residual_and_one_outside_is_not() {
        for (hz, kept) in [(5.0, 1.0), (150.0, 0.0)] {
            let (robot, samples) = samples(hz, 0.2);
            let identification = Identification::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
            let estimate = identification.estimate(&samples, EstimatorKind::Ols.estimator()).unwrap();
            let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
            let found = TorqueResidual::new(&estimate, &regressor, std::slice::from_ref(&samples), 20.0).unwrap();
            for rms in &found.all.rms {
                // A tone of amplitude 0.2 has the RMS 0.141; the fit takes a little of it away.
                assert!((rms - kept * 0.1414).abs() < 0.01, "{hz} Hz: {rms}");
            }
            assert_eq!((found.all.samples[0], &found.used), (4000, &found.all));
            let total = found.all.total.unwrap();
            let by_hand = found.all.rms.iter().map(|r| r * r).sum::<f64>()
                / found.all.measured_rms.iter().map(|r| r * r).sum::<f64>();
            assert!((total - by_hand.sqrt()).abs() < 1e-12);
        }
    }

    #[test]
    fn identity_estimates_together_leave_the_residual_that_each_leaves_alone() {
        let (robot, samples) = samples(5.0, 0.2);
        let identification = Identification::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
        // The last leaves parameters out.
        let kinds = [EstimatorKind::Ols, EstimatorKind::IrlsHuber, EstimatorKind::Essential];
        let estimate = |kind: &EstimatorKind| identification.estimate(&samples, kind.estimator()).unwrap();
        let estimates: Vec<_> = kinds.iter().map(estimate).collect();
        let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
        let parts = [samples.clone(), samples];
        let alone = |one| TorqueResidual::new(one, &regressor, &parts, 20.0).unwrap();
        let alone: Vec<_> = estimates.iter().map(alone).collect();
        assert_eq!(TorqueResidual::of_each(&estimates, &regressor, &parts, 20.0).unwrap(), alone);
        assert_ne!(alone[0], alone[1]);
    }
}
