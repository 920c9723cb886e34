//! States for torque that is differentiated further.

use super::butterworth::Butterworth;
use super::cutoff::find_motion_band;
use super::error::SignalError;
use super::periodic::{column, put_column};
use super::samples::Samples;
use crate::dynamics::States;

/// Cut-off over the last frequency of the motion: both passes have lost half at the cut-off, and 0.4 % at half of it.
const ABOVE_MOTION: f64 = 2.0;
/// Slowest low pass, in cycles a record.
const LEAST_CYCLES: f64 = 4.0;

impl Samples {
    /// The states up to the frequency at which the motion stands out of its noise by the rule of [`find_cutoff`](super::find_cutoff), without its least
    /// frequency.
    ///
    /// Torque along states with noise has that noise, and the torque that is measured has not. So a residual holds it too, and any column of
    /// equations that is made of such torque resembles the residual: the more so, the more often it is differentiated. The states of a period are as
    /// they are: their low pass is where signal and noise are equal already.
    ///
    /// # Errors
    /// [`SignalError`] where a band is no frequency.
    pub fn calm_states(&self) -> Result<States, SignalError> {
        let (n, count) = (self.dof(), self.len());
        if self.period_s.is_some() || count < 2 {
            return Ok(self.states.clone());
        }
        let band_hz = self.position_band_hz.iter().copied().fold(0.0, f64::max).min(0.5 * self.rate_hz);
        let found_hz = find_motion_band(&self.states.q, n, self.rate_hz, band_hz);
        let least_hz = (LEAST_CYCLES * self.rate_hz / count as f64).min(0.25 * self.rate_hz);
        let cutoff_hz = (ABOVE_MOTION * found_hz).max(least_hz).min(0.49 * self.rate_hz);
        let filter = Butterworth::new(self.torque_filter_order, cutoff_hz, self.rate_hz)?;
        let mut calm = self.states.clone();
        for table in [&mut calm.q, &mut calm.qd, &mut calm.qdd] {
            for i in 0..n {
                let own = filter.zero_phase_reflected(&column(table, n, i));
                put_column(table, n, i, &own);
            }
        }
        Ok(calm)
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
        let q = low.zero_phase_reflected(&noisy);
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
}
