//! Velocity and acceleration through the measured Fourier coefficients.
//!
//! ```text
//! q(t) = c₀ + Σ_h a_h cos hωt + b_h sin hωt      ω = 2π/T
//! q̇(t) = Σ_h hω (b_h cos hωt − a_h sin hωt)      q̈(t) = −Σ_h h²ω² (a_h cos hωt + b_h sin hωt)
//! ```
//! Differentiation is exact; what is chosen is which harmonics to keep. A closed loop with friction moves at more
//! harmonics than were commanded, so cutting there would bias q̈ just where friction reverses; keeping all of them
//! would multiply encoder noise by h²ω². [`Bandwidth`] states the rule.
//!
//! Reference: Swevers et al. 1997, sec. IV.

use std::ops::Range;

use nalgebra::Complex;

use super::fourier_transform::{FourierTransform, Line, TOGETHER};
use crate::dynamics::States;

/// Which harmonics of the measured positions are kept.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bandwidth {
    /// Joint by joint, up to where the signal falls below the noise: the last harmonic h at which the mean power of the
    /// harmonics from 7/8 h to 9/8 h is twice that of the noise, `4 s²/N` for a variance s² of one averaged sample.
    /// Signal and noise are equal there: keeping more adds more noise than signal, keeping less takes away more signal
    /// than noise, in q, q̇ and q̈ alike, since all are weighted with the same power of h. The noise is what the periods
    /// scatter by, and not less than the mean power of the last eighth of the harmonics: errors of an encoder that come
    /// again in every period do not scatter, but they fill the spectrum to its end, which no motion does.
    NoiseFloor,
    /// Up to this harmonic of the period.
    Harmonics(usize),
    /// Up to this frequency, Hz.
    Hertz(f64),
}

/// A finite Fourier series of one joint, from the samples of one period.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::signal::{FourierTransform, HarmonicSeries};
/// let x: Vec<f64> = (0..16).map(|k| (std::f64::consts::TAU * 2.0 * k as f64 / 16.0).sin()).collect();
/// let transform = FourierTransform::new(16);
/// let states = HarmonicSeries::new(&transform, &x, 1.0).up_to(3).samples(&transform);
/// assert!(states.q[0].abs() < 1e-14 && (states.qd[0] - 2.0 * std::f64::consts::TAU).abs() < 1e-12 && states.qdd[0].abs() < 1e-11);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HarmonicSeries {
    period_s: f64,
    /// Line h holds `a_h − i b_h`; line 0 holds `c₀`.
    lines: Vec<Complex<f64>>,
}

impl HarmonicSeries {
    /// All harmonics below half the sampling rate of the N samples `x` of one period of `period_s` seconds: the least
    /// squares fit of any number of them, since harmonics are orthogonal on a whole period.
    ///
    /// # Panics
    /// If the transform is of another length than `x`.
    pub fn new(transform: &FourierTransform, x: &[f64], period_s: f64) -> Self {
        Self::of_spectrum(&transform.forward_real(x), period_s)
    }

    /// [`Self::new`] of two signals at the price of one, each up to rounding of the larger.
    pub(super) fn pair(transform: &FourierTransform, [x, y]: [&[f64]; 2], period_s: f64) -> [Self; 2] {
        let (x, y) = transform.forward_pair(x, y);
        [x, y].map(|spectrum| Self::of_spectrum(&spectrum, period_s))
    }

    /// [`Self::new`] of each column of a table `columns` wide.
    pub(super) fn of_columns(transform: &FourierTransform, rows: &[f64], columns: usize, period_s: f64) -> Vec<Self> {
        let mut all = Vec::with_capacity(columns);
        for first in (0..columns).step_by(TOGETHER) {
            let count = TOGETHER.min(columns - first);
            let spectra = transform.forward_together(count, |k| {
                let mut line = Line::ZERO;
                line.re[..count].copy_from_slice(&rows[k * columns + first..][..count]);
                line
            });
            let of = |i: usize| {
                Self::of_lines(transform.len(), period_s, |h| Complex::new(spectra[h].re[i], spectra[h].im[i]))
            };
            all.extend((0..count).map(of));
        }
        all
    }

    fn of_spectrum(spectrum: &[Complex<f64>], period_s: f64) -> Self {
        Self::of_lines(spectrum.len(), period_s, |h| spectrum[h])
    }

    /// Of a spectrum of n lines.
    fn of_lines(n: usize, period_s: f64, line: impl Fn(usize) -> Complex<f64>) -> Self {
        let lines = (0..n.div_ceil(2)).map(|h| line(h) * ((if h == 0 { 1.0 } else { 2.0 }) / n as f64)).collect();
        Self { period_s, lines }
    }

