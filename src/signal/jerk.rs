//! The derivative of the acceleration.

use super::periodic::{column, put_column};
use super::{Derivatives, FourierTransform, HarmonicSeries, Samples, differences, differences_periodic};

impl Samples {
    /// `q⃛` at every sample, N × n row-major, rad/s³ (m/s³), by the route that velocity and acceleration came by: through the
    /// Fourier coefficients of q̈ up to the band of the positions, or by central differences of it.
    ///
    /// Samples do not say where one record of several ends: at such a place the differences of two instants reach across.
    ///
    /// ```
    /// use armid::dynamics::States;
    /// use armid::signal::Samples;
    /// let (count, w) = (64, std::f64::consts::TAU);
    /// let mut states = States::new(1);
    /// for k in 0..count {
    ///     let (s, c) = (w * f64::from(k) / f64::from(count)).sin_cos();
    ///     states.push(&[s], &[w * c], &[-w * w * s]);
    /// }
    /// let samples = Samples::exact(states, vec![0.0; 64], vec!["N·m".to_owned()], 64.0);
    /// let samples = Samples { period_s: Some(1.0), ..samples };
    /// let jerk = samples.jerk();
    /// assert!((jerk[0] + w.powi(3)).abs() < 1e-9 && jerk[16].abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn jerk(&self) -> Vec<f64> {
        let (n, step) = (self.dof(), 1.0 / self.rate_hz);
        let transform = FourierTransform::new(self.len());
        let mut jerk = vec![0.0; self.states.qdd.len()];
        for i in 0..n {
            let qdd = column(&self.states.qdd, n, i);
            let own = match (self.period_s, self.derivatives) {
                (Some(period_s), Derivatives::Fourier) => {
                    let series = HarmonicSeries::new(&transform, &qdd, period_s);
                    let last = (self.position_band_hz[i] * period_s).round() as usize;
                    let last = last.min(series.highest());
                    series.up_to(last).samples(&transform).1
                }
                (Some(_), Derivatives::Differences) => differences_periodic(&qdd, step).0,
                (None, Derivatives::Fourier | Derivatives::Differences) => differences(&qdd, step).0,
            };
            put_column(&mut jerk, n, i, &own);
        }
        jerk
    }
}
