//! How many designs, truths and runs a wanted interval needs, from a study that was performed: a pilot.
//!
//! ```text
//! d_ktr = ln y_1 − ln y_2          start k of both families, truth t, run r of that truth
//! d_ktr = μ + s_k + t_t + e_ktr     variances σ_s², σ_t², σ_e² of starts, truths, and of what is left: interaction and noise
//! var d̄ = σ_s²/K + σ_t²/T + σ_e²/(K R)      K starts, T truths, R runs of each start
//! half width e^{h} − 1,  h = T⁻¹_ν(0.975) √(var d̄)
//! ```
//! with ν = K − 1, and min(K, T) − 1 where truths are drawn. A pilot knows its variances poorly, and the half width of the study
//! that follows scatters as well. A size is therefore given for the wanted half width with a stated [`ASSURANCE`], not for what is
//! merely expected, from draws of what the pilot says of the variances and of what the study will find:
//!
//! ```text
//! M_i* = M_i ν_i/χ²(ν_i)     mean squares of pairs, truths and rest, and from them σ_s*², σ_t*², σ_e*² ≥ 0
//! var d̄* χ²(ν)/ν             its quantile at the assurance
//! ```
//! (S. Weerahandi, *J. Am. Stat. Assoc.* 88(423), 1993, for the draws; R. H. Browne, *Statistics in Medicine* 14(17), 1995, for sizes
//! from pilots.) The variances are those of the analysis of variance of a crossed
//! layout (S. R. Searle, G. Casella, C. E. McCulloch, *Variance Components*, 1992, ch. 4), no less than zero. Without
//! drawn truths the term of σ_t² is absent, and runs of a start are its replicates.

use rand_distr::{ChiSquared, Distribution};

use crate::seed::Seed;
use crate::statistics::{mean, quantile, student_quantile, variance};

/// Confidence of the interval that is planned.
const LEVEL: f64 = 0.95;

/// Probability with which a study of the size that is given has an interval as narrow as wanted.
pub const ASSURANCE: f64 = 0.8;

/// Draws for a half width with an assurance: its probability is then within 0.01, the standard deviation of a share of 0.8.
const DRAWS: usize = 2000;

/// More starts are not asked for.
const MOST_STARTS: usize = 10_000;

/// Variances of the logarithm of a ratio.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct VarianceComponents {
    /// Of pairs of starts.
    pub starts: f64,
    /// Of drawn truths; `None` where there are none.
    pub truths: Option<f64>,
    /// Of single runs of a pair of starts on a truth.
    pub runs: f64,
    /// Pairs of starts and runs of each that the pilot had.
    pub pilot: (usize, usize),
}

/// What a study is to have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct StudySize {
    /// Starts of each family.
    pub starts: usize,
    /// Truths that are drawn; `None` where there are none.
    pub truths: Option<usize>,
    /// Runs of each design.
    pub runs: usize,
}

impl VarianceComponents {
    /// The components by a pilot's logarithms of ratios, by pair of starts and by run: every pair has as many runs, and run r of every
    /// pair is on the same truth where truths are drawn, one for each run. `None` of fewer than two pairs or runs.
    pub fn new(logs: &[Vec<f64>], truths: bool) -> Option<Self> {
        let (starts, runs) = (logs.len(), logs.first()?.len());
        if starts < 2 || runs < 2 || logs.iter().any(|of_pair| of_pair.len() != runs) {
            return None;
        }
        let rows: Vec<f64> = logs.iter().map(|of_pair| mean(of_pair)).collect();
        let (k, r) = (starts as f64, runs as f64);
        if !truths {
            let within = mean(&logs.iter().map(|of_pair| variance(of_pair)).collect::<Vec<_>>());
            let starts = (variance(&rows) - within / r).max(0.0);
            return Some(Self { starts, truths: None, runs: within, pilot: (logs.len(), runs) });
        }
        let columns: Vec<f64> =
            (0..runs).map(|run| mean(&logs.iter().map(|of_pair| of_pair[run]).collect::<Vec<_>>())).collect();
        let grand = mean(&rows);
        let mut left = 0.0;
        for (of_pair, row) in logs.iter().zip(&rows) {
            for (log, column) in of_pair.iter().zip(&columns) {
                left += (log - row - column + grand).powi(2);
            }
        }
        let residual = left / ((k - 1.0) * (r - 1.0));
        Some(Self {
            starts: (variance(&rows) - residual / r).max(0.0),
            truths: Some((variance(&columns) - residual / k).max(0.0)),
            runs: residual,
            pilot: (starts, runs),
        })
    }

