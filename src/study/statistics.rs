//! The few statistics that a study reports, each with its sample size and interval.
//!
//! Quantiles of the normal and t distributions come from `statrs`; everything that is summed is summed in the order in
//! which it is given, so that a result does not depend on the number of threads.

use rand::RngExt;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::seed::Seed;

/// A two-sided interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Whether a value lies inside, ends included.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

/// Arithmetic mean; 0 of nothing.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// Unbiased sample variance, with n − 1; 0 of fewer than two values.
#[must_use]
pub fn variance(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let m = mean(values);
    values.iter().map(|v| (v - m) * (v - m)).sum::<f64>() / (values.len() - 1) as f64
}

/// Root of the mean square; 0 of nothing.
#[must_use]
pub fn root_mean_square(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt() }
}

/// The `p` quantile by linear interpolation between order statistics (Hyndman & Fan 1996, definition 7); `None` of
/// nothing.
#[must_use]
pub fn quantile(values: &[f64], p: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile_of_sorted(&sorted, p)
}

fn quantile_of_sorted(sorted: &[f64], p: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let at = p.clamp(0.0, 1.0) * last as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(last);
    Some(sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64))
}

/// Five numbers that a box plot draws: 5 %, 25 %, 50 %, 75 % and 95 % quantiles.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Spread {
    /// 5 % quantile.
    pub low: f64,
    /// 25 % quantile.
    pub lower_quartile: f64,
    /// Median.
    pub median: f64,
    /// 75 % quantile.
    pub upper_quartile: f64,
    /// 95 % quantile.
    pub high: f64,
}

impl Spread {
    /// The five numbers of a sample; `None` of nothing.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        Some(Self {
            low: quantile_of_sorted(&sorted, 0.05)?,
            lower_quartile: quantile_of_sorted(&sorted, 0.25)?,
            median: quantile_of_sorted(&sorted, 0.5)?,
            upper_quartile: quantile_of_sorted(&sorted, 0.75)?,
            high: quantile_of_sorted(&sorted, 0.95)?,
        })
    }
}

/// Interval for the mean of independent values by Student's t at confidence `level`; `None` of fewer than two.
#[must_use]
pub fn t_interval(values: &[f64], level: f64) -> Option<Interval> {
    let n = values.len();
    if n < 2 {
        return None;
    }
    let t = StudentsT::new(0.0, 1.0, (n - 1) as f64).ok()?.inverse_cdf(0.5 + 0.5 * level);
    let (m, half) = (mean(values), t * (variance(values) / n as f64).sqrt());
    Some(Interval { low: m - half, high: m + half })
}

/// Wilson's score interval for a proportion of `hits` in `trials` at confidence `level` (E. B. Wilson, JASA 22, 1927).
#[must_use]
pub fn wilson_interval(hits: usize, trials: usize, level: f64) -> Option<Interval> {
    if trials == 0 {
        return None;
    }
    let z = Normal::standard().inverse_cdf(0.5 + 0.5 * level);
    let (n, p) = (trials as f64, hits as f64 / trials as f64);
    let centre = p + z * z / (2.0 * n);
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z * z / n;
    // Rounding may leave the ends a last bit inside of p where p is 0 or 1.
    Some(Interval { low: ((centre - half) / scale).clamp(0.0, p), high: ((centre + half) / scale).clamp(p, 1.0) })
}

/// Spearman's rank correlation of paired values, ties sharing their mean rank; `None` where either side is constant.
#[must_use]
pub fn rank_correlation(x: &[f64], y: &[f64]) -> Option<f64> {
    let (rx, ry) = (ranks(x), ranks(y));
    let (mx, my) = (mean(&rx), mean(&ry));
    let (mut sxy, mut sxx, mut syy) = (0.0, 0.0, 0.0);
    for (a, b) in rx.iter().zip(&ry) {
        sxy += (a - mx) * (b - my);
        sxx += (a - mx) * (a - mx);
        syy += (b - my) * (b - my);
    }
    (sxx > 0.0 && syy > 0.0).then(|| sxy / (sxx * syy).sqrt())
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut start = 0;
    while start < order.len() {
        let mut end = start + 1;
        while end < order.len() && values[order[end]].total_cmp(&values[order[start]]).is_eq() {
            end += 1;
        }
        for &index in &order[start..end] {
            ranks[index] = 0.5 * (start + end - 1) as f64;
        }
        start = end;
    }
    ranks
}

