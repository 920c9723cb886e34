//! Periods of raw samples to one period of processed ones.

use super::scatter::ScatterSpectrum;
use super::torque::{map_rows, torque_map};
use super::{
    Bandwidth, Butterworth, Derivatives, FourierTransform, HarmonicSeries, NoiseModel, PeriodAverage, PeriodicRecord,
    Processing, Samples, SignalError, TorqueFilter, differences_periodic,
};
use crate::dynamics::States;
use crate::model::{EffortInterface, Robot};

/// Processes whole periods: average, derivatives, torque, thinning, and the noise of the result.
///
/// `effort` says what the record's efforts are; `highest_hz` is the highest commanded frequency, which is always kept.
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
    let average = PeriodAverage::new(&record)?;
    let transform = FourierTransform::new(average.len());
    let thinning = Thinning::new(average.len(), average.rate_hz, highest_hz, processing)?;

    let (states, position_band_hz) = match processing.derivatives {
        Derivatives::Fourier => {
            fourier_states(&average, &transform, robot, highest_hz, processing.bandwidth, thinning.count)
        }
        Derivatives::Differences => difference_states(&average, &thinning),
    };
    let same = processing.torque_filter == TorqueFilter::SameAsPositions;
    let low_pass = match (&thinning.filter, same) {
        (Some(filter), true) => LowPass::Butterworth(filter),
        (None, true) => {
            let band = position_band_hz.iter().copied().fold(0.0, f64::max);
            LowPass::Harmonics((band * average.period_s).round() as usize)
        }
        (_, false) if thinning.count < average.len() => LowPass::Harmonics((thinning.count - 1) / 2),
        (_, false) => LowPass::None,
    };
    let tau = low_pass.apply(&average, &transform, thinning.count);
    let spacing_hz = 1.0 / average.period_s;
    let noise = ScatterSpectrum::new(&transform, &torque, &average.effort, n).map(|scatter| {
        let scatter = scatter.filtered(|h| low_pass.gain(h, spacing_hz));
        let count = thinning.count as f64 * (average.periods - 1) as f64;
        NoiseModel::adaptive(|l| scatter.lag(l, thinning.count), thinning.count / 4, true, count)
            .scaled(1.0 / average.periods as f64)
    });
    Ok(Samples {
        states,
        tau,
        units: effort_units(robot),
        rate_hz: thinning.count as f64 / average.period_s,
        period_s: Some(average.period_s),
        periods: average.periods,
        torque_covariance: average.effort_covariance,
        position_noise: average.q_variance.map(|v| v.into_iter().map(f64::sqrt).collect()),
        noise,
        derivatives: processing.derivatives,
        position_band_hz,
        torque_band_hz: low_pass.band_hz(spacing_hz),
        provenance: None,
    })
}

/// Unit of each joint's effort.
pub(super) fn effort_units(robot: &Robot) -> Vec<String> {
    robot.joints().iter().map(|joint| joint.kind.effort_unit().to_owned()).collect()
}

/// Samples to keep, and the low pass of the route of differences.
struct Thinning {
    count: usize,
    filter: Option<Butterworth>,
}

impl Thinning {
    fn new(len: usize, rate_hz: f64, highest_hz: f64, processing: &Processing) -> Result<Self, SignalError> {
        let count = processing.samples_per_period.min(len);
        let period_s = len as f64 / rate_hz;
        let least = (2.0 * highest_hz * period_s).round() as usize + 1;
        if count < least {
            return Err(SignalError::Decimation {
                found: count,
                expected: format!("at least {least}, more than two for each period of {highest_hz} Hz"),
            });
        }
        if processing.derivatives == Derivatives::Fourier {
            return Ok(Self { count, filter: None });
        }
        let cutoff_hz = processing.cutoff_hz(highest_hz);
        let filter = Butterworth::new(processing.filter_order, cutoff_hz, rate_hz)?;
        // At twice the cut-off both passes of order 4 leave 1/257 of the amplitude: what folds back is negligible.
        let least = ((4.0 * cutoff_hz * period_s).ceil() as usize).min(len);
        if count < least || !len.is_multiple_of(count) {
            return Err(SignalError::Decimation {
                found: count,
                expected: format!(
                    "a divisor of {len}, the samples in a period, of at least {least}, four for each period of the \
                     cut-off at {cutoff_hz} Hz"
                ),
            });
        }
        Ok(Self { count, filter: Some(filter) })
    }
}

