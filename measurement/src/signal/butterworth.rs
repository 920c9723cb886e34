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
/// let constant = filter.zero_phase_periodic(&[3.0; 50]);
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

    /// Both passes over one period of a periodic signal, in the steady state.
    pub fn zero_phase_periodic(&self, x: &[f64]) -> Vec<f64> {
        let mut y = x.to_vec();
        for _ in 0..2 {
            y = self.steady_pass(&y);
            y.reverse();
        }
        y
    }

    /// Both passes over a signal that is not periodic; its ends are continued by point reflection, `2x₀ − x[k]`.
    pub fn zero_phase_reflected(&self, x: &[f64]) -> Vec<f64> {
        let (Some(&first), Some(&last)) = (x.first(), x.last()) else { return Vec::new() };
        // A transient of 1e-6 of the step at the ends is below what any sensor resolves.
        let pad = self.settling_samples(1e-6).min(x.len() - 1);
        let mut y = Vec::with_capacity(x.len() + 2 * pad);
        y.extend((1..=pad).rev().map(|k| 2.0 * first - x[k]));
        y.extend_from_slice(x);
        y.extend((1..=pad).map(|k| 2.0 * last - x[x.len() - 1 - k]));
        for _ in 0..2 {
            self.pass_from_rest(&mut y);
            y.reverse();
        }
        y[pad..pad + x.len()].to_vec()
    }

    /// Samples after which a transient has fallen to `level` of its start.
    fn settling_samples(&self, level: f64) -> usize {
        (libm::log(level) / libm::log(self.radius)).ceil().max(1.0) as usize
    }

    fn steady_pass(&self, x: &[f64]) -> Vec<f64> {
        let n = x.len();
        if n == 0 {
            return Vec::new();
        }
        let mut state = vec![[0.0; 2]; self.sections.len()];
        // The transient of a start from rest falls below the last bit before the period begins.
        let lead = self.settling_samples(1e-18);
        let begin = (n - lead % n) % n;
        for k in 0..lead {
            self.step(x[(begin + k) % n], &mut state);
        }
        x.iter().map(|&x| self.step(x, &mut state)).collect()
    }

    fn pass_from_rest(&self, x: &mut [f64]) {
        let first = x[0];
        // The state in which a constant input `first` gives itself as output.
        let mut state: Vec<[f64; 2]> =
            self.sections.iter().map(|s| [(1.0 - s.b[0]) * first, (s.b[2] - s.a[1]) * first]).collect();
        for value in x {
            *value = self.step(*value, &mut state);
        }
    }

    /// One sample through all sections, transposed direct form II.
    #[inline]
    fn step(&self, x: f64, state: &mut [[f64; 2]]) -> f64 {
        let mut value = x;
        for (section, state) in self.sections.iter().zip(state) {
            let y = section.b[0] * value + state[0];
            state[0] = section.b[1] * value - section.a[0] * y + state[1];
            state[1] = section.b[2] * value - section.a[1] * y;
            value = y;
        }
        value
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
        let y = filter.zero_phase_periodic(&tone(n, cycles as f64));
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
        let after = transform.forward_real(&filter.zero_phase_periodic(&x));
        for h in 0..=n / 2 {
            let expected = before[h] * filter.power_gain(h as f64 * 100.0 / n as f64);
            assert!((after[h] - expected).norm() < 1e-10, "line {h}");
        }
    }

    #[test]
    fn identity_reflected_ends_keep_a_straight_line_and_agree_with_the_period_inside() {
        let filter = Butterworth::new(4, 10.0, 1000.0).unwrap();
        let line: Vec<f64> = (0..2000).map(|k| 1.0 + 0.01 * f64::from(k)).collect();
        for (y, x) in filter.zero_phase_reflected(&line).iter().zip(&line) {
            assert!((y - x).abs() < 1e-5, "a line passes: {y} for {x}");
        }
        let x = tone(4000, 3.0);
        let (periodic, reflected) = (filter.zero_phase_periodic(&x), filter.zero_phase_reflected(&x));
        for k in 1000..3000 {
            assert!((periodic[k] - reflected[k]).abs() < 1e-6);
        }
        assert_eq!(filter.zero_phase_reflected(&[]), Vec::<f64>::new());
        assert_eq!(filter.zero_phase_reflected(&[2.0]).len(), 1);
    }

    #[test]
    fn impossible_cutoffs_are_refused() {
        for cutoff in [0.0, -1.0, 500.0, f64::NAN] {
            assert!(matches!(Butterworth::new(4, cutoff, 1000.0), Err(SignalError::Cutoff { .. })));
        }
        assert!(matches!(Butterworth::new(0, 1.0, 1000.0), Err(SignalError::Setting { .. })));
    }
}
