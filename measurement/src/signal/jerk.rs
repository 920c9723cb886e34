//! The derivative of the acceleration.

use super::columns::{column, put_column};
use super::differences::{differences, differences_periodic};
use super::fourier_transform::FourierTransform;
use super::harmonics::HarmonicSeries;
use super::processing::Derivatives;
use super::samples::Samples;

impl Samples {
    /// `q⃛` at every sample, N × n row-major, rad/s³ (m/s³), by the route that velocity and acceleration came by: through the
    /// Fourier coefficients of the positions up to their band, or by central differences of q̈.
    ///
    /// Where the noise of the positions is known, each coefficient counts by the share of its power that is signal: what is expected of q⃛, given what was
    /// measured. In a column of equations that leaves no attenuation, as noise beside it would (regression calibration; R. J. Carroll et al.,
    /// Measurement Error in Nonlinear Models, Chapman & Hall, 2006, chapter 4): the third derivative has far more noise than the second. Shares of
    /// few lines are known badly: with 150 lines above the noise 1 % of attenuation is left of 13 %, with 16 lines 15 % of 29 %.
    ///
    /// ```
    /// # use armid_measurement as armid;
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
    pub fn jerk(&self) -> Vec<f64> {
        if !self.joined.is_empty() {
            return self.apart().flat_map(|of| of.jerk()).collect();
        }
        let (n, step) = (self.dof(), 1.0 / self.rate_hz);
        let transform = FourierTransform::new(self.len());
        let mut jerk = vec![0.0; self.states.qdd.len()];
        for i in 0..n {
            let qdd = column(&self.states.qdd, n, i);
            let own = match (self.period_s, self.derivatives) {
                (Some(period_s), Derivatives::Fourier) => {
                    let series = |x: &[f64]| {
                        let series = HarmonicSeries::new(&transform, &column(x, n, i), period_s);
                        let last = (self.position_band_hz[i] * period_s).round() as usize;
                        let last = last.min(series.highest());
                        series.up_to(last)
                    };
                    let floor = self.position_floor.get(i).copied().unwrap_or(0.0);
                    let shares = series(&self.states.q).signal_shares(floor);
                    series(&self.states.qd).weighted(&shares).samples(&transform).qdd
                }
                (Some(_), Derivatives::Differences) => differences_periodic(&qdd, step).0,
                (None, Derivatives::Fourier | Derivatives::Differences) => differences(&qdd, step).0,
            };
            put_column(&mut jerk, n, i, &own);
        }
        jerk
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::dynamics::States;
    use crate::seed::Seed;

    #[test]
    fn analytic_without_a_period_it_is_the_slope_of_the_acceleration() {
        let (count, rate_hz, w) = (50, 40.0, 3.0);
        let mut states = States::new(1);
        for k in 0..count {
            let (s, c) = libm::sincos(w * f64::from(k) / rate_hz);
            states.push(&[-s / (w * w)], &[-c / w], &[s]);
        }
        for derivatives in Derivatives::ALL {
            let samples = Samples::exact(states.clone(), vec![0.0; 50], vec!["N·m".to_owned()], rate_hz);
            let jerk = Samples { derivatives, ..samples }.jerk();
            // Central differences make a tone smaller by sin(ωh)/(ωh).
            let gain = libm::sin(w / rate_hz) / (w / rate_hz);
            for k in 1..count - 1 {
                let expected = gain * w * libm::cos(w * f64::from(k) / rate_hz);
                assert!((jerk[k as usize] - expected).abs() < 1e-11, "{k}: {} {expected}", jerk[k as usize]);
            }
        }
    }

    /// A column with an error in it draws its coefficient towards zero; one that is what is expected of it, given what was measured, does not.
    #[test]
    fn analytic_what_is_expected_of_the_third_derivative_has_slope_one() {
        let (count, period_s, std) = (1000, 5.0, 1e-7);
        let transform = FourierTransform::new(count);
        let w = std::f64::consts::TAU / period_s;
        // Friction that reverses: amplitudes of the third derivative that do not fall.
        let line = |h: usize| (h as f64 * 1.7, 0.02 * libm::pow(h as f64, -3.0));
        let signal = |k: usize, order: i32| -> f64 {
            let angle = |h: usize| std::f64::consts::TAU * ((h * k) % count) as f64 / count as f64 + line(h).0;
            let of = |h: usize| {
                let rate = line(h).1 * (w * h as f64).powi(order);
                if order == 0 { rate * libm::cos(angle(h)) } else { rate * libm::sin(angle(h)) }
            };
            (1..400).map(of).sum()
        };
        let (truth, clean): (Vec<f64>, Vec<f64>) = (0..count).map(|k| (signal(k, 3), signal(k, 0))).unzip();
        let (mut slope, mut raw) = (0.0, 0.0);
        let runs = 20;
        for run in 0..runs {
            let mut rng = Seed::new(8).stream("encoder", run);
            let noisy: Vec<f64> = clean
                .iter()
                .map(|q| {
                    let z: f64 = StandardNormal.sample(&mut rng);
                    q + std * z
                })
                .collect();
            let series = HarmonicSeries::new(&transform, &noisy, period_s);
            let last = series.last_above_noise(std * std, count);
            let floor = series.floor(std * std, count);
            let samples = Samples {
                period_s: Some(period_s),
                position_band_hz: vec![last as f64 / period_s],
                ..Samples::exact(
                    series.up_to(last).samples(&transform),
                    vec![0.0; count],
                    vec!["N·m".to_owned()],
                    count as f64 / period_s,
                )
            };
            let regress = |x: &[f64]| {
                let (mut above, mut below) = (0.0, 0.0);
                for (x, y) in x.iter().zip(&truth) {
                    above += x * y;
                    below += x * x;
                }
                above / below / runs as f64
            };
            raw += regress(&samples.jerk());
            slope += regress(&Samples { position_floor: vec![floor], ..samples }.jerk());
        }
        assert!((slope - 1.0).abs() < 0.03 && raw < 0.9, "{slope} {raw}");
    }
}
