//! The cut-off of a record without periods: the highest frequency at which a joint's motion stands out of its noise.
//!
//! ```text
//! f_c = max_i max { f : S_i(f) > 20 N_i }        N_i = max { S_i(f) : f ≥ f_s/4 }        S_i: power of q_i, mean over f ± f/8
//! ```
//! A lower cut-off takes acceleration out of the regressor that the torque keeps, and inertias come out too large. A higher one adds
//! noise of q̈, and they come out too small. Noise is the worse of the two: it is in all directions of the parameters, also in those that
//! the motion hardly shows. Hence the factor 20. All joints pass the same filter, so that sums of their accelerations stay sums. The noise
//! of the torque has no part in it: it biases nothing.
//!
//! The cut-off is at least 10 Hz, since below it little noise is won. No record shows more than a quarter of its rate: the rule takes all
//! above it for noise. A Hann window keeps the ends of the record out of the spectrum.

use super::columns::column;
use super::fourier_transform::{FourierTransform, smooth_length};
use super::harmonics::HarmonicSeries;

/// Power of the motion over that of the noise at the cut-off.
const ABOVE_NOISE: f64 = 20.0;

/// Lowest cut-off, where a quarter of the rate is not lower, Hz.
const LEAST_HZ: f64 = 10.0;

/// The cut-off of one pass of the low pass, Hz, for rows of `dof` positions, or of measured velocities, sampled at `rate_hz` without a break.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::signal::find_cutoff;
/// // A swing of 30 Hz, and alternating noise.
/// let at = |k: i32| (std::f64::consts::TAU * 0.03 * f64::from(k)).sin() + 1e-3 * if k % 2 == 0 { 1.0 } else { -1.0 };
/// let rows: Vec<f64> = (0..4000).map(at).collect();
/// assert!((30.0..36.0).contains(&find_cutoff(&rows, 1, 1000.0)));
/// ```
pub fn find_cutoff(rows: &[f64], dof: usize, rate_hz: f64) -> f64 {
    last_hz(rows, dof, rate_hz, |series, _| series.last_above_upper_half(ABOVE_NOISE)).max(LEAST_HZ.min(0.25 * rate_hz))
}

/// The cut-off of positions behind a low pass of `band_hz`, Hz, for what is differentiated more than twice. Noise is what is above half
/// the band. There is no least frequency.
pub(super) fn find_motion_band(rows: &[f64], dof: usize, rate_hz: f64, band_hz: f64) -> f64 {
    last_hz(rows, dof, rate_hz, |series, spacing_hz| {
        let line = |hz: f64| ((hz / spacing_hz) as usize).min(series.highest());
        series.last_above(ABOVE_NOISE, line(0.5 * band_hz).max(1)..line(0.75 * band_hz) + 1)
    })
}

/// The last line of any joint, by `last` of its spectrum and the spacing of the lines, Hz.
fn last_hz(rows: &[f64], dof: usize, rate_hz: f64, last: impl Fn(&HarmonicSeries, f64) -> usize) -> f64 {
    let count = rows.len() / dof;
    let transform = FourierTransform::new(smooth_length(count));
    let spacing_hz = rate_hz / transform.len() as f64;
    let phase = |k: usize| std::f64::consts::PI * (k as f64 + 0.5) / count as f64;
    let window: Vec<f64> = (0..count).map(|k| libm::sin(phase(k)).powi(2)).collect();
    let windowed = |i: usize| {
        let mut x = column(rows, dof, i);
        let mean = x.iter().sum::<f64>() / count.max(1) as f64;
        x.iter_mut().zip(&window).for_each(|(x, window)| *x = (*x - mean) * window);
        x.resize(transform.len(), 0.0);
        x
    };
    let lines = (0..dof).step_by(2).map(|i| {
        let (x, period_s) = (windowed(i), 1.0 / spacing_hz);
        if i + 1 == dof {
            return last(&HarmonicSeries::new(&transform, &x, period_s), spacing_hz);
        }
        let [x, y] = HarmonicSeries::pair(&transform, [&x, &windowed(i + 1)], period_s);
        last(&x, spacing_hz).max(last(&y, spacing_hz))
    });
    lines.max().unwrap_or(0) as f64 * spacing_hz
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand_distr::{Distribution, StandardNormal};

    const RATE_HZ: f64 = 500.0;
    const COUNT: usize = 10_007;

    /// Tones of amplitude 0.1 f⁻⁴ at 1.2, 1.5, … Hz, none of them whole cycles of the record, and white noise.
    fn record(std: f64, run: u64) -> Vec<f64> {
        let mut rng = Seed::new(12).stream("cut-off", run);
        (0..COUNT)
            .map(|k| {
                let t = k as f64 / RATE_HZ;
                let tone = |h: i32| {
                    let f = 0.3 * f64::from(h);
                    0.1 * libm::pow(f, -4.0) * libm::sin(std::f64::consts::TAU * f * t + f64::from(h * h))
                };
                let z: f64 = StandardNormal.sample(&mut rng);
                (4..400).map(tone).sum::<f64>() + std * z
            })
            .collect()
    }

    #[test]
    fn analytic_the_cutoff_is_where_a_falling_spectrum_meets_its_noise() {
        // Power density of the tones a²/2 over 0.3 Hz, of the noise 2 s²/f_s. With that of the noise they are 20 times it at
        // f⁸ = 0.01 f_s/(0.6 · 19 · 2 s²).
        for std in [1e-6, 1e-7] {
            let expected = libm::pow(0.01 * RATE_HZ / (0.6 * 19.0 * 2.0 * std * std), 0.125);
            for run in 0..3 {
                let found = find_cutoff(&record(std, run), 1, RATE_HZ);
                assert!((0.93..1.07).contains(&(found / expected)), "{std} {run}: {found} of {expected}");
            }
        }
    }

    #[test]
    fn analytic_a_record_without_noise_is_kept_to_a_quarter_of_its_rate() {
        // The last tone has 119.7 Hz.
        let found = find_cutoff(&record(0.0, 0), 1, RATE_HZ);
        assert!((119.7..=0.25 * RATE_HZ).contains(&found), "{found}");
    }

    #[test]
    fn analytic_the_fastest_joint_decides_and_rest_takes_the_least() {
        let [slow, fast, rest] = [record(1e-4, 0), record(1e-7, 1), vec![0.0; COUNT]];
        let rows: Vec<f64> = (0..COUNT).flat_map(|k| [slow[k], fast[k], rest[k]]).collect();
        assert_eq!(find_cutoff(&rows, 3, RATE_HZ), find_cutoff(&fast, 1, RATE_HZ));
        assert_eq!(find_cutoff(&rest, 1, RATE_HZ), 10.0);
        assert_eq!(find_cutoff(&rest, 1, 20.0), 5.0);
    }
}