    /// The half width over the ratio that a study of this size can expect; infinite of one start or truth.
    pub fn share(&self, size: StudySize) -> f64 {
        share(self.variance(size), size)
    }

    /// The half width over the ratio that a study of this size stays below with probability `assurance`; infinite of one start
    /// or truth.
    pub fn share_with(&self, size: StudySize, assurance: f64) -> f64 {
        let Some(freedom) = size.freedom() else { return f64::INFINITY };
        // The same draws for every size, so that more starts never need a wider interval by chance.
        let mut rng = Seed::new(0).stream("pilot", 0);
        let mut scaled = |freedom: f64| {
            let draws = ChiSquared::new(freedom).expect("a pilot has two pairs and two runs, a study two of its units");
            freedom / draws.sample(&mut rng)
        };
        let (pairs, runs) = (self.pilot.0 as f64, self.pilot.1 as f64);
        let left = if self.truths.is_some() { pairs - 1.0 } else { pairs } * (runs - 1.0);
        let variances: Vec<f64> = (0..DRAWS)
            .map(|_| {
                let of_runs = self.runs * scaled(left);
                let of_pairs = (self.starts + self.runs / runs) * scaled(pairs - 1.0);
                let of_truths = self.truths.map(|truths| (truths + self.runs / pairs) * scaled(runs - 1.0));
                let drawn = Self {
                    starts: (of_pairs - of_runs / runs).max(0.0),
                    truths: of_truths.map(|truths| (truths - of_runs / pairs).max(0.0)),
                    runs: of_runs,
                    ..*self
                };
                drawn.variance(size) / scaled(freedom)
            })
            .collect();
        quantile(&variances, assurance).map_or(f64::INFINITY, |variance| share(variance, size))
    }

    /// The variance of a study's mean logarithm.
    fn variance(&self, size: StudySize) -> f64 {
        let (k, r) = (size.starts as f64, size.runs as f64);
        let of_truths = match (self.truths, size.truths) {
            (Some(variance), Some(truths)) => variance / truths as f64,
            _ => 0.0,
        };
        self.starts / k + of_truths + self.runs / (k * r)
    }

    /// The fewest starts that give this half width, with probability [`ASSURANCE`], from so many runs of each, on as many truths where
    /// they are drawn; `None` where no number of starts does.
    pub fn fewest(&self, share: f64, runs: usize) -> Option<StudySize> {
        let size = |starts| StudySize { starts, truths: self.truths.map(|_| runs), runs };
        let of = |starts| self.share_with(size(starts), ASSURANCE);
        if of(MOST_STARTS) >= share {
            return None;
        }
        let (mut few, mut enough) = (1, MOST_STARTS);
        while enough - few > 1 {
            let middle = usize::midpoint(few, enough);
            if of(middle) < share { enough = middle } else { few = middle }
        }
        Some(size(enough))
    }
}

impl StudySize {
    /// Degrees of freedom of the study's interval; `None` of one start or truth.
    fn freedom(self) -> Option<f64> {
        let units = self.truths.map_or(self.starts, |truths| truths.min(self.starts));
        (units >= 2).then(|| (units - 1) as f64)
    }
}