/// What torque goes through before it is thinned.
enum LowPass<'a> {
    None,
    Harmonics(usize),
    Butterworth(&'a Butterworth),
}

impl LowPass<'_> {
    fn gain(&self, h: usize, spacing_hz: f64) -> f64 {
        match self {
            Self::None => 1.0,
            Self::Harmonics(last) => f64::from(u8::from(h <= *last)),
            Self::Butterworth(filter) => filter.power_gain(h as f64 * spacing_hz),
        }
    }

    fn band_hz(&self, spacing_hz: f64) -> Option<f64> {
        match self {
            Self::None => None,
            Self::Harmonics(last) => Some(*last as f64 * spacing_hz),
            Self::Butterworth(filter) => Some(filter.cutoff_hz()),
        }
    }

    /// Torque at `count` uniform instants, row-major.
    fn apply(&self, average: &PeriodAverage, transform: &FourierTransform, count: usize) -> Vec<f64> {
        let (n, len) = (average.dof, average.len());
        let mut tau = vec![0.0; count * n];
        for i in 0..n {
            let raw = column(&average.effort, n, i);
            let series = match self {
                Self::None => raw,
                Self::Harmonics(last) => {
                    let series = HarmonicSeries::new(transform, &raw, average.period_s).up_to(*last);
                    series.sample(count).into_iter().map(|[value, ..]| value).collect()
                }
                Self::Butterworth(filter) => thinned(&filter.zero_phase_periodic(&raw), len / count),
            };
            put_column(&mut tau, n, i, &series);
        }
        tau
    }
}

fn fourier_states(
    average: &PeriodAverage,
    transform: &FourierTransform,
    robot: &Robot,
    highest_hz: f64,
    bandwidth: Bandwidth,
    count: usize,
) -> (States, Vec<f64>) {
    let n = average.dof;
    let commanded = (highest_hz * average.period_s).round() as usize;
    let mut states = States::with_len(n, count);
    let mut bands = Vec::with_capacity(n);
    for i in 0..n {
        let series = HarmonicSeries::new(transform, &column(&average.q, n, i), average.period_s);
        let last = match bandwidth {
            Bandwidth::NoiseFloor => series.last_above_noise(position_floor(average, robot, i), average.len()),
            Bandwidth::Harmonics(last) => last,
            Bandwidth::Hertz(hz) => (hz * average.period_s).floor() as usize,
        };
        let last = last.max(commanded).min(series.highest());
        bands.push(last as f64 / average.period_s);
        for (k, [q, qd, qdd]) in series.up_to(last).sample(count).into_iter().enumerate() {
            states.q[k * n + i] = q;
            states.qd[k * n + i] = qd;
            states.qdd[k * n + i] = qdd;
        }
    }
    (states, bands)
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

fn difference_states(average: &PeriodAverage, thinning: &Thinning) -> (States, Vec<f64>) {
    let (n, len) = (average.dof, average.len());
    let mut states = States::with_len(n, thinning.count);
    let mut band = 0.5 * average.rate_hz;
    for i in 0..n {
        let raw = column(&average.q, n, i);
        let q = match &thinning.filter {
            Some(filter) => {
                band = filter.cutoff_hz();
                filter.zero_phase_periodic(&raw)
            }
            None => raw,
        };
        let (qd, qdd) = differences_periodic(&q, 1.0 / average.rate_hz);
        let step = len / thinning.count;
        put_column(&mut states.q, n, i, &thinned(&q, step));
        put_column(&mut states.qd, n, i, &thinned(&qd, step));
        put_column(&mut states.qdd, n, i, &thinned(&qdd, step));
    }
    (states, vec![band; n])
}

/// Every `step`-th value.
pub(super) fn thinned(x: &[f64], step: usize) -> Vec<f64> {
    x.iter().step_by(step).copied().collect()
}

/// Column `i` of a row-major table n wide.
pub(super) fn column(rows: &[f64], n: usize, i: usize) -> Vec<f64> {
    rows.iter().skip(i).step_by(n).copied().collect()
}

/// Writes column `i` of a row-major table n wide.
pub(super) fn put_column(rows: &mut [f64], n: usize, i: usize, values: &[f64]) {
    for (to, value) in rows.iter_mut().skip(i).step_by(n).zip(values) {
        *to = *value;
    }
}
