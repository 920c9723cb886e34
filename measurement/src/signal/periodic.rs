//! Periods of raw samples to one period of processed ones.

use super::butterworth::Butterworth;
use super::columns::{column, put_column, put_motion};
use super::differences::differences_periodic;
use super::error::SignalError;
use super::fourier_transform::FourierTransform;
use super::harmonics::{Bandwidth, HarmonicSeries};
use super::noise::NoiseModel;
use super::period_average::{PeriodAverage, PeriodicRecord};
use super::processing::{Derivatives, Processing, TorqueFilter};
use super::samples::Samples;
use super::scatter::Scatter;
use super::torque::{map_rows, torque_map};
use crate::dynamics::States;
use crate::model::{EffortInterface, Robot};

/// Processes whole periods: average, derivatives, torque, thinning, and the noise of the result.
///
/// `effort` is the kind of the record's efforts; `highest_hz` is the highest commanded frequency, which is always kept.
///
/// # Errors
/// [`SignalError`] where the record is malformed or a setting does not fit it.
pub fn process_periods(
    record: &PeriodicRecord<'_>,
    robot: &Robot,
    effort: EffortInterface,
    highest_hz: f64,
    processing: &Processing,
) -> Result<Samples, SignalError> {
    processing.check()?;
    record.check()?;
    let n = record.dof;
    if robot.dof() != n {
        return Err(SignalError::Joints { found: n, expected: robot.dof() });
    }
    let torque = map_rows(record.effort, &torque_map(robot, effort));
    let record = PeriodicRecord { effort: &torque, ..*record };
    let average = PeriodAverage::of_checked(&record);
    let len = average.len();
    let block = block(len, processing.samples_per_period, highest_hz * average.period_s)?;
    let transform = FourierTransform::new(len);
    let (states, position_band_hz, position_floor, filter) = match processing.derivatives {
        Derivatives::Fourier => {
            let (states, bands, floors) =
                fourier_states(&average, &transform, robot, highest_hz, processing.bandwidth());
            let highest = bands.iter().copied().fold(0.0, f64::max);
            (states, bands, floors, LowPass::Harmonics((highest * average.period_s).round() as usize))
        }
        Derivatives::Differences => {
            let cutoff_hz = processing.cutoff_hz(highest_hz);
            let filter = Butterworth::new(processing.filter_order, cutoff_hz, average.rate_hz)?;
            (difference_states(&average, &filter), vec![cutoff_hz; n], Vec::new(), LowPass::Butterworth(filter))
        }
    };
    let low_pass = match processing.torque_filter {
        TorqueFilter::None => LowPass::None,
        TorqueFilter::SameAsPositions => filter,
    };
    let filtered = |rows: Vec<f64>| low_pass.apply(rows, n, average.period_s, &transform);
    let noise = Scatter::new(&torque, &average.effort, n, block, filtered).map(|scatter| {
        let blocks = len / block;
        let count = (blocks * (average.periods - 1)) as f64;
        NoiseModel::adaptive(|l| scatter.lag(l), blocks / 4, true, count).scaled(1.0 / average.periods as f64)
    });
    let used = used_blocks(&states, block, processing.reversal_fraction, 0);
    let tau = filtered(average.effort.clone());
    Ok(Samples {
        slow: used.iter().map(|used| !used).collect(),
        used,
        block,
        period_s: Some(average.period_s),
        periods: average.periods,
        noise,
        derivatives: processing.derivatives,
        position_band_hz,
        position_floor,
        torque_band_hz: low_pass.band_hz(average.period_s),
        torque_filter_order: processing.filter_order,
        torque_covariance: average.effort_covariance,
        position_noise: average.q_variance.map(|v| v.into_iter().map(f64::sqrt).collect()),
        ..Samples::exact(states, tau, effort_units(robot), average.rate_hz)
    })
}

/// Samples in one block, for at most `count` equations from `len` samples of a motion whose highest harmonic is
/// `highest`.
fn block(len: usize, count: usize, highest: f64) -> Result<usize, SignalError> {
    let least = 2 * highest.round() as usize + 1;
    let found = (1..=count.min(len)).rev().find(|&count| len.is_multiple_of(count)).unwrap_or(1);
    if found < least {
        return Err(SignalError::Decimation { found, least, of: len });
    }
    Ok(len / found)
}

/// Which blocks are an equation of which joint, M × n: those in which the joint is never slower than `fraction` of its
/// top speed. With a `reach`, those of which no sample is within as many samples of one where the joint is slower or turns round. Blocks in
/// which that would take more than half of the joints stay: where joints turn round together, no others show what these show.
pub(super) fn used_blocks(states: &States, block: usize, fraction: f64, reach: usize) -> Vec<bool> {
    let n = states.dof;
    let mut slowest = vec![0.0; n];
    for qd in states.qd.chunks_exact(n) {
        for (top, qd) in slowest.iter_mut().zip(qd) {
            *top = qd.abs().max(*top);
        }
    }
    for top in &mut slowest {
        *top *= fraction;
    }
    let farther_than = |reach: usize| {
        let mut used = vec![true; states.len() / block * n];
        for k in 0..states.len() {
            for (i, (qd, slowest)) in states.qd(k).iter().zip(&slowest).enumerate() {
                let turns = reach > 0 && k > 0 && states.qd(k - 1)[i] * qd < 0.0;
                if turns || qd.abs() < *slowest {
                    for m in k.saturating_sub(reach) / block..=(k + reach) / block {
                        if let Some(used) = used.get_mut(m * n + i) {
                            *used = false;
                        }
                    }
                }
            }
        }
        used
    };
    let moves = farther_than(0);
    if reach == 0 {
        return moves;
    }
    let mut used = farther_than(reach);
    for (used, moves) in used.chunks_exact_mut(n).zip(moves.chunks_exact(n)) {
        if 2 * used.iter().filter(|used| !**used).count() > n {
            used.copy_from_slice(moves);
        }
    }
    used
}

