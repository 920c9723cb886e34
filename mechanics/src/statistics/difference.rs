//! The difference of two means with Student's t, and p-values of many comparisons.
//!
//! ```text
//! paired    d̄ ± t_{n−1} s_d/√n                  d_k = x_k − y_k of n matched units
//! Welch     x̄ − ȳ ± t_ν √(v_x + v_y)            v = s²/n of either sample,  ν = (v_x + v_y)² / (v_x²/(n_x − 1) + v_y²/(n_y − 1))
//! crossed   ȳ ± t_ν √(E/(r c))                  E = MS_rows + MS_columns of y_ik, one value of each of r rows in each of c columns,
//!                                               ν = E² / (MS_rows²/(r − 1) + MS_columns²/(c − 1))
//! Holm      p̃_(i) = max_{j ≤ i} min(1, (m − j + 1) p_(j))        p_(1) ≤ … ≤ p_(m)
//! ```
//! Rows and columns of a crossed difference are both samples. With variances σ_r², σ_c² and σ² of rows, columns and the rest, the
//! expectation of E is that of r c times the variance of ȳ plus σ²: the interval is wide enough, and hardly too wide where rows or
//! columns differ by more than the rest. An unbiased E would subtract the rest's mean square, and be below zero at times.
//!
//! B. L. Welch, *Biometrika* 34 (1947), 28–35; F. E. Satterthwaite, *Biometrics Bulletin* 2 (1946), 110–114; S. Holm, *Scandinavian Journal of Statistics* 6 (1979), 65–70.

use super::distribution::student_quantile;
use super::f_distribution::f_tail;
use super::interval::Interval;
use super::sample::{mean, variance};

/// The difference of two means, how sure it is, and how surprising it would be where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanDifference {
    /// The difference of the means.
    pub difference: f64,
    /// Its interval.
    pub interval: Interval,
    /// Degrees of freedom of Student's t; no whole number by Welch.
    pub degrees_of_freedom: f64,
    /// Two-sided p-value of no difference.
    pub p: f64,
}

/// Two-sided p-value of Student's `t` with `freedom` degrees of freedom, `P(|T| ≥ |t|)`: NaN where `t` is, or where `freedom` is not
/// positive.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::statistics::student_p_value;
/// // With one degree of freedom T is Cauchy's: P(|T| ≥ 1) = 1/2.
/// assert!((student_p_value(-1.0, 1.0) - 0.5).abs() < 1e-14);
/// ```
pub fn student_p_value(t: f64, freedom: f64) -> f64 {
    // t² is the F of one and ν degrees of freedom.
    f_tail(t * t, 1.0, freedom)
}

/// Mean of the differences of matched units, with its interval at confidence `level`; `None` of fewer than two, or where one is no
/// finite number.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::statistics::paired_difference;
/// let found = paired_difference(&[1.0, 3.0], 0.95).unwrap();
/// // s/√n = 1, t = 2 with one degree of freedom: p = 1 − (2/π) arctan 2.
/// assert!((found.p - (1.0 - 2.0_f64.atan() / std::f64::consts::FRAC_PI_2)).abs() < 1e-13);
/// ```
pub fn paired_difference(differences: &[f64], level: f64) -> Option<MeanDifference> {
    let n = differences.len();
    if n < 2 {
        return None;
    }
    let squared_error = variance(differences) / n as f64;
    mean_difference(mean(differences), squared_error, (n - 1) as f64, level)
}

/// Difference of the means of two independent samples whose variances may differ, first less second, with Welch's interval at confidence
/// `level`; `None` where either has fewer than two values, or one is no finite number.
pub fn welch_difference(first: &[f64], second: &[f64], level: f64) -> Option<MeanDifference> {
    if first.len() < 2 || second.len() < 2 {
        return None;
    }
    let parts = [first, second].map(|of| (variance(of) / of.len() as f64, (of.len() - 1) as f64));
    let (sum, freedom) = satterthwaite(parts, parts[0].1 + parts[1].1);
    mean_difference(mean(first) - mean(second), sum, freedom, level)
}

