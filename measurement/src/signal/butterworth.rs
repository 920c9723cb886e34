//! Butterworth low pass, run forwards and backwards so that it shifts nothing in time.
//!
//! ```text
//! |H(f)|² = 1 / (1 + (tan(π f / f_s) / tan(π f_c / f_s))^(2n))        zero phase: gain |H(f)|²
//! ```
//! Order n by the bilinear transform with prewarping, as second-order sections. One pass has lost 3 dB at the cut-off
//! `f_c`, both passes 6 dB: the cut-off named everywhere is that of one pass, as with the usual `filtfilt`.
//!
//! A periodic signal is filtered in its steady state, as if it had been repeated for ever: no transients at the ends.
//! Any other signal is continued at both ends by its own point reflection.
//!
//! Reference: A. V. Oppenheim, R. W. Schafer, *Discrete-Time Signal Processing*, 3rd ed., 2010, sec. 7.2.

use super::error::{SignalError, refused};

/// `y = b0 x + b1 x₋₁ + b2 x₋₂ − a1 y₋₁ − a2 y₋₂`
#[derive(Clone, Copy, Debug, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// A digital Butterworth low pass for one sampling rate.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::signal::Butterworth;
/// let filter = Butterworth::new(4, 10.0, 1000.0)?;
/// assert!((filter.power_gain(10.0) - 0.5).abs() < 1e-12);
/// let constant = filter.zero_phase_periodic(&[3.0; 50], 1);
/// assert!(constant.iter().all(|y| (y - 3.0).abs() < 1e-10));
/// # Ok::<(), armid::signal::SignalError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Butterworth {
    sections: Vec<Section>,
    order: usize,
    pub(super) cutoff_hz: f64,
    rate_hz: f64,
    radius: f64,
}

impl Butterworth {
    /// A low pass of `order` (1 to 12) with cut-off `cutoff_hz` for signals sampled at `rate_hz`.
    ///
    /// # Errors
    /// [`SignalError::Cutoff`] unless `0 < cutoff_hz < rate_hz / 2`; [`SignalError::Setting`] for another order.
    pub fn new(order: usize, cutoff_hz: f64, rate_hz: f64) -> Result<Self, SignalError> {
        if !(1..=12).contains(&order) {
            return refused("order of the low pass", order, "1 to 12");
        }
        if !(cutoff_hz > 0.0 && cutoff_hz < 0.5 * rate_hz) {
            return Err(SignalError::Cutoff { found: cutoff_hz, nyquist: 0.5 * rate_hz });
        }
        let k = libm::tan(std::f64::consts::PI * cutoff_hz / rate_hz);
        let mut sections = Vec::with_capacity(order.div_ceil(2));
        let mut radius: f64 = 0.0;
        for pair in 0..order / 2 {
            // Analog pair s² + 2 ζ Ω s + Ω²; the bilinear transform s = (1 − z⁻¹)/(1 + z⁻¹) with Ω = k.
            let zeta = libm::sin(std::f64::consts::PI * (2 * pair + 1) as f64 / (2 * order) as f64);
            let norm = 1.0 / (1.0 + 2.0 * zeta * k + k * k);
            let b = k * k * norm;
            let a = [2.0 * (k * k - 1.0) * norm, (1.0 - 2.0 * zeta * k + k * k) * norm];
            sections.push(Section { b: [b, 2.0 * b, b], a });
            radius = radius.max(a[1].sqrt());
        }
        if order % 2 == 1 {
            let b = k / (1.0 + k);
            let a = (k - 1.0) / (k + 1.0);
            sections.push(Section { b: [b, b, 0.0], a: [a, 0.0] });
            radius = radius.max(a.abs());
        }
        Ok(Self { sections, order, cutoff_hz, rate_hz, radius })
    }

    /// `|H(f)|²` at `f` Hz: the power gain of one pass, and the amplitude gain of both.
    pub fn power_gain(&self, f: f64) -> f64 {
        let tangent = |f: f64| libm::tan(std::f64::consts::PI * f / self.rate_hz);
        let ratio = tangent(f) / tangent(self.cutoff_hz);
        1.0 / (1.0 + libm::pow(ratio * ratio, self.order as f64))
    }

    /// Both passes over one period of periodic signals, in the steady state. Each of the `n` columns of `x`, row-major, is a signal.
    ///
    /// # Panics
    /// If `x` has no whole rows of `n` numbers.
    pub fn zero_phase_periodic(&self, x: &[f64], n: usize) -> Vec<f64> {
        assert!(n > 0 && x.len().is_multiple_of(n), "{} numbers, expected rows of {n}", x.len());
        let mut y = x.to_vec();
        // The transient of a start from rest falls below the last bit before the period begins.
        let start = Start::After(self.settling_samples(1e-18));
        for backwards in [false, true] {
            self.pass(&mut y, n, backwards, start);
        }
        y
    }

