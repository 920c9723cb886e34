//! Intervals that may be looked at several times while a sample grows, and may stop its growth.
//!
//! ```text
//! α*(t) = α ln( 1 + (e − 1) t )                      error spent at the fraction t of the largest sample, after Pocock
//! P( |Z_1| < c_1, …, |Z_k| < c_k ) = 1 − α*(t_k)     for every look k, Z_k √t_k being Brownian motion at t_k
//! interval at look k: x̄ ± T⁻¹_{n_k−1}( Φ(c_k) ) s / √n_k
//! ```
//! The intervals of all looks cover the mean simultaneously with probability 1 − α, so that each is valid under any
//! stopping rule (K. K. G. Lan and D. L. DeMets, Biometrika 70, 1983; C. Jennison and B. W. Turnbull, J. R. Stat. Soc.
//! B 51, 1989). Student's t in place of the normal distribution is their approximation by significance levels: of 20000
//! samples of normal numbers, looked at at 4, 6, 9, 13, 20 and 32, all six intervals covered the mean in 94.3 %.
//! The densities are integrated look by look (P. Armitage, C. K. McPherson and B. C. Rowe, J. R.
//! Stat. Soc. A 132, 1969).

use std::f64::consts::{E, FRAC_1_SQRT_2, PI};

use super::interval::{Interval, mean_interval};

/// Intervals of Simpson's rule.
const STEPS: usize = 400;

/// No bound is larger: the tail beyond it is no number.
const FARTHEST: f64 = 37.0;

/// The bounds c_k of the looks at these fractions of the largest sample, increasing and at most 1, for intervals that hold
/// together at confidence `level`. The error is spent about alike on every look: intervals are usable early.
pub fn pocock_bounds(fractions: &[f64], level: f64) -> Vec<f64> {
    let mut bounds = Vec::with_capacity(fractions.len());
    // Density of those that have stayed inside up to the look before, at the points of a rule of integration.
    let mut inside: Option<Inside> = None;
    let mut spent = 0.0;
    for (k, &fraction) in fractions.iter().enumerate() {
        let until_now = (1.0 - level) * libm::log1p((E - 1.0) * fraction);
        let step = (fraction - if k == 0 { 0.0 } else { fractions[k - 1] }).sqrt();
        let outside = |limit: f64| 2.0 * upper_tail(limit / step);
        let leaving = |limit: f64| inside.as_ref().map_or_else(|| outside(limit), |inside| inside.leaving(limit, step));
        let (mut low, mut high) = (0.0, FARTHEST * fraction.sqrt());
        // More halvings than a double has digits.
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if leaving(middle) > until_now - spent { low = middle } else { high = middle }
        }
        spent = until_now;
        bounds.push(high / fraction.sqrt());
        inside = Some(Inside::after(inside.as_ref(), high, step));
    }
    bounds
}

/// The interval at a look whose bound is `bound`; `None` of fewer than two values, or where it is infinite.
pub fn repeated_interval(values: &[f64], bound: f64) -> Option<Interval> {
    mean_interval(values, 1.0 - upper_tail(bound)).filter(|interval| (interval.high - interval.low).is_finite())
}

/// The density of what has stayed inside its bounds.
struct Inside {
    points: Vec<f64>,
    /// Density by the weight of the point.
    mass: Vec<f64>,
}

impl Inside {
    /// After another step of this standard deviation, within ±`limit`.
    fn after(before: Option<&Self>, limit: f64, step: f64) -> Self {
        let width = 2.0 * limit / STEPS as f64;
        let density = |x: f64| libm::exp(-0.5 * x * x / (step * step)) / (step * (2.0 * PI).sqrt());
        let points: Vec<f64> = (0..=STEPS).map(|i| -limit + width * i as f64).collect();
        let weight = |i: usize| {
            let simpson = if i == 0 || i == STEPS {
                1.0
            } else if i.is_multiple_of(2) {
                2.0
            } else {
                4.0
            };
            simpson * width / 3.0
        };
        let at = |x: f64| match before {
            None => density(x),
            Some(before) => before.points.iter().zip(&before.mass).map(|(from, mass)| mass * density(x - from)).sum(),
        };
        let mass = points.iter().enumerate().map(|(i, &x)| weight(i) * at(x)).collect();
        Self { points, mass }
    }