/// The sum of two variances, and its degrees of freedom from theirs: `without` where it is zero.
fn satterthwaite([(v1, n1), (v2, n2)]: [(f64, f64); 2], without: f64) -> (f64, f64) {
    let sum = v1 + v2;
    // By shares of the sum, whose squares stay in range.
    let (share1, share2) = (v1 / sum, v2 / sum);
    (sum, if sum > 0.0 { 1.0 / (share1 * share1 / n1 + share2 * share2 / n2) } else { without })
}

/// Mean of differences of which each unit (row) has one under each of the same draws (columns), with an interval at confidence `level`
/// over both; `None` of fewer than two of either, where a row has another length, or where one is no finite number.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::statistics::crossed_difference;
/// // The same in every column: no mean square but that of the rows, as of two pairs.
/// let found = crossed_difference(&[vec![1.0, 1.0], vec![3.0, 3.0]], 0.95).unwrap();
/// assert_eq!((found.difference, found.degrees_of_freedom), (2.0, 1.0));
/// ```
pub fn crossed_difference(cells: &[Vec<f64>], level: f64) -> Option<MeanDifference> {
    let (rows, columns) = (cells.len(), cells.first()?.len());
    if rows < 2 || columns < 2 || cells.iter().any(|row| row.len() != columns) {
        return None;
    }
    let of_rows: Vec<f64> = cells.iter().map(|row| mean(row)).collect();
    let of_columns: Vec<f64> =
        (0..columns).map(|k| mean(&cells.iter().map(|row| row[k]).collect::<Vec<f64>>())).collect();
    // Each is the variance of means over the other side.
    let parts = [(&of_rows, rows), (&of_columns, columns)].map(|(of, n)| (variance(of) / n as f64, (n - 1) as f64));
    let (sum, freedom) = satterthwaite(parts, parts[0].1);
    mean_difference(mean(&of_rows), sum, freedom, level)
}

fn mean_difference(difference: f64, squared_error: f64, freedom: f64, level: f64) -> Option<MeanDifference> {
    let error = squared_error.sqrt();
    let half = student_quantile(0.5 + 0.5 * level, freedom) * error;
    if !(difference.is_finite() && half.is_finite()) {
        return None;
    }
    // Values without scatter: no difference at all is no surprise.
    let p = if difference == 0.0 { 1.0 } else { student_p_value(difference / error, freedom) };
    Some(MeanDifference {
        difference,
        interval: Interval { low: difference - half, high: difference + half },
        degrees_of_freedom: freedom,
        p,
    })
}