    /// Both passes over signals that are not periodic, as above; their ends are continued by point reflection, `2x₀ − x[k]`.
    ///
    /// # Panics
    /// As [`Self::zero_phase_periodic`].
    pub fn zero_phase_reflected(&self, x: &[f64], n: usize) -> Vec<f64> {
        assert!(n > 0 && x.len().is_multiple_of(n), "{} numbers, expected rows of {n}", x.len());
        let Some(last) = (x.len() / n).checked_sub(1) else { return Vec::new() };
        // A transient of 1e-6 of the step at the ends is below what any sensor resolves.
        let pad = self.settling_samples(1e-6).min(last);
        let row = |k: usize| &x[k * n..(k + 1) * n];
        let reflected = |at: usize, k: usize| row(at).iter().zip(row(k)).map(|(end, x)| 2.0 * end - x);
        let mut y = Vec::with_capacity(x.len() + 2 * pad * n);
        y.extend((1..=pad).rev().flat_map(|k| reflected(0, k)));
        y.extend_from_slice(x);
        y.extend((1..=pad).flat_map(|k| reflected(last, last - k)));
        for backwards in [false, true] {
            self.pass(&mut y, n, backwards, Start::Constant);
        }
        y.truncate(pad * n + x.len());
        y.drain(..pad * n);
        y
    }

    /// Samples after which a transient has fallen to `level` of its start.
    fn settling_samples(&self, level: f64) -> usize {
        (libm::log(level) / libm::log(self.radius)).ceil().max(1.0) as usize
    }

    /// One pass over all columns, several side by side: a sample waits for the one before it, and other signals fill the time.
    fn pass(&self, y: &mut [f64], n: usize, backwards: bool, start: Start) {
        for first in (0..n).step_by(8) {
            let place = Place { n, first, rows: y.len() / n, backwards };
            match n - first {
                1 => self.pass_of::<1>(y, place, start),
                2 => self.pass_of::<2>(y, place, start),
                3 => self.pass_of::<3>(y, place, start),
                4 => self.pass_of::<4>(y, place, start),
                5 => self.pass_of::<5>(y, place, start),
                6 => self.pass_of::<6>(y, place, start),
                7 => self.pass_of::<7>(y, place, start),
                _ => self.pass_of::<8>(y, place, start),
            }
        }
    }

    fn pass_of<const L: usize>(&self, y: &mut [f64], place: Place, start: Start) {
        let rows = place.rows;
        if rows == 0 {
            return;
        }
        let mut state = vec![[[0.0; L]; 2]; self.sections.len()];
        match start {
            Start::After(lead) => {
                let begin = (rows - lead % rows) % rows;
                for k in 0..lead {
                    self.step(place.of((begin + k) % rows, y), &mut state);
                }
            }
            Start::Constant => {
                let first: [f64; L] = *place.of(0, y);
                for (s, state) in self.sections.iter().zip(&mut state) {
                    *state = [1.0 - s.b[0], s.b[2] - s.a[1]].map(|size| first.map(|x| size * x));
                }
            }
        }
        for k in 0..rows {
            let at = place.of(k, y);
            *at = self.step(at, &mut state);
        }
    }

    /// One sample of each signal through all sections, transposed direct form II.
    #[inline(always)]
    fn step<const L: usize>(&self, x: &[f64; L], state: &mut [[[f64; L]; 2]]) -> [f64; L] {
        let mut value = *x;
        for (section, [first, second]) in self.sections.iter().zip(state) {
            for l in 0..L {
                let y = section.b[0] * value[l] + first[l];
                first[l] = section.b[1] * value[l] - section.a[0] * y + second[l];
                second[l] = section.b[2] * value[l] - section.a[1] * y;
                value[l] = y;
            }
        }
        value
    }
}

/// What a pass begins with.
#[derive(Clone, Copy)]
enum Start {
    /// The state after so many samples before the first, of a period.
    After(usize),
    /// The state in which a constant input, the first sample, gives itself as output.
    Constant,
}

/// Columns from `first` on of a table n wide, whose rows are counted from its end where `backwards`.
#[derive(Clone, Copy)]
struct Place {
    n: usize,
    first: usize,
    rows: usize,
    backwards: bool,
}

