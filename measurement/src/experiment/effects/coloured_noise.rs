//! Correlated current noise: an autoregression of order one with the variance of white noise.
//!
//! ```text
//! n_k = ρ n_{k−1} + √(1 − ρ²) σ w_k      w white, unit      ρ = exp(−1/(f T))      E n_k n_{k+l} = σ² ρ^|l|
//! S(ν) = σ²/f (1 − ρ²) / (1 − 2ρ cos(2πν/f) + ρ²)      two-sided, per Hz
//! ```
//! `f` is the rate of the samples, `T` the time in which the correlation falls to 1/e. The spectrum is flat below
//! 1/(2πT) and falls with the square of the frequency above: between the two it is what 1/f noise is over a decade.

/// Memory of the noise of one sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::experiment) struct Memory {
    keeps: f64,
    fresh: f64,
    last: Option<f64>,
}

impl Memory {
    /// Noise whose correlation falls to 1/e in `time_s` at a sampling rate of `rate_hz`; 0 s is white.
    pub(super) fn new(time_s: f64, rate_hz: f64) -> Self {
        let keeps = if time_s > 0.0 { libm::exp(-1.0 / (rate_hz * time_s)) } else { 0.0 };
        Self { keeps, fresh: (1.0 - keeps * keeps).sqrt(), last: None }
    }

    /// The next value, from a unit normal one.
    pub(in crate::experiment) fn next(&mut self, white: f64) -> f64 {
        let next = match self.last {
            // The first is drawn from the stationary distribution.
            None => white,
            Some(last) => self.keeps * last + self.fresh * white,
        };
        self.last = Some(next);
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn analytic_lag_one_covariance() {
        let mut memory = Memory::new(5e-3, 1000.0);
        let mut stream = Seed::new(6).stream("noise", 0);
        let values: Vec<f64> = (0..200_000).map(|_| memory.next(StandardNormal.sample(&mut stream))).collect();
        let lag =
            |l: usize| values.iter().zip(&values[l..]).map(|(a, b)| a * b).sum::<f64>() / (values.len() - l) as f64;
        // ρ = exp(−1/5); Bartlett: the standard deviation of lag 0 is √(2 (1 + ρ²)/(1 − ρ²)/N) = 0.0071, of the others
        // less; 4 of them.
        let rho = (-0.2_f64).exp();
        for l in [0, 1, 5, 20] {
            assert!((lag(l) - rho.powi(l as i32)).abs() < 0.029, "{l}: {}", lag(l));
        }
    }

    #[test]
    fn identity_without_time_it_is_white() {
        let mut memory = Memory::new(0.0, 1000.0);
        for white in [0.3, -1.2, 0.7] {
            assert_eq!(memory.next(white), white);
        }
    }
}