/// Unit of each joint's effort.
pub(super) fn effort_units(robot: &Robot) -> Vec<String> {
    robot.joints().iter().map(|joint| joint.kind.effort_unit().to_owned()).collect()
}

/// What torque goes through.
enum LowPass {
    None,
    Harmonics(usize),
    Butterworth(Butterworth),
}

impl LowPass {
    fn band_hz(&self, period_s: f64) -> Option<f64> {
        match self {
            Self::None => None,
            Self::Harmonics(last) => Some(*last as f64 / period_s),
            Self::Butterworth(filter) => Some(filter.cutoff_hz),
        }
    }

    /// A period of torque, row-major and n wide, after the filter.
    fn apply(&self, mut rows: Vec<f64>, n: usize, period_s: f64, transform: &FourierTransform) -> Vec<f64> {
        match self {
            Self::None => rows,
            Self::Harmonics(last) => {
                for i in 0..n {
                    let series = HarmonicSeries::new(transform, &column(&rows, n, i), period_s).up_to(*last);
                    put_column(&mut rows, n, i, &series.samples(transform).q);
                }
                rows
            }
            Self::Butterworth(filter) => filter.zero_phase_periodic(&rows, n),
        }
    }
}

fn fourier_states(
    average: &PeriodAverage,
    transform: &FourierTransform,
    robot: &Robot,
    highest_hz: f64,
    bandwidth: Bandwidth,
) -> (States, Vec<f64>, Vec<f64>) {
    let n = average.dof;
    let commanded = (highest_hz * average.period_s).round() as usize;
    let mut joints = HarmonicSeries::of_columns(transform, &average.q, n, average.period_s);
    let (mut bands, mut floors) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for (i, series) in joints.iter_mut().enumerate() {
        let variance = position_floor(average, robot, i);
        floors.push(series.floor(variance, average.len()));
        let last = match bandwidth {
            Bandwidth::NoiseFloor => series.last_above_noise(variance, average.len()),
            Bandwidth::Harmonics(last) => last,
            Bandwidth::Hertz(hz) => (hz * average.period_s).floor() as usize,
        };
        let last = last.max(commanded).min(series.highest());
        bands.push(last as f64 / average.period_s);
        series.keep_up_to(last);
    }
    (HarmonicSeries::samples_of_joints(&joints, transform), bands, floors)
}

/// Variance of one averaged sample of position: scatter over P, and what of the encoder's rounding repeats with the
/// period, so that it neither scatters nor averages out.
fn position_floor(average: &PeriodAverage, robot: &Robot, i: usize) -> f64 {
    let joint = &robot.joints()[i];
    let revolute = joint.kind == crate::model::JointKind::Revolute;
    let rounding = joint.drive.encoder_step(revolute).powi(2) / 12.0;
    let scatter = average.q_variance.as_ref().map_or(0.0, |v| v[i]);
    scatter / average.periods as f64 + (rounding - scatter).max(0.0)
}

fn difference_states(average: &PeriodAverage, filter: &Butterworth) -> States {
    let n = average.dof;
    let mut states = States::with_len(n, average.len());
    let filtered = filter.zero_phase_periodic(&average.q, n);
    for i in 0..n {
        let q = column(&filtered, n, i);
        let (qd, qdd) = differences_periodic(&q, 1.0 / average.rate_hz);
        put_motion(&mut states, i, [&q, &qd, &qdd]);
    }
    states
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_blocks_with_a_reversal_are_left_out() {
        let mut states = States::new(2);
        for k in 0..12 {
            let qd = f64::from(k) - 5.8;
            states.push(&[0.0, 0.0], &[qd, 1.0], &[0.0, 0.0]);
        }
        // Joint 1 passes through zero between samples 5 and 6, in the second block of four; joint 2 never stops.
        let used = used_blocks(&states, 4, 0.05, 0);
        assert_eq!(used, [true, true, false, true, true, true]);
        assert!(used_blocks(&states, 4, 0.0, 0).iter().all(|&used| used));
        // Sample 6 is the first behind the reversal: 5 to 7 are within one of it, 4 to 8 within two.
        assert_eq!(used_blocks(&states, 4, 0.0, 1), used);
        assert_eq!(used_blocks(&states, 4, 0.0, 2), [true, true, false, true, false, true]);
        // Both turn round together.
        let mut together = States::new(2);
        (0..12).map(|k| f64::from(k) - 5.8).for_each(|qd| together.push(&[0.0, 0.0], &[qd, qd], &[0.0, 0.0]));
        let moves = [true, true, false, false, true, true];
        assert_eq!(used_blocks(&together, 4, 0.05, 2), moves);
    }

    #[test]
    fn analytic_block_lengths_divide_the_period() {
        assert_eq!(block(10_000, 250, 5.0), Ok(40));
        assert_eq!(block(10_000, 240, 5.0), Ok(50));
        assert_eq!(block(100, 250, 5.0), Ok(1));
        // Ten equations do not hold five harmonics, eleven do.
        assert!(matches!(block(1000, 10, 5.0), Err(SignalError::Decimation { found: 10, least: 11, .. })));
        assert_eq!(block(1100, 11, 5.0), Ok(100));
        assert!(matches!(block(10_007, 250, 5.0), Err(SignalError::Decimation { found: 1, .. })));
    }
}
