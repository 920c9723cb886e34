//! From positions and currents as an arm reports them to parameters, on an exact motion of the A460: Table I at 100 Hz.
//!
//! No servo stands in between, so the motion holds the commanded harmonics alone, and what is measured here is what
//! processing adds: nothing on exact data, a stated tolerance on encoder counts, and error bars that hold under noise.

use crate::model::term::COULOMB;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::coverage::Coverage;
use super::setting::a460_samples_of;
use crate::base::BaseReduction;
use crate::estimation::{Estimate, EstimationProblem, EstimatorKind, IntervalBasis, Observation};
use crate::model::{EffortInterface, Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;
use crate::seed::{Seed, Stream};
use crate::signal::{
    AperiodicRecord, Derivatives, PeriodicRecord, Processing, Samples, SignalError, TorqueFilter, process_aperiodic,
    process_periods, torque_map,
};

/// Samples in one period of 10 s.
const LEN: usize = 1000;
const RATE_HZ: f64 = 100.0;

struct Arm {
    robot: Robot,
    regressor: JointTorqueRegressor,
    base: BaseReduction,
    beta: nalgebra::DVector<f64>,
    /// One period: positions, and currents in A.
    q: Vec<f64>,
    current: Vec<f64>,
}

impl Arm {
    fn new() -> Self {
        Self::of(|_| {})
    }

    fn of(change: impl Fn(&mut StandardParameters)) -> Self {
        let (robot, parameters, regressor, base, samples) = a460_samples_of(LEN, change);
        let per_torque = torque_map(&robot, EffortInterface::Current).try_inverse().unwrap();
        let current = samples
            .tau
            .chunks_exact(6)
            .flat_map(|tau| (&per_torque * nalgebra::DVector::from_column_slice(tau)).as_slice().to_vec())
            .collect();
        let beta = base.beta(&parameters.vector(&robot, regressor.columns()));
        Self { robot, regressor, base, beta, q: samples.states.q, current }
    }

    /// `periods` periods with encoders that count and currents with `noise` times the robot file's noise.
    fn measure(&self, periods: usize, counts: bool, noise: f64, rng: &mut Stream) -> (Vec<f64>, Vec<f64>) {
        let joints = self.robot.joints();
        let steps: Vec<f64> = joints.iter().map(|j| if counts { j.drive.encoder_step(true) } else { 0.0 }).collect();
        let zeros: Vec<f64> = steps.iter().map(|step| step * rng.random_range(-0.5..0.5)).collect();
        let (mut q, mut current) = (self.q.repeat(periods), self.current.repeat(periods));
        for (k, q) in q.iter_mut().enumerate() {
            let (step, zero) = (steps[k % 6], zeros[k % 6]);
            if step > 0.0 {
                *q = ((*q + zero) / step).round() * step - zero;
            }
        }
        for (k, current) in current.iter_mut().enumerate() {
            let z: f64 = StandardNormal.sample(rng);
            *current += noise * joints[k % 6].drive.current_noise * z;
        }
        (q, current)
    }

    fn process(&self, q: &[f64], current: &[f64], processing: &Processing) -> Result<Samples, SignalError> {
        let record = PeriodicRecord { dof: 6, rate_hz: RATE_HZ, period_samples: LEN, q, effort: current };
        process_periods(&record, &self.robot, EffortInterface::Current, 0.5, processing)
    }

    fn estimate(&self, kind: EstimatorKind, samples: &Samples) -> Estimate {
        let observation = Observation::new(&self.robot, &self.regressor, &self.base, samples).unwrap();
        kind.estimator().estimate(&EstimationProblem::new(&observation)).unwrap()
    }

    fn error(&self, samples: &Samples) -> f64 {
        (self.estimate(EstimatorKind::Ols, samples).beta() - &self.beta).norm() / self.beta.norm()
    }
}

fn differences(cutoff_hz: f64) -> Processing {
    Processing { derivatives: Derivatives::Differences, cutoff_hz: Some(cutoff_hz), ..Processing::default() }
}

#[test]
fn identity_exact_positions_give_exact_parameters_on_the_fourier_route() {
    let arm = Arm::new();
    for samples_per_period in [1000, 250, 100] {
        let processing = Processing { samples_per_period, ..Processing::default() };
        let samples = arm.process(&arm.q, &arm.current, &processing).unwrap();
        assert_eq!((samples.len(), samples.blocks(), samples.dof()), (LEN, samples_per_period, 6));
        let error = arm.error(&samples);
        assert!(error < 1e-8, "{samples_per_period}: {error:e}");
    }
}

#[test]
fn identity_differences_converge_with_the_square_of_the_step() {
    // Central differences at 100 Hz take (0.0314)²/12 = 8e-5 off the acceleration at 0.5 Hz and twice that off the
    // velocity; the low pass at 20 Hz nothing that counts.
    let arm = Arm::new();
    let error = arm.error(&arm.process(&arm.q, &arm.current, &differences(20.0)).unwrap());
    assert!((1e-6..1e-3).contains(&error), "{error:e}");
}

#[test]
fn analytic_encoder_counts_without_noise_cost_a_stated_part() {
    // Rounding to 1.6e-5 and 3.1e-5 rad, kept to five harmonics: an acceleration error of some 1e-5 rad/s².
    let arm = Arm::new();
    let (q, current) = arm.measure(2, true, 0.0, &mut Seed::new(41).stream("encoder", 0));
    let samples = arm.process(&q, &current, &Processing::default()).unwrap();
    let error = arm.error(&samples);
    assert!(error < 2e-4, "{error:e}");
    assert!(samples.position_band_hz.iter().all(|&hz| hz < 20.0), "{:?}", samples.position_band_hz);
}

fn coverage(arm: &Arm, processing: &Processing, runs: u64) -> Coverage {
    let seed = Seed::new(42);
    let mut coverage = Coverage::new(arm.base.rank());
    for run in 0..runs {
        let (q, current) = arm.measure(4, true, 1.0, &mut seed.stream("noise", run));
        let samples = arm.process(&q, &current, processing).unwrap();
        let estimate = arm.estimate(EstimatorKind::Wls, &samples);
        assert_eq!(estimate.interval_basis, IntervalBasis::Scatter, "{:?}", estimate.findings);
        coverage.add(&estimate, &arm.beta);
        // What the raw sample scatters is the current's noise through the drive.
        let std = samples.torque_covariance.as_ref().unwrap()[(0, 0)].sqrt();
        assert!((std / (0.020 * 15.0) - 1.0).abs() < 0.1, "{std}");
    }
    coverage
}

#[test]
fn analytic_coverage_of_the_chain_with_counts_and_noisy_currents() {
    let pooled = coverage(&Arm::new(), &Processing::default(), 120).pooled();
    // 120 runs of 58 parameters, correlated within a run: a standard deviation of about 0.6 %.
    assert!((0.925..=0.975).contains(&pooled), "{pooled}");
}

#[test]
fn analytic_coverage_behind_a_low_pass_on_torque() {
    // Without Coulomb friction a low pass on torque biases nothing, and what it does to the noise is seen alone: white
    // error bars would be too short by half.
    let arm = Arm::of(|parameters| parameters.drives.iter_mut().for_each(|drive| drive[COULOMB] = 0.0));
    let processing = Processing {
        torque_filter: TorqueFilter::SameAsPositions,
        samples_per_period: 500,
        reversal_fraction: 0.0,
        ..differences(10.0)
    };
    let (q, current) = arm.measure(4, true, 1.0, &mut Seed::new(43).stream("noise", 0));
    let noise = arm.process(&q, &current, &processing).unwrap().noise.unwrap();
    assert!(noise.length() > 3 && noise.correlation(0, 1) > 0.8, "{}", noise.length());
    let pooled = coverage(&arm, &processing, 30).pooled();
    assert!((0.92..=0.98).contains(&pooled), "{pooled}");
}

#[test]
fn identity_a_record_without_periods() {
    // 1.3 periods of the same motion, as a log that states no period.
    let arm = Arm::new();
    let rows = 6 * 1300;
    let (q, current) = (arm.q.repeat(2)[..rows].to_vec(), arm.current.repeat(2)[..rows].to_vec());
    let record = AperiodicRecord::new(6, RATE_HZ, &q, &current);
    let samples = process_aperiodic(&record, &arm.robot, EffortInterface::Current, 25.0, &differences(20.0)).unwrap();
    assert_eq!((samples.block, samples.periods, samples.noise.is_none()), (4, 1, true));
    let estimate = arm.estimate(EstimatorKind::Wls, &samples);
    assert_eq!(estimate.interval_basis, IntervalBasis::Residual);
    let error = (estimate.beta() - &arm.beta).norm() / arm.beta.norm();
    // Differences at 100 Hz, and both ends continued by reflection.
    assert!(error < 2e-3, "{error:e}");
}

#[test]
fn settings_that_do_not_fit_are_refused() {
    let arm = Arm::new();
    let refused = |processing: &Processing| arm.process(&arm.q, &arm.current, processing).unwrap_err();
    assert!(matches!(refused(&differences(50.0)), SignalError::Cutoff { .. }));
    let few = Processing { samples_per_period: 9, ..Processing::default() };
    assert!(matches!(refused(&few), SignalError::Decimation { found: 8, .. }));
    let none = Processing { samples_per_period: 2, ..Processing::default() };
    assert!(matches!(refused(&none), SignalError::TooFewSamples { found: 2, .. }));
    let fast = Processing { reversal_fraction: 0.7, ..Processing::default() };
    assert!(matches!(refused(&fast), SignalError::Setting { .. }));
    let record = PeriodicRecord { dof: 3, rate_hz: RATE_HZ, period_samples: LEN, q: &arm.q, effort: &arm.current };
    let outcome = process_periods(&record, &arm.robot, EffortInterface::Current, 0.5, &Processing::default());
    assert!(matches!(outcome, Err(SignalError::Joints { found: 3, expected: 6 })));
}