/// Holm's step-down adjustment of the p-values of all comparisons of one question: where those below α count as differences, the
/// probability that any of them is none is at most α, however the comparisons depend on each other. In the order of `p`.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::statistics::holm_adjusted;
/// assert_eq!(holm_adjusted(&[0.5, 0.25, 0.125]), [0.5, 0.5, 0.375]);
/// ```
pub fn holm_adjusted(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut adjusted = vec![0.0; p.len()];
    let mut largest = 0.0_f64;
    for (rank, &index) in order.iter().enumerate() {
        largest = largest.max(((p.len() - rank) as f64 * p[index]).min(1.0));
        adjusted[index] = largest;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::seed::Seed;

    #[test]
    fn statistics_a_crossed_interval_covers_whatever_varies() {
        // Standard deviations of rows, columns and the rest; 8 rows, 4 columns. 4000 intervals: a share of 0.95 strays by 0.0035.
        for (case, (by_row, by_column, rest)) in
            [(1.0, 0.0, 0.3), (0.0, 1.0, 0.3), (1.0, 1.0, 0.3), (0.0, 0.0, 1.0)].into_iter().enumerate()
        {
            let mut rng = Seed::new(12).stream("crossed", case as u64);
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let hits = (0..4000)
                .filter(|_| {
                    let columns: Vec<f64> = (0..4).map(|_| by_column * normal()).collect();
                    let cells: Vec<Vec<f64>> = (0..8)
                        .map(|_| {
                            let row = by_row * normal();
                            columns.iter().map(|column| row + column + rest * normal()).collect()
                        })
                        .collect();
                    crossed_difference(&cells, 0.95).unwrap().interval.contains(0.0)
                })
                .count();
            let share = hits as f64 / 4000.0;
            assert!((0.94..=if case == 3 { 1.0 } else { 0.975 }).contains(&share), "case {case}: {share}");
        }
    }

    #[test]
    fn numpy_a_crossed_difference_is_the_two_way_analysis_of_variance() {
        // NumPy 2.4: y = arange(12).reshape(4, 3)**1.5; MS of rows 3·var(y.mean(1), ddof=1), of columns 4·var(y.mean(0), ddof=1).
        let cells: Vec<Vec<f64>> = (0..4).map(|i| (0..3).map(|k| f64::from(3 * i + k).powf(1.5)).collect()).collect();
        let found = crossed_difference(&cells, 0.95).unwrap();
        assert!((found.difference - CROSSED[0]).abs() < 1e-12, "{found:?}");
        assert!((found.degrees_of_freedom - CROSSED[1]).abs() < 1e-10, "{found:?}");
        assert!((found.interval.high - CROSSED[2]).abs() < 1e-8, "{found:?}");
        assert!(crossed_difference(&cells[..1], 0.95).is_none());
    }

    /// Mean, degrees of freedom and upper end of the interval (`scipy.stats.t.ppf`).
    const CROSSED: [f64; 3] = [14.929_598_613_555_475, 3.474_839_721_961_44, 35.272_886_656_670_33];

    const X: [f64; 8] = [0.11, -0.32, 0.45, 0.27, 0.63, 0.08, 0.39, 0.51];
    const Y: [f64; 5] = [0.21, -0.12, 0.05, 0.17, 0.03];

    fn is_near(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
    }

    #[test]
    fn scipy_t_tests() {
        // SciPy 1.17.1: ttest_1samp(X, 0), ttest_ind(X, Y, equal_var=False), and their confidence_interval().
        let paired = paired_difference(&X, 0.95).unwrap();
        is_near(paired.p, 0.042_713_569_789_424_49);
        is_near(paired.interval.low, 0.011_501_062_377_343_663);
        is_near(paired.interval.high, 0.518_498_937_622_656_3);
        let welch = welch_difference(&X, &Y, 0.95).unwrap();
        is_near(welch.p, 0.136_801_907_829_654_73);
        is_near(welch.degrees_of_freedom, 10.183_979_401_479_435);
        is_near(welch.interval.low, -0.074_103_679_140_421_93);
        is_near(welch.interval.high, 0.468_103_679_140_421_95);
        let wide = welch_difference(&X, &Y, 0.99).unwrap().interval;
        is_near(wide.low, -0.187_999_143_192_975_62);
        is_near(wide.high, 0.581_999_143_192_975_6);
    }

    #[test]
    fn scipy_two_sided_tails() {
        // SciPy 1.17.1: 2 stats.t.sf(|t|, ν).
        for (t, freedom, expected) in [
            (0.5, 3.0, 0.651_447_964_848_151),
            (2.5, 7.3, 0.039_650_234_665_600_43),
            (12.0, 2.0, 0.006_872_933_677_158_46),
            (-4.0, 40.0, 0.000_265_912_395_666_698_07),
        ] {
            is_near(student_p_value(t, freedom), expected);
        }
        assert!((student_p_value(30.0, 15.0) / 8.314_807_194_324_938e-15 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn published_holm_adjustment() {
        // R's p.adjust(c(0.01, 0.02, 0.03, 0.04, 0.05), "holm"): 0.05 0.08 0.09 0.09 0.09, here out of order.
        let found = holm_adjusted(&[0.04, 0.01, 0.05, 0.03, 0.02]);
        for (found, expected) in found.iter().zip([0.09, 0.05, 0.09, 0.09, 0.08]) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
        assert_eq!(holm_adjusted(&[0.7, 0.9]), [1.0, 1.0]);
        assert!(holm_adjusted(&[]).is_empty());
    }

    #[test]
    fn identity_a_p_value_is_the_level_at_which_the_interval_ends_at_zero() {
        for found in [paired_difference(&X, 0.95), welch_difference(&X, &Y, 0.95)] {
            let p = found.unwrap().p;
            let ends = if found == paired_difference(&X, 0.95) {
                paired_difference(&X, 1.0 - p)
            } else {
                welch_difference(&X, &Y, 1.0 - p)
            };
            assert!(ends.unwrap().interval.low.abs() < 1e-12, "{ends:?}");
        }
    }

    #[test]
    fn what_has_no_scatter_or_too_few_values_is_said() {
        assert_eq!(paired_difference(&[1.0], 0.95), None);
        assert_eq!(welch_difference(&[1.0, 2.0], &[1.0], 0.95), None);
        assert_eq!(paired_difference(&[0.0, f64::NEG_INFINITY], 0.95), None);
        let equal = paired_difference(&[0.0, 0.0], 0.95).unwrap();
        assert_eq!((equal.p, equal.interval.low, equal.interval.high), (1.0, 0.0, 0.0));
        let apart = welch_difference(&[2.0, 2.0, 2.0], &[1.0, 1.0], 0.95).unwrap();
        assert_eq!((apart.p, apart.degrees_of_freedom, apart.interval.low), (0.0, 3.0, 1.0));
    }

    #[test]
    fn statistics_few_designs_are_covered_as_often_as_stated() {
        // 4000 studies of 4 designs against 8 with twice the scatter, and of 4 pairs that share most of it. A 95 % interval covers in
        // 93.6 to 96.4 % of them but for a chance below 1e-4 each; Welch's is approximate and may be off by half a per cent.
        let studies = 4000_u32;
        let mut covered = [0_u32; 2];
        let mut rng = Seed::new(17).stream("few designs", 0);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        for _ in 0..studies {
            let first: Vec<f64> = (0..4).map(|_| 0.3 + normal()).collect();
            let second: Vec<f64> = (0..8).map(|_| 2.0 * normal()).collect();
            covered[0] += u32::from(welch_difference(&first, &second, 0.95).unwrap().interval.contains(0.3));
            let pairs: Vec<f64> = first.iter().map(|shared| (shared + 0.2 * normal()) - shared - 0.1).collect();
            covered[1] += u32::from(paired_difference(&pairs, 0.95).unwrap().interval.contains(-0.1));
        }
        let share = covered.map(|count| f64::from(count) / f64::from(studies));
        assert!((0.931..=0.969).contains(&share[0]) && (0.936..=0.964).contains(&share[1]), "{share:?}");
    }

    #[test]
    fn statistics_holm_keeps_the_error_of_all_comparisons() {
        // Ten pairs of five families without any difference: one of them is called different in at most 5 % of 2000 studies; 6.7 %
        // would be beyond a chance of 1e-3.
        let mut rng = Seed::new(4).stream("no difference", 0);
        let mut called = 0;
        for _ in 0..2000 {
            let families: Vec<Vec<f64>> =
                (0..5).map(|_| (0..6).map(|_| StandardNormal.sample(&mut rng)).collect()).collect();
            let pairs = (0..5).flat_map(|a| (a + 1..5).map(move |b| (a, b)));
            let p: Vec<f64> =
                pairs.map(|(a, b)| welch_difference(&families[a], &families[b], 0.95).unwrap().p).collect();
            called += usize::from(holm_adjusted(&p).iter().any(|&p| p < 0.05));
        }
        assert!(called <= 134, "{called} of 2000");
    }
}
