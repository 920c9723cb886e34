//! How many designs, truths and runs a wanted interval needs, from a study that was performed: a pilot.
//!
//! ```text
//! d_ktr = ln y_1 − ln y_2          start k of both families, truth t, run r of that truth
//! d_ktr = μ + s_k + t_t + e_ktr     variances σ_s², σ_t², σ_e² of starts, truths, and of what is left: interaction and noise
//! var d̄ = σ_s²/K + σ_t²/T + σ_e²/(K R)      K starts, T truths, R runs of each start
//! half width e^{h} − 1,  h = T⁻¹_ν(0.975) √(var d̄)
//! ```
//! with ν = K − 1, and min(K, T) − 1 where truths are drawn. The variances are those of the analysis of variance of a crossed
//! layout (S. R. Searle, G. Casella, C. E. McCulloch, *Variance Components*, 1992, ch. 4), no less than zero. Without
//! drawn truths σ_t² is not there, and runs of a start are its replicates.

use crate::statistics::{mean, student_quantile, variance};

/// Confidence of the interval that is planned.
const LEVEL: f64 = 0.95;

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
    /// From a pilot's logarithms of ratios, by pair of starts and by run: every pair has as many runs, and run r of every
    /// pair is on the same truth where truths are drawn, one for each run. `None` of fewer than two pairs or runs.
    #[must_use]
    pub fn of(logs: &[Vec<f64>], truths: bool) -> Option<Self> {
        let (starts, runs) = (logs.len(), logs.first()?.len());
        if starts < 2 || runs < 2 || logs.iter().any(|of_pair| of_pair.len() != runs) {
            return None;
        }
        let rows: Vec<f64> = logs.iter().map(|of_pair| mean(of_pair)).collect();
        let (k, r) = (starts as f64, runs as f64);
        if !truths {
            let within = mean(&logs.iter().map(|of_pair| variance(of_pair)).collect::<Vec<_>>());
            return Some(Self { starts: (variance(&rows) - within / r).max(0.0), truths: None, runs: within });
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
        })
    }

    /// The half width over the ratio that a study of this size can expect; infinite of one start or truth.
    #[must_use]
    pub fn share(&self, size: StudySize) -> f64 {
        let (k, r) = (size.starts as f64, size.runs as f64);
        let of_truths = match (self.truths, size.truths) {
            (Some(variance), Some(truths)) => variance / truths as f64,
            _ => 0.0,
        };
        let units = size.truths.map_or(size.starts, |truths| truths.min(size.starts));
        if units < 2 {
            return f64::INFINITY;
        }
        let deviation = (self.starts / k + of_truths + self.runs / (k * r)).sqrt();
        libm::expm1(student_quantile(0.5 + 0.5 * LEVEL, (units - 1) as f64) * deviation)
    }

    /// The fewest starts that give this half width with so many runs of each, on as many truths where they are drawn; `None`
    /// where no number of starts does.
    #[must_use]
    pub fn fewest(&self, share: f64, runs: usize) -> Option<StudySize> {
        let size = |starts| StudySize { starts, truths: self.truths.map(|_| runs), runs };
        if self.share(size(MOST_STARTS)) >= share {
            return None;
        }
        let (mut few, mut enough) = (1, MOST_STARTS);
        while enough - few > 1 {
            let middle = usize::midpoint(few, enough);
            if self.share(size(middle)) < share { enough = middle } else { few = middle }
        }
        Some(size(enough))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use crate::statistics::t_interval;
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
                (0..400).map(|seed| VarianceComponents::of(&draw(seed, 8, 6, truths), truths).unwrap()).collect();
            let average = |of: &dyn Fn(&VarianceComponents) -> f64| mean(&found.iter().map(of).collect::<Vec<_>>());
            assert!((average(&|c| c.starts) - 0.04).abs() < 0.0075);
            assert!((average(&|c| c.runs) - 0.09).abs() < 0.0045);
            if truths {
                assert!((average(&|c| c.truths.unwrap()) - 0.01).abs() < 0.0065);
            }
        }
        assert_eq!(VarianceComponents::of(&[vec![1.0, 2.0]], false), None);
        assert_eq!(VarianceComponents::of(&[vec![1.0], vec![2.0]], false), None);
        assert_eq!(VarianceComponents::of(&[vec![1.0, 2.0], vec![2.0]], false), None);
    }

    #[test]
    fn analytic_size_is_the_smallest_that_suffices() {
        let components = VarianceComponents { starts: 0.04, truths: None, runs: 0.09 };
        let size = components.fewest(0.1, 10).unwrap();
        assert_eq!((size.truths, size.runs), (None, 10));
        assert!(components.share(size) < 0.1);
        assert!(components.share(StudySize { starts: size.starts - 1, ..size }) >= 0.1);
        // Normal instead of Student: (1.96 / ln 1.1)² (0.04 + 0.009) = 20.7 starts, two more for the degrees of freedom.
        assert!((21..=25).contains(&size.starts), "{size:?}");
        // No number of starts makes up for few truths.
        let truths = VarianceComponents { truths: Some(0.01), ..components };
        assert_eq!(truths.fewest(0.05, 10), None);
        assert!(truths.fewest(0.05, 100).is_some());
    }

    #[test]
    fn statistics_five_pilots_foretell_the_intervals_of_five_studies() {
        // Pilots of 12 starts and studies of 60, 6 runs each. A half width is as sure as the standard deviation in it: of 11
        // and 59 degrees of freedom, 21 % and 9 % of one, together 23 %. Within 2.6 of these, 60 %, by chance but for 5 %.
        for seed in 0..5 {
            let pilot = VarianceComponents::of(&draw(seed, 12, 6, false), false).unwrap();
            let foretold = pilot.share(StudySize { starts: 60, truths: None, runs: 6 });
            let study: Vec<f64> = draw(100 + seed, 60, 6, false).iter().map(|of_pair| mean(of_pair)).collect();
            let interval = t_interval(&study, LEVEL).unwrap();
            let obtained = libm::expm1(0.5 * (interval.high - interval.low));
            assert!((foretold / obtained).ln().abs() < 0.6, "pilot {seed}: {foretold} foretold, {obtained} obtained");
        }
    }
}