    /// The highest harmonic that it holds.
    pub fn highest(&self) -> usize {
        self.lines.len().saturating_sub(1)
    }

    /// Returns this series without what is above harmonic `h`.
    #[must_use]
    pub fn up_to(mut self, h: usize) -> Self {
        self.keep_up_to(h);
        self
    }

    /// Leaves out what is above harmonic `h`.
    pub(super) fn keep_up_to(&mut self, h: usize) {
        self.lines.truncate(h + 1);
    }

    /// The last harmonic at which the signal still outweighs white noise of variance `variance` per sample, for N
    /// samples, and the power at the end of its own spectrum; see [`Bandwidth::NoiseFloor`].
    pub fn last_above_noise(&self, variance: f64, samples: usize) -> usize {
        self.last_above_power(2.0 * self.floor(variance, samples))
    }

    /// The last harmonic, but for the last ninth of all, whose mean power is above `least`.
    pub(super) fn last_above_power(&self, least: f64) -> usize {
        let power = self.smoothed_power();
        (1..=self.highest() * 8 / 9).rev().find(|&h| power[h] > least).unwrap_or(0)
    }

    /// The last harmonic whose mean power is `ratio` times the largest of the upper half of the spectrum, which is taken for noise.
    pub fn last_above_upper_half(&self, ratio: f64) -> usize {
        self.last_above(ratio, self.lines.len() / 2..self.lines.len())
    }

    /// The last harmonic below some others whose mean power is `ratio` times the largest of theirs, which are taken for noise.
    pub fn last_above(&self, ratio: f64, noise: Range<usize>) -> usize {
        let power = self.smoothed_power();
        let floor = power[noise.clone()].iter().copied().fold(0.0, f64::max);
        (1..noise.start).rev().find(|&h| power[h] > ratio * floor).unwrap_or(0)
    }

    /// Power of a line that is noise: that of white noise of variance `variance` per sample, for N samples, and not less than the mean
    /// of the last eighth of the lines.
    pub fn floor(&self, variance: f64, samples: usize) -> f64 {
        let end = &self.lines[self.lines.len() - self.highest() / 8..];
        let power = end.iter().map(Complex::norm_sqr).sum::<f64>() / end.len().max(1) as f64;
        (4.0 * variance / samples as f64).max(power)
    }

    /// Share of each line's power that is signal beside noise of power `floor`: 1 − floor/power, not below zero. A line times its share is what is
    /// expected of the signal, given the line (Wiener).
    pub fn signal_shares(&self, floor: f64) -> Vec<f64> {
        let share = |power: f64| if power > floor { 1.0 - floor / power } else { 0.0 };
        self.smoothed_power().into_iter().enumerate().map(|(h, p)| if h == 0 { 1.0 } else { share(p) }).collect()
    }

    /// Returns this series with every line times its factor; lines beyond the factors are left out.
    #[must_use]
    pub fn weighted(mut self, factors: &[f64]) -> Self {
        self.lines.truncate(factors.len());
        self.lines.iter_mut().zip(factors).for_each(|(line, factor)| *line *= *factor);
        self
    }

    /// Mean power of the lines from 7/8 h to 9/8 h, of each h; of those that there are at the end.
    fn smoothed_power(&self) -> Vec<f64> {
        let mut cumulated = Vec::with_capacity(self.lines.len());
        let mut sum = 0.0;
        for line in &self.lines {
            cumulated.push(sum);
            sum += line.norm_sqr();
        }
        cumulated.push(sum);
        let mean = |h: usize| {
            let (first, end) = (h - h / 8, (h + h / 8 + 1).min(self.lines.len()));
            (cumulated[end] - cumulated[first]) / (end - first) as f64
        };
        (0..self.lines.len()).map(mean).collect()
    }

    /// The states of the joint, value, first and second derivative, at the N uniform instants `k T / N` of a transform, k = 0, 1, ….
    ///
    /// # Panics
    /// If the transform has not more than twice as many samples as the series has harmonics.
    pub fn samples(&self, transform: &FourierTransform) -> States {
        let n = transform.len();
        let backward = |of: Derivatives| -> (Vec<f64>, Vec<f64>) {
            let lines: Vec<Complex<f64>> = (0..n).map(|k| self.backward_line(k, n, of)).collect();
            transform.forward(&lines).into_iter().map(|z| (z.re, -z.im)).unzip()
        };
        let (q, qd) = backward(Derivatives::ZeroAndFirst);
        States { dof: 1, q, qd, qdd: backward(Derivatives::Second).0 }
    }