    /// How much leaves ±`limit` by a step of this standard deviation.
    fn leaving(&self, limit: f64, step: f64) -> f64 {
        let tails = |x: f64| upper_tail((limit - x) / step) + upper_tail((limit + x) / step);
        self.points.iter().zip(&self.mass).map(|(&x, mass)| mass * tails(x)).sum()
    }
}

/// 1 − Φ(z).
fn upper_tail(z: f64) -> f64 {
    0.5 * libm::erfc(z * FRAC_1_SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use crate::statistics::distribution::normal_quantile;
    use crate::statistics::t_interval;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn published_bounds_of_five_equal_looks() {
        // Lan & DeMets (1983) and the tables of Reboussin, DeMets, Kim & Lan (Controlled Clinical Trials 21, 2000): two
        // sides, error 0.05.
        let fifths = [0.2, 0.4, 0.6, 0.8, 1.0];
        for (bound, published) in pocock_bounds(&fifths, 0.95).into_iter().zip([2.4380, 2.4268, 2.4101, 2.3966, 2.3859])
        {
            assert!((bound - published).abs() < 2e-4, "{bound}, published {published}");
        }
    }

    #[test]
    fn identity_one_look_has_the_interval_of_one() {
        let bound = pocock_bounds(&[1.0], 0.95)[0];
        assert!((bound - normal_quantile(0.975)).abs() < 1e-12, "{bound}");
        let values = [1.0, 4.0, 2.0, 9.0];
        let (one, other) = (repeated_interval(&values, bound).unwrap(), t_interval(&values, 0.95).unwrap());
        assert!((one.low - other.low).abs() < 1e-9 && (one.high - other.high).abs() < 1e-9);
        assert_eq!(repeated_interval(&[1.0], 2.0), None);
    }

    /// Shares of 4000 samples of up to 32 normal numbers, looked at at 4, 6, 9, 13, 20 and 32, in which the interval at the
    /// end holds the mean: by intervals of all looks, and by Student's at the same looks. The end is where the half width
    /// is below 0.6 for the first time.
    fn coverage() -> (f64, f64) {
        let looks = [4, 6, 9, 13, 20, 32];
        let bounds = pocock_bounds(&looks.map(|n| f64::from(n) / 32.0), 0.95);
        let plain = vec![normal_quantile(0.975); bounds.len()];
        let trials = 4000;
        let covered = |bounds: &[f64]| {
            let covered = (0..trials).filter(|&trial| {
                let mut rng = Seed::new(17).stream("repeated interval", trial);
                let values: Vec<f64> = (0..32).map(|_| StandardNormal.sample(&mut rng)).collect();
                let at = |k: usize| repeated_interval(&values[..looks[k] as usize], bounds[k]);
                let narrow = |k: &usize| at(*k).is_some_and(|i| i.high - i.low < 1.2);
                let end = (0..looks.len()).find(narrow).unwrap_or(looks.len() - 1);
                at(end).unwrap().contains(0.0)
            });
            covered.count() as f64 / trials as f64
        };
        (covered(&bounds), covered(&plain))
    }

    #[test]
    fn statistics_intervals_hold_where_their_own_width_ends_the_sample() {
        // The standard deviation of a share of 0.95 of 4000 is 0.0034: three of them below.
        let (repeated, plain) = coverage();
        assert!(repeated > 0.95 - 3.0 * 0.0034, "{repeated}");
        // The test sees what it is for: a narrow interval of a small sample is narrow by chance.
        assert!(plain < 0.95 - 3.0 * 0.0034, "{plain}");
    }
}