/// The half width over the ratio from the variance of the mean logarithm.
fn share(variance: f64, size: StudySize) -> f64 {
    size.freedom()
        .map_or(f64::INFINITY, |freedom| libm::expm1(student_quantile(0.5 + 0.5 * LEVEL, freedom) * variance.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand_distr::{Distribution, StandardNormal};

    /// Pairs of starts with standard deviations 0.2 of starts, 0.1 of truths, 0.3 of runs.
    fn draw(seed: u64, starts: usize, runs: usize, truths: bool) -> Vec<Vec<f64>> {
        let mut rng = Seed::new(seed).stream("pilot", 0);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let of_truths: Vec<f64> = (0..runs).map(|_| if truths { 0.1 * normal() } else { 0.0 }).collect();
        (0..starts)
            .map(|_| {
                let start = 0.5 + 0.2 * normal();
                of_truths.iter().map(|truth| start + truth + 0.3 * normal()).collect()
            })
            .collect()
    }

    #[test]
    fn statistics_components_are_unbiased() {
        // Means over 400 pilots of 8 starts and 6 runs. The standard deviation of one estimate of σ_s² is below 0.05, of σ_t²
        // below 0.03, of σ_e² below 0.03: of the means 0.0025, 0.0015 and 0.0015. Cutting at zero lifts σ_t² a little.
        for truths in [false, true] {
            let found: Vec<VarianceComponents> =
                (0..400).map(|seed| VarianceComponents::new(&draw(seed, 8, 6, truths), truths).unwrap()).collect();
            let average = |of: &dyn Fn(&VarianceComponents) -> f64| mean(&found.iter().map(of).collect::<Vec<_>>());
            assert!((average(&|c| c.starts) - 0.04).abs() < 0.0075);
            assert!((average(&|c| c.runs) - 0.09).abs() < 0.0045);
            if truths {
                assert!((average(&|c| c.truths.unwrap()) - 0.01).abs() < 0.0065);
            }
        }
        assert_eq!(VarianceComponents::new(&[vec![1.0, 2.0]], false), None);
        assert_eq!(VarianceComponents::new(&[vec![1.0], vec![2.0]], false), None);
        assert_eq!(VarianceComponents::new(&[vec![1.0, 2.0], vec![2.0]], false), None);
    }

    #[test]
    fn analytic_size_is_the_smallest_that_suffices() {
        let components = VarianceComponents { starts: 0.04, truths: None, runs: 0.09, pilot: (100_000, 10) };
        let size = components.fewest(0.1, 10).unwrap();
        assert_eq!((size.truths, size.runs), (None, 10));
        let share = |starts| components.share_with(StudySize { starts, ..size }, ASSURANCE);
        assert!(share(size.starts) < 0.1 && share(size.starts - 1) >= 0.1);
        // Normal instead of Student: (1.96 / ln 1.1)² (0.04 + 0.009) = 20.7 starts, two more for the degrees of freedom, and a pilot
        // that knows its variances leaves the scatter of the study's own: χ² of 25 degrees of freedom has 31 at 80 %, a quarter more.
        assert!((24..=29).contains(&size.starts), "{size:?}");
        // No number of starts makes up for few truths.
        let truths = VarianceComponents { truths: Some(0.01), ..components };
        assert_eq!(truths.fewest(0.05, 10), None);
        assert!(truths.fewest(0.05, 100).is_some());
    }

    /// Pilots and studies of their forecast, as shares of the half width obtained over the one that was given with 80 %.
    fn obtained(pilots: u64, truths: bool, pilot_size: (usize, usize), study: StudySize) -> Vec<f64> {
        let drawn = |seed| {
            let components = VarianceComponents::new(&draw(seed, pilot_size.0, pilot_size.1, truths), truths).unwrap();
            let share = components.share_with(study, ASSURANCE);
            let second =
                VarianceComponents::new(&draw(1_000_000 + seed, study.starts, study.runs, truths), truths).unwrap();
            second.share(study) / share
        };
        (0..pilots).map(drawn).collect()
    }

    #[test]
    fn statistics_a_size_gives_its_interval_with_the_stated_probability() {
        // 2000 pilots each: a share of 0.8 has a standard deviation of 0.009. With as many runs as the pilot the variance of a
        // pair's mean is the pilot's own mean square and the statement exact; with more of them, or drawn truths, a component that is
        // cut at zero makes it safer.
        let of_2000 = |pilot, truths, study| {
            obtained(2000, truths, pilot, study).iter().filter(|&&ratio| ratio < 1.0).count() as f64 / 2000.0
        };
        let size = |starts, truths, runs| StudySize { starts, truths, runs };
        for pilot in [(12, 6), (5, 6)] {
            let share = of_2000(pilot, false, size(60, None, 6));
            assert!((0.77..0.84).contains(&share), "pilot {pilot:?}: {share}");
        }
        for (pilot, truths, study) in [((5, 3), false, size(60, None, 12)), ((8, 6), true, size(40, Some(30), 30))] {
            let share = of_2000(pilot, truths, study);
            assert!((0.77..0.95).contains(&share), "pilot {pilot:?}: {share}");
        }
    }
}
