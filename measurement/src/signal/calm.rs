//! States for torque that is differentiated further.

use super::butterworth::Butterworth;
use super::columns::{column, put_motion};
use super::cutoff::find_motion_band;
use super::error::SignalError;
use super::fourier_transform::FourierTransform;
use super::harmonics::HarmonicSeries;
use super::samples::Samples;
use crate::dynamics::States;

/// Cut-off over the last frequency of the motion: both passes have lost half at the cut-off, and 0.4 % at half of it.
const ABOVE_MOTION: f64 = 2.0;
/// Power of a harmonic over that of its noise, from which on it is taken for motion: noise is a tenth of its amplitude at most.
const OVER_NOISE: f64 = 100.0;
/// Slowest low pass, in cycles a record.
const LEAST_CYCLES: f64 = 4.0;

impl Samples {
    /// The states up to the frequency at which the motion stands out of its noise by the rule of [`find_cutoff`](super::find_cutoff), without its least
    /// frequency.
    ///
    /// Torque along states with noise has that noise, and the torque that is measured has not. So a residual holds it too, and any column of
    /// equations that is made of such torque resembles the residual: the more so, the more often it is differentiated. Of a period, harmonics are kept
    /// up to the last that has a hundred times the power of its noise; all that there are where the noise is not known.
    ///
    /// # Errors
    /// [`SignalError`] where a band is no frequency.
    pub fn calm_states(&self) -> Result<States, SignalError> {
        let (n, count) = (self.dof(), self.len());
        if !self.joined.is_empty() {
            let mut all = States::new(n);
            for of in self.apart() {
                let calm = of.calm_states()?;
                all.q.extend(calm.q);
                all.qd.extend(calm.qd);
                all.qdd.extend(calm.qdd);
            }
            return Ok(all);
        }
        if let Some(period_s) = self.period_s {
            return Ok(self.calm_period(period_s));
        }
        if count < 2 {
            return Ok(self.states.clone());
        }
        let band_hz = self.position_band_hz.iter().copied().fold(0.0, f64::max).min(0.5 * self.rate_hz);
        let found_hz = find_motion_band(&self.states.q, n, self.rate_hz, band_hz);
        let least_hz = (LEAST_CYCLES * self.rate_hz / count as f64).min(0.25 * self.rate_hz);
        let cutoff_hz = (ABOVE_MOTION * found_hz).max(least_hz).min(0.49 * self.rate_hz);
        let filter = Butterworth::new(self.torque_filter_order, cutoff_hz, self.rate_hz)?;
        let mut calm = self.states.clone();
        for table in [&mut calm.q, &mut calm.qd, &mut calm.qdd] {
            *table = filter.zero_phase_reflected(table, n);
        }
        Ok(calm)
    }

    fn calm_period(&self, period_s: f64) -> States {
        let (n, transform) = (self.dof(), FourierTransform::new(self.len()));
        let mut calm = self.states.clone();
        for (i, floor) in self.position_floor.iter().enumerate() {
            let series = HarmonicSeries::new(&transform, &column(&self.states.q, n, i), period_s);
            let last = series.last_above_power(OVER_NOISE * floor);
            put_motion(&mut calm, i, series.up_to(last).samples(&transform).arrays());
        }
        calm
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::seed::Seed;
    use crate::signal::differences;

    #[test]
    fn analytic_noise_above_the_motion_goes_and_the_motion_stays() {
        let (count, rate_hz, w) = (4000, 200.0, std::f64::consts::TAU * 0.5);
        let low = Butterworth::new(4, 10.0, rate_hz).unwrap();
        let mut rng = Seed::new(4).stream("encoder", 0);
        let noisy: Vec<f64> = (0..count)
            .map(|k| {
                let z: f64 = StandardNormal.sample(&mut rng);
                libm::sin(w * f64::from(k) / rate_hz) + 1e-4 * z
            })
            .collect();
        let q = low.zero_phase_reflected(&noisy, 1);
        let (qd, qdd) = differences(&q, 1.0 / rate_hz);
        let len = q.len();
        let samples = Samples {
            position_band_hz: vec![10.0],
            ..Samples::exact(States { dof: 1, q, qd, qdd }, vec![0.0; len], vec!["N·m".to_owned()], rate_hz)
        };
        let error = |states: &States| {
            let square = |k: usize| (states.qdd[k] + w * w * libm::sin(w * k as f64 / rate_hz)).powi(2);
            ((400..3600).map(square).sum::<f64>() / 3200.0).sqrt()
        };
        // Noise of the acceleration goes with the band to the power 2.5: at 4 Hz by a factor of ten.
        let (raw, calm) = (error(&samples.states), error(&samples.calm_states().unwrap()));
        assert!(raw > 0.04 && calm < 0.2 * raw, "{raw} {calm}");
    }

    #[test]
    fn analytic_harmonics_of_a_period_that_are_hardly_above_noise_go() {
        let (count, period_s, w) = (400, 10.0, std::f64::consts::TAU / 10.0);
        let of = |k: usize, h: usize| w * h as f64 * period_s * k as f64 / count as f64;
        // Amplitudes of 1 and, four lines together, of 0.05, with lines of noise of 0.01: 10⁴ and 25 times its power.
        let q: Vec<f64> = (0..count)
            .map(|k| libm::sin(of(k, 3)) + 0.05 * (40..44).map(|h| libm::sin(of(k, h))).sum::<f64>())
            .collect();
        let (zeros, floor) = (vec![0.0; count], |floor: f64| Samples {
            period_s: Some(period_s),
            position_floor: vec![floor],
            ..Samples::exact(
                States { dof: 1, q: q.clone(), qd: vec![0.0; count], qdd: vec![0.0; count] },
                vec![0.0; count],
                vec!["N·m".to_owned()],
                count as f64 / period_s,
            )
        });
        let calm = floor(1e-4).calm_states().unwrap();
        for k in 0..count {
            let expected =
                [libm::sin(of(k, 3)), 3.0 * w * libm::cos(of(k, 3)), -(3.0 * w).powi(2) * libm::sin(of(k, 3))];
            for (found, expected) in [calm.q[k], calm.qd[k], calm.qdd[k]].iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{k}: {found} {expected}");
            }
        }
        // Less noise, and they stay.
        let whole = floor(1e-6).calm_states().unwrap();
        assert!(whole.q.iter().zip(&q).all(|(whole, q)| (whole - q).abs() < 1e-9) && whole.qd != zeros);
    }
}
