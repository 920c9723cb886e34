//! Intervals by drawing the sample again.

use rand::RngExt;

use super::interval::Interval;
use super::sample::quantile;
use crate::seed::{Seed, Stream};

/// Draws of the two-layer bootstrap: designs are drawn with replacement, then runs within each design drawn (A. C. Davison
/// and D. V. Hinkley, *Bootstrap Methods and their Application*, 1997, sec. 3.8). Where there is only one design, runs alone
/// are drawn.
#[derive(Debug)]
pub struct TwoLayerDraws<'a> {
    rng: Stream,
    sizes: &'a [&'a [usize]],
}

impl<'a> TwoLayerDraws<'a> {
    /// `sizes` holds the number of runs of each design, one entry per design and one list per criterion.
    #[must_use]
    pub fn new(sizes: &'a [&'a [usize]], seed: Seed) -> Self {
        Self { rng: seed.stream("bootstrap", 0), sizes }
    }

    /// The next draw: hands over every (criterion, design, run) that was drawn, criterion by criterion.
    pub fn draw(&mut self, mut take: impl FnMut(usize, usize, usize)) {
        for (criterion, designs) in self.sizes.iter().enumerate() {
            for _ in 0..designs.len() {
                let design = self.rng.random_range(0..designs.len());
                for _ in 0..designs[design] {
                    take(criterion, design, self.rng.random_range(0..designs[design]));
                }
            }
        }
    }
}

/// The interval between the percentiles of the statistic's values on `resamples` draws; `None` where more than half of them
/// were undefined and left out.
#[must_use]
pub fn percentile_interval(values: &[f64], resamples: usize, level: f64) -> Option<Interval> {
    if 2 * values.len() < resamples {
        return None;
    }
    let tail = 0.5 * (1.0 - level);
    Some(Interval { low: quantile(values, tail)?, high: quantile(values, 1.0 - tail)? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::mean;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn statistics_bootstrap_covers_a_known_mean() {
        // 200 data sets of 20 designs × 5 runs, design effect and run noise both unit normal: a 90 % interval of the
        // grand mean must cover 0 in 90 % of them. With 200 trials, 83 to 96 % holds but for a chance of 0.1 %.
        let sizes: [&[usize]; 1] = [&[5; 20]];
        let mut covered = 0;
        for set in 0..200 {
            let mut rng = Seed::new(5).stream("data", set);
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let data: Vec<Vec<f64>> = (0..20)
                .map(|_| {
                    let design = normal();
                    (0..5).map(|_| design + normal()).collect()
                })
                .collect();
            let mut draws = TwoLayerDraws::new(&sizes, Seed::new(set));
            let means: Vec<f64> = (0..300)
                .map(|_| {
                    let mut drawn = Vec::new();
                    draws.draw(|_, design, run| drawn.push(data[design][run]));
                    mean(&drawn)
                })
                .collect();
            covered += usize::from(percentile_interval(&means, 300, 0.9).unwrap().contains(0.0));
        }
        assert!((166..=192).contains(&covered), "covered {covered} of 200");
    }
}