    /// [`Self::samples`] of all joints of an arm, with the same bits.
    ///
    /// # Panics
    /// As [`Self::samples`].
    pub(super) fn samples_of_joints(joints: &[Self], transform: &FourierTransform) -> States {
        let (n, dof) = (transform.len(), joints.len());
        let mut states = States::with_len(dof, n);
        for (part, joints) in joints.chunks(TOGETHER).enumerate() {
            let most = joints.iter().map(Self::highest).max().unwrap_or(0);
            let backward = |of: Derivatives| {
                transform.forward_together(joints.len(), |k| {
                    let mut line = Line::ZERO;
                    if k.min(n - k) <= most {
                        for (i, joint) in joints.iter().enumerate() {
                            let number = joint.backward_line(k, n, of);
                            (line.re[i], line.im[i]) = (number.re, number.im);
                        }
                    }
                    line
                })
            };
            let put = |rows: &mut [f64], lines: &[Line], values: fn(&Line) -> &[f64; TOGETHER], sign: f64| {
                for (row, line) in rows.chunks_exact_mut(dof).zip(lines) {
                    let row = &mut row[part * TOGETHER..][..joints.len()];
                    row.iter_mut().zip(values(line)).for_each(|(to, value)| *to = sign * value);
                }
            };
            let lines = backward(Derivatives::ZeroAndFirst);
            put(&mut states.q, &lines, |line| &line.re, 1.0);
            put(&mut states.qd, &lines, |line| &line.im, -1.0);
            put(&mut states.qdd, &backward(Derivatives::Second), |line| &line.re, 1.0);
        }
        states
    }

    /// Line k of n that a forward transform turns into samples, the real part into those of one signal u, the imaginary part into those of another
    /// with the sign changed, −v.
    ///
    /// `conj(Σ_h X_h exp(−2πi hk/N))` runs a transform backwards: line h of `u + i v` is `(U_h + i V_h)/2`, line N−h is `conj(U_h − i V_h)/2`.
    fn backward_line(&self, k: usize, n: usize, of: Derivatives) -> Complex<f64> {
        assert!(2 * self.highest() < n, "{n} samples for {} harmonics", self.highest());
        let h = k.min(n - k);
        let Some(&line) = self.lines.get(h) else { return Complex::ZERO };
        let w = std::f64::consts::TAU / self.period_s * h as f64;
        let (u, v) = match of {
            Derivatives::ZeroAndFirst => (line, line * Complex::new(0.0, w)),
            Derivatives::Second => (line * -w.powi(2), Complex::ZERO),
        };
        let v = Complex::new(0.0, 1.0) * v;
        if k == 0 {
            (u + v).conj()
        } else if k == h {
            ((u + v) * 0.5).conj()
        } else {
            (u - v) * 0.5
        }
    }
}

/// Which derivatives by time two signals are.
#[derive(Clone, Copy, Debug)]
enum Derivatives {
    ZeroAndFirst,
    Second,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand_distr::{Distribution, StandardNormal};

    /// q, q̇ and q̈ of exp(sin(ωt)): all harmonics, falling faster than any power.
    fn smooth(t: f64, w: f64) -> [f64; 3] {
        let (s, c) = libm::sincos(w * t);
        let e = libm::exp(s);
        [e, w * c * e, w * w * (c * c - s) * e]
    }

    #[test]
    fn analytic_derivatives_of_a_smooth_periodic_function() {
        let (n, period) = (64, 2.5);
        let w = std::f64::consts::TAU / period;
        let x: Vec<f64> = (0..n).map(|k| smooth(period * k as f64 / n as f64, w)[0]).collect();
        let series = HarmonicSeries::new(&FourierTransform::new(n), &x, period);
        // 31 harmonics of exp∘sin leave 1e-30; the rest is rounding, 1e-16 times h² ω² ≈ 6e3 for the acceleration.
        let found = series.samples(&FourierTransform::new(96));
        for k in 0..96 {
            let t = period * k as f64 / 96.0;
            let sampled = [found.q[k], found.qd[k], found.qdd[k]];
            let expected = smooth(t, w);
            for (order, bound) in [1e-14, 1e-12, 1e-10].into_iter().enumerate() {
                assert!((sampled[order] - expected[order]).abs() < bound, "derivative {order} at {t}");
            }
        }
    }