impl Place {
    #[inline(always)]
    fn of<const L: usize>(self, k: usize, y: &mut [f64]) -> &mut [f64; L] {
        let row = if self.backwards { self.rows - 1 - k } else { k };
        y[row * self.n + self.first..].first_chunk_mut().expect("columns of the table")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use crate::signal::FourierTransform;
    use rand::RngExt;

    fn tone(n: usize, cycles: f64) -> Vec<f64> {
        (0..n).map(|k| libm::cos(std::f64::consts::TAU * cycles * k as f64 / n as f64)).collect()
    }

    /// Amplitude gain of both passes on a tone of `cycles` per period of n samples.
    fn gain(filter: &Butterworth, n: usize, cycles: usize) -> f64 {
        let y = filter.zero_phase_periodic(&tone(n, cycles as f64), 1);
        let spectrum = FourierTransform::new(n).forward_real(&y);
        assert!(spectrum[cycles].im.abs() < 1e-10 * n as f64, "zero phase");
        2.0 * spectrum[cycles].re / n as f64
    }

    #[test]
    fn published_three_decibel_per_pass_at_the_cutoff_for_every_order() {
        for order in 1..=8 {
            for cutoff in [5.0, 40.0, 200.0] {
                let filter = Butterworth::new(order, cutoff, 1000.0).unwrap();
                let gain = gain(&filter, 1000, cutoff as usize);
                // Two passes: 1/2 in amplitude, −6.02 dB.
                assert!((gain - 0.5).abs() < 1e-9, "order {order} at {cutoff} Hz: {gain}");
            }
        }
    }

    #[test]
    fn published_order_four_denominators() {
        // Normalised polynomials (s² + 0.7654 s + 1)(s² + 1.8478 s + 1), Oppenheim & Schafer, table 7.1 of filter
        // handbooks; at f_c = f_s/4 the bilinear transform has k = 1, a1 = 0 and a2 = (2 − d)/(2 + d).
        let filter = Butterworth::new(4, 250.0, 1000.0).unwrap();
        for (section, d) in filter.sections.iter().zip([0.765_366_864_730_179_6, 1.847_759_065_022_573_5]) {
            assert!(section.a[0].abs() < 1e-15);
            assert!((section.a[1] - (2.0 - d) / (2.0 + d)).abs() < 1e-15);
        }
    }

    #[test]
    fn analytic_gain_is_the_closed_form_and_maximally_flat() {
        let filter = Butterworth::new(4, 50.0, 1000.0).unwrap();
        let mut last = 1.0;
        for cycles in [1, 5, 10, 25, 50, 75, 100, 200, 400] {
            let measured = gain(&filter, 1000, cycles);
            assert!((measured - filter.power_gain(cycles as f64)).abs() < 1e-10, "at {cycles} Hz");
            assert!(measured < last + 1e-12, "monotone");
            last = measured;
        }
        // Maximally flat: 1 − gain = (f/f_c)⁸ far below the cut-off, so a factor of two in f is one of 256.
        let loss = |f: f64| 1.0 - filter.power_gain(f);
        assert!((loss(10.0) / loss(5.0) / 256.0 - 1.0).abs() < 0.01);
    }

    #[test]
    fn identity_steady_state_equals_the_spectrum_times_the_gain() {
        let n = 600;
        let mut rng = Seed::new(4).stream("butterworth", 0);
        let x: Vec<f64> = (0..n).map(|_| rng.random_range(-1.0..1.0)).collect();
        let filter = Butterworth::new(4, 3.0, 100.0).unwrap();
        let transform = FourierTransform::new(n);
        let before = transform.forward_real(&x);
        let after = transform.forward_real(&filter.zero_phase_periodic(&x, 1));
        for h in 0..=n / 2 {
            let expected = before[h] * filter.power_gain(h as f64 * 100.0 / n as f64);
            assert!((after[h] - expected).norm() < 1e-10, "line {h}");
        }
    }

    #[test]
    fn identity_reflected_ends_keep_a_straight_line_and_agree_with_the_period_inside() {
        let filter = Butterworth::new(4, 10.0, 1000.0).unwrap();
        let line: Vec<f64> = (0..2000).map(|k| 1.0 + 0.01 * f64::from(k)).collect();
        for (y, x) in filter.zero_phase_reflected(&line, 1).iter().zip(&line) {
            assert!((y - x).abs() < 1e-5, "a line passes: {y} for {x}");
        }
        let x = tone(4000, 3.0);
        let (periodic, reflected) = (filter.zero_phase_periodic(&x, 1), filter.zero_phase_reflected(&x, 1));
        for k in 1000..3000 {
            assert!((periodic[k] - reflected[k]).abs() < 1e-6);
        }
        assert_eq!(filter.zero_phase_reflected(&[], 1), Vec::<f64>::new());
        assert_eq!(filter.zero_phase_reflected(&[2.0], 1).len(), 1);
    }

    #[test]
    fn identity_signals_side_by_side_have_the_bits_that_each_has_alone() {
        let mut rng = Seed::new(5).stream("butterworth", 0);
        for (n, order) in (1..=9).map(|n| (n, n)) {
            let rows = 40 * n + 3;
            let table: Vec<f64> = (0..rows * n).map(|_| rng.random_range(-1.0..1.0)).collect();
            let filter = Butterworth::new(order, 7.0, 100.0).unwrap();
            let together = [filter.zero_phase_periodic(&table, n), filter.zero_phase_reflected(&table, n)];
            for i in 0..n {
                let own: Vec<f64> = table.iter().skip(i).step_by(n).copied().collect();
                let alone = [filter.zero_phase_periodic(&own, 1), filter.zero_phase_reflected(&own, 1)];
                for (together, alone) in together.iter().zip(alone) {
                    assert!(together.iter().skip(i).step_by(n).eq(&alone), "column {i} of {n}");
                }
            }
        }
    }

    #[test]
    fn impossible_cutoffs_are_refused() {
        for cutoff in [0.0, -1.0, 500.0, f64::NAN] {
            assert!(matches!(Butterworth::new(4, cutoff, 1000.0), Err(SignalError::Cutoff { .. })));
        }
        assert!(matches!(Butterworth::new(0, 1.0, 1000.0), Err(SignalError::Setting { .. })));
    }
}