/// Percentile interval of a statistic by the two-layer bootstrap: designs are drawn with replacement, then runs within
/// each design drawn (A. C. Davison and D. V. Hinkley, *Bootstrap Methods and their Application*, 1997, sec. 3.8).
///
/// `sizes` holds the number of runs of each design, one entry per design and one list per criterion; `statistic` gets,
/// per criterion, the drawn (design, run) pairs. Where there is only one design, runs alone are drawn. A statistic of
/// `None` (undefined on a draw) is left out; the interval is `None` where more than half are undefined.
pub fn bootstrap_interval(
    sizes: &[&[usize]],
    resamples: usize,
    level: f64,
    seed: Seed,
    mut statistic: impl FnMut(&[Vec<(usize, usize)>]) -> Option<f64>,
) -> Option<Interval> {
    let mut rng = seed.stream("bootstrap", 0);
    let mut values = Vec::with_capacity(resamples);
    let mut drawn: Vec<Vec<(usize, usize)>> = vec![Vec::new(); sizes.len()];
    for _ in 0..resamples {
        for (criterion, designs) in sizes.iter().enumerate() {
            drawn[criterion].clear();
            for _ in 0..designs.len() {
                let design = rng.random_range(0..designs.len());
                for _ in 0..designs[design] {
                    drawn[criterion].push((design, rng.random_range(0..designs[design])));
                }
            }
        }
        values.extend(statistic(&drawn));
    }
    if 2 * values.len() < resamples {
        return None;
    }
    let tail = 0.5 * (1.0 - level);
    Some(Interval { low: quantile(&values, tail)?, high: quantile(&values, 1.0 - tail)? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn published_quantiles_of_the_definition() {
        // R: quantile(c(1,2,3,4,10), c(.1,.5,.75), type = 7) gives 1.4, 3, 4.
        let values = [10.0, 1.0, 3.0, 2.0, 4.0];
        for (p, expected) in [(0.1, 1.4), (0.5, 3.0), (0.75, 4.0)] {
            assert!((quantile(&values, p).unwrap() - expected).abs() < 1e-15);
        }
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn published_wilson_interval() {
        // Newcombe, Statistics in Medicine 17 (1998), table I, method 3: 81 of 263 gives 0.2553 to 0.3662.
        let interval = wilson_interval(81, 263, 0.95).unwrap();
        assert!((interval.low - 0.2553).abs() < 5e-5 && (interval.high - 0.3662).abs() < 5e-5);
    }

    #[test]
    fn published_t_interval() {
        // Student's t table: the 97.5 % quantile with 4 degrees of freedom is 2.776.
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        let interval = t_interval(&values, 0.95).unwrap();
        let half = 2.776 * (2.5_f64 / 5.0).sqrt();
        assert!((interval.high - (3.0 + half)).abs() < 5e-4 && (interval.low - (3.0 - half)).abs() < 5e-4);
    }

    #[test]
    fn analytic_rank_correlation() {
        assert_eq!(rank_correlation(&[1.0, 2.0, 3.0], &[10.0, 100.0, 1e6]), Some(1.0));
        assert_eq!(rank_correlation(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]), Some(-1.0));
        assert_eq!(rank_correlation(&[1.0, 1.0], &[3.0, 2.0]), None);
        // Ties share a rank: ranks (0.5, 0.5, 2) against (0, 1, 2) give √3/2.
        assert!((rank_correlation(&[1.0, 1.0, 2.0], &[1.0, 2.0, 3.0]).unwrap() - 0.75_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn statistics_bootstrap_covers_a_known_mean() {
        // 200 data sets of 20 designs × 5 runs, design effect and run noise both unit normal: a 90 % interval of the
        // grand mean must cover 0 in 90 % of them. With 200 trials, 83 to 96 % holds but for a chance of 0.1 %.
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
            let sizes = vec![5; 20];
            let interval = bootstrap_interval(&[&sizes], 300, 0.9, Seed::new(set), |drawn| {
                Some(mean(&drawn[0].iter().map(|&(d, r)| data[d][r]).collect::<Vec<_>>()))
            });
            covered += usize::from(interval.unwrap().contains(0.0));
        }
        assert!((166..=192).contains(&covered), "covered {covered} of 200");
    }
}