    #[test]
    fn identity_joints_together_have_the_bits_that_they_have_alone() {
        // Nine joints fill no number of vectors, and each keeps a number of harmonics of its own.
        let (n, dof, period) = (60, 9, 3.0);
        let transform = FourierTransform::new(n);
        let rows: Vec<f64> = (0..dof as u64).flat_map(|run| white(n, 1.0, run)).collect();
        let found = HarmonicSeries::of_columns(&transform, &rows, dof, period);
        let cut: Vec<HarmonicSeries> = found.iter().enumerate().map(|(i, joint)| joint.clone().up_to(3 * i)).collect();
        let together = HarmonicSeries::samples_of_joints(&cut, &transform);
        for (i, (series, cut)) in found.iter().zip(cut).enumerate() {
            let column = |rows: &[f64]| -> Vec<f64> { rows.iter().skip(i).step_by(dof).copied().collect() };
            assert_eq!(*series, HarmonicSeries::new(&transform, &column(&rows), period));
            let alone = cut.samples(&transform);
            assert_eq!(
                [&together.q, &together.qd, &together.qdd].map(|rows| column(rows)),
                [alone.q, alone.qd, alone.qdd]
            );
        }
    }

    fn white(n: usize, std: f64, run: u64) -> Vec<f64> {
        let mut rng = Seed::new(5).stream("noise floor", run);
        (0..n)
            .map(|_| {
                let z: f64 = StandardNormal.sample(&mut rng);
                std * z
            })
            .collect()
    }

    #[test]
    fn analytic_noise_floor_is_where_a_falling_spectrum_meets_it() {
        // Friction that reverses makes q̈ kink and amplitudes fall like h⁻⁴: 0.1 h⁻⁴ meets the mean noise amplitude
        // 2 s/√N = 1e-8 at h = (1e7)^(1/4) = 56.
        let n = 4000;
        let std = 1e-8 * (n as f64).sqrt() / 2.0;
        let transform = FourierTransform::new(n);
        let signal: Vec<f64> = (0..n)
            .map(|k| {
                (1..500)
                    .map(|h| {
                        let angle = std::f64::consts::TAU * ((h * k) % n) as f64 / n as f64;
                        0.1 * libm::pow(h as f64, -4.0) * libm::cos(angle + h as f64)
                    })
                    .sum()
            })
            .collect();
        for run in 0..20 {
            let x: Vec<f64> = signal.iter().zip(white(n, std, run)).map(|(x, e)| x + e).collect();
            let last = HarmonicSeries::new(&transform, &x, 1.0).last_above_noise(std * std, n);
            // Nine lines or more are averaged there, so their mean power is known to a third, and h to 1/8 of that.
            assert!((50..=66).contains(&last), "run {run}: {last}");
        }
    }

    #[test]
    fn analytic_an_error_that_comes_again_in_every_period_is_noise_too() {
        // 0.1 h⁻⁴ as above, rounded to steps of 2e-6: white with a variance of step²/12, amplitude 2 s/√N = 1.8e-8. Periods
        // that are all the same do not scatter.
        let (n, step) = (4000, 2e-6);
        let x: Vec<f64> = (0..n)
            .map(|k| {
                let signal: f64 = (1..500)
                    .map(|h| {
                        let angle = std::f64::consts::TAU * ((h * k) % n) as f64 / n as f64;
                        0.1 * libm::pow(h as f64, -4.0) * libm::cos(angle + h as f64)
                    })
                    .sum();
                step * (signal / step).round()
            })
            .collect();
        let last = HarmonicSeries::new(&FourierTransform::new(n), &x, 1.0).last_above_noise(0.0, n);
        // (0.1 / 1.8e-8)^(1/4) = 48.
        assert!((40..=58).contains(&last), "{last}");
    }

    #[test]
    fn analytic_noise_alone_keeps_few_harmonics_and_a_gap_stops_nothing() {
        let n = 2000;
        let transform = FourierTransform::new(n);
        for run in 0..50 {
            let noise = white(n, 0.1, run);
            let last = HarmonicSeries::new(&transform, &noise, 1.0).last_above_noise(0.01, n);
            // The mean power of 2w + 1 = 25 lines is twice its expectation with a probability of 1e-4: beyond
            // h = 100 nothing passes.
            assert!(last < 100, "run {run}: {last}");
            let gap: Vec<f64> = noise
                .iter()
                .enumerate()
                .map(|(k, e)| e + libm::sin(std::f64::consts::TAU * 9.0 * k as f64 / n as f64))
                .collect();
            assert!(HarmonicSeries::new(&transform, &gap, 1.0).last_above_noise(0.01, n) >= 9);
        }
    }
}
