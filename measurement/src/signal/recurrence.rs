//! The period of a motion, and the part of a record in which it repeats.
//!
//! ```text
//! d_k(L) = max_i |q_i(k+L) − q_i(k)| / s_i        s_i the spread of joint i        L is a period over every run with d_k(L) < 1 %
//! ```
//! A record of a periodic motion begins and ends with standstill and ramps, in which nothing repeats. The shortest L with the longest
//! such run is the period. Where the first period differs from its successor twice as much as the later ones do, the servo had not
//! settled, and the part begins one period later.

use std::ops::Range;

/// Difference after one period, as a part of the joint's spread, below which a motion repeats.
const ALIKE: f64 = 0.01;
/// Least spread that a joint's differences are compared with, as a part of the largest: below it they are noise.
const LEAST_SPREAD: f64 = 0.1;
/// A motion without a larger spread, rad or m, is none.
const REST: f64 = 2e-3;
/// Samples that the search of all lags looks at, at most, and the shortest lag among them.
const COARSE: usize = 1500;
const SHORTEST: usize = 16;
/// Periods that a motion must show.
const LEAST_PERIODS: usize = 3;
/// Spread within one period, as a part of that of the whole record, that tells a motion from standstill.
const MOVES: f64 = 0.3;
/// Part of the record's way that the periods must hold.
const LEAST_WAY: f64 = 0.5;
/// Difference of the first period from the second, over that of later ones, from which on it is left out; below a part of the spread it is
/// rounding.
const UNSETTLED: f64 = 2.0;
const ROUNDING: f64 = 1e-6;
/// Differences of the usual one from which on a sample at the ends of a run is of a ramp.
const UNUSUAL: f64 = 6.0;
/// Part of a period at its ends that is not compared: a ramp may reach into it.
const MARGIN: f64 = 0.02;

/// Where a motion repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recurrence {
    /// Samples of one period; no whole number where the period is none.
    pub period_samples: f64,
    /// First sample of the first period.
    pub first: usize,
    /// Whole periods.
    pub periods: usize,
}

/// Looks for the part of a record in which the positions `q` (N × `dof`, row-major, even in time) repeat, and for their period where
/// `period_samples` does not state it. `None` where there are fewer than three periods, or they are less than half of the motion.
pub fn recurrence(q: &[f64], dof: usize, period_samples: Option<f64>) -> Option<Recurrence> {
    let record = Record::new(q, dof)?;
    let found = period_samples.map_or_else(|| record.search(), |period| record.at(period.round() as usize))?;
    record.settled(Recurrence { period_samples: period_samples.unwrap_or(found.period_samples), ..found })
}

/// Positions over the spread of their joints.
struct Record {
    x: Vec<f64>,
    dof: usize,
    /// Samples from one that the search of all lags looks at to the next.
    step: usize,
}

impl Record {
    fn new(q: &[f64], dof: usize) -> Option<Self> {
        let len = q.len().checked_div(dof)?;
        let spreads: Vec<f64> = (0..dof).map(|i| spread(q.iter().skip(i).step_by(dof))).collect();
        let largest = spreads.iter().copied().fold(0.0, f64::max);
        if largest < REST || !largest.is_finite() {
            return None;
        }
        let x = q.chunks_exact(dof).flat_map(|row| {
            row.iter().zip(&spreads).map(|(q, spread)| q / spread.max(LEAST_SPREAD * largest)).collect::<Vec<_>>()
        });
        Some(Self { x: x.collect(), dof, step: len.div_ceil(COARSE).max(1) })
    }

    fn len(&self) -> usize {
        self.x.len() / self.dof
    }

    fn row(&self, k: usize) -> &[f64] {
        &self.x[k * self.dof..(k + 1) * self.dof]
    }

    /// Largest difference of two samples over the joints.
    fn difference(&self, a: usize, b: usize) -> f64 {
        self.row(a).iter().zip(self.row(b)).fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
    }

    /// Mean square difference of the samples from those a lag later.
    fn mismatch(&self, samples: Range<usize>, lag: usize, step: usize) -> f64 {
        let end = samples.end.min(self.len().saturating_sub(lag));
        let all = (samples.start..end).step_by(step).map(|k| self.difference(k, k + lag).powi(2));
        let (sum, count) = all.fold((0.0, 0_usize), |(sum, count), square| (sum + square, count + 1));
        if count == 0 { f64::INFINITY } else { sum / count as f64 }
    }

    /// The longest run of samples, `step` apart, that move and repeat after a lag, which may be off by `slack` steps: two further
    /// periods at least.
    fn run(&self, lag: usize, step: usize, slack: f64) -> Option<Range<usize>> {
        let (mut runs, mut begin) = (Vec::new(), None);
        let last = self.len().saturating_sub(lag);
        for k in (0..last).step_by(step) {
            let moved = if slack > 0.0 && k + step < self.len() { slack * self.difference(k, k + step) } else { 0.0 };
            if self.difference(k, k + lag) < ALIKE + moved {
                begin.get_or_insert(k);
            } else {
                runs.extend(begin.take().map(|first| first..k));
            }
        }
        runs.extend(begin.map(|first| first..last));
        runs.retain(|run| run.len() + step >= (LEAST_PERIODS - 1) * lag && self.moves(run.start..run.start + lag));
        runs.into_iter().max_by_key(Range::len)
    }

    /// Whether some joint moves in these samples, one of those that move the most.
    fn moves(&self, samples: Range<usize>) -> bool {
        let part = &self.x[samples.start * self.dof..samples.end.min(self.len()) * self.dof];
        (0..self.dof).any(|i| spread(part.iter().skip(i).step_by(self.dof)) > MOVES)
    }

    /// The shortest lag whose periods hold nearly as much as those of any other.
    fn search(&self) -> Option<Recurrence> {
        let step = self.step;
        let lags = SHORTEST..=self.len() / step / LEAST_PERIODS;
        let runs = lags.filter_map(|lag| self.run(lag * step, step, 1.0).map(|run| (lag * step, run)));
        let runs: Vec<(usize, Range<usize>)> = runs.collect();
        let held = |(lag, run): &(usize, Range<usize>)| (run.len() + lag) / lag * lag;
        let most = runs.iter().map(held).max()?;
        let (shortest, _) = runs.iter().find(|run| held(run) * 5 >= most * 4)?;
        // Neighbours of a period pass as well: the least difference of all is at the period itself.
        let near: Vec<&(usize, Range<usize>)> =
            runs.iter().filter(|(lag, _)| (*shortest..shortest * 11 / 10 + 1).contains(lag)).collect();
        let of = |(lag, run): &&(usize, Range<usize>)| self.mismatch(run.clone(), *lag, step);
        let (coarse, run) = near.into_iter().min_by(|a, b| of(a).total_cmp(&of(b)))?;
        let fine = coarse.saturating_sub(step).max(1)..=coarse + step;
        let of = |lag: &usize| self.mismatch(run.clone(), *lag, step);
        self.at(fine.min_by(|a, b| of(a).total_cmp(&of(b)))?)
    }

    /// A run without the ends in which samples differ much more than usual, as a ramp or a servo that settles makes them, where enough is left.
    fn trimmed(&self, run: Range<usize>, lag: usize) -> Range<usize> {
        let mut differences: Vec<f64> = run.clone().map(|k| self.difference(k, k + lag)).collect();
        differences.sort_by(f64::total_cmp);
        let limit = ROUNDING + UNUSUAL * differences.get(differences.len() / 2).copied().unwrap_or(0.0);
        let is_usual = |k: &usize| self.difference(*k, *k + lag) <= limit;
        let (first, last) = (run.clone().find(is_usual), run.clone().rev().find(is_usual));
        let trimmed = first.zip(last).map(|(first, last)| first..last + 1);
        trimmed.filter(|trimmed| trimmed.len() >= (LEAST_PERIODS - 1) * lag).unwrap_or(run)
    }

    /// The periods of a lag, which is refined over all of them.
    fn at(&self, lag: usize) -> Option<Recurrence> {
        if lag == 0 || lag * LEAST_PERIODS > self.len() + lag / 2 {
            return None;
        }
        let run = self.trimmed(self.run(lag, 1, 0.0)?, lag);
        let periods = (run.len() + lag) / lag;
        let spans = periods - 1;
        let longest = (spans * lag).saturating_sub(spans)..=spans * lag + spans;
        let of = |lag: &usize| self.mismatch(run.start..run.start + *lag / spans, *lag, 1);
        let longest = longest.min_by(|a, b| of(a).total_cmp(&of(b)))?;
        // What is left over is of the beginning, where a motion may not have settled, but for a margin ahead of the ramp.
        let left_over = (run.len() + lag).saturating_sub(periods * lag);
        let first = run.start + left_over - left_over.min((MARGIN * lag as f64) as usize) / 2;
        let found = Recurrence { period_samples: longest as f64 / spans as f64, first, periods };
        let way = |from: usize, to: usize| -> f64 {
            (from..to.min(self.len()).saturating_sub(self.step))
                .step_by(self.step)
                .map(|k| self.difference(k, k + self.step))
                .sum()
        };
        let end = first + (periods as f64 * found.period_samples) as usize;
        (periods >= LEAST_PERIODS && way(first, end) >= LEAST_WAY * way(0, self.len())).then_some(found)
    }

    /// Without a first period in which the servo had not settled.
    fn settled(&self, found: Recurrence) -> Option<Recurrence> {
        let lag = found.period_samples.round() as usize;
        let begins = |period: usize| found.first + (period as f64 * found.period_samples).round() as usize;
        let margin = (MARGIN * found.period_samples) as usize;
        let difference = |period: usize| {
            self.mismatch(begins(period) + margin..begins(period + 1).saturating_sub(margin), lag, 1).sqrt()
        };
        let mut later: Vec<f64> = (1..found.periods - 1).map(difference).collect();
        later.sort_by(f64::total_cmp);
        let usual = *later.get(later.len() / 2)?;
        if found.periods > LEAST_PERIODS && difference(0) > ROUNDING + UNSETTLED * usual {
            return Some(Recurrence { first: begins(1), periods: found.periods - 1, ..found });
        }
        Some(found)
    }
}

/// Standard deviation.
fn spread<'a>(x: impl Iterator<Item = &'a f64>) -> f64 {
    let (mut count, mut mean, mut squares) = (0.0, 0.0, 0.0);
    for value in x {
        count += 1.0;
        let off = value - mean;
        mean += off / count;
        squares += off * (value - mean);
    }
    (squares / f64::max(count, 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::{Record, Recurrence, recurrence};
    use crate::seed::Seed;

    const RATE_HZ: f64 = 100.0;
    /// No transient.
    const STEADY: (f64, f64) = (0.0, 0.0);

    /// Three joints: rest, a ramp, periods of `period_s` from 3 s on, a ramp, rest; with noise and a transient that decays at a rate (1/s).
    fn record(period_s: f64, periods: f64, noise: f64, (transient, rate): (f64, f64)) -> Vec<f64> {
        let mut rng = Seed::new(4).stream("record", 0);
        let end = 3.0 + periods * period_s;
        let mut q = Vec::new();
        for k in 0..((end + 4.0) * RATE_HZ) as usize {
            let t = k as f64 / RATE_HZ;
            let ramp = ((t - 1.0) / 2.0).clamp(0.0, 1.0) * ((end + 2.0 - t) / 2.0).clamp(0.0, 1.0);
            for i in 0..3 {
                let w = std::f64::consts::TAU / period_s;
                let wave: f64 = (1..=4)
                    .map(|l| libm::sin(f64::from(l) * w * (t - 3.0) + f64::from(l * l) + i as f64) / f64::from(l))
                    .sum();
                let z: f64 = StandardNormal.sample(&mut rng);
                let late = if t > 3.0 { transient * libm::exp(-rate * (t - 3.0)) } else { 0.0 };
                q.push(ramp * 0.5 * wave + late + noise * z);
            }
        }
        q
    }

    #[test]
    fn ends_that_differ_more_than_usual_are_trimmed() {
        let lag = 50;
        // A motion that repeats to a thousandth, but for the first 20 samples and, a lag later, the last 10.
        let x = |k: usize| {
            let wave = libm::sin(std::f64::consts::TAU * k as f64 / lag as f64);
            let off = if (20..240).contains(&k) { 0.0 } else { 0.1 };
            wave + off + 1e-3 * libm::sin(1.7 * k as f64)
        };
        let record = Record { x: (0..250).map(x).collect(), dof: 1, step: 1 };
        assert_eq!(record.trimmed(0..200, lag), 20..190);
        // What would be left is less than two further periods: the run stays whole.
        assert_eq!(record.trimmed(0..110, lag), 0..110);
    }

    #[test]
    fn the_period_and_the_part_that_repeats_are_found() {
        for (period_s, periods, noise) in [(10.0, 5.0, 0.0), (4.0, 7.0, 3e-4), (2.57, 12.4, 1e-4), (6.0, 3.0, 0.0)] {
            let found = recurrence(&record(period_s, periods, noise, STEADY), 3, None);
            let Recurrence { period_samples, first, periods: count } = found.expect("a period");
            assert!((period_samples - period_s * RATE_HZ).abs() < 0.3, "{period_s} s: {found:?}");
            assert_eq!(count, periods as usize, "{period_s} s: {found:?}");
            // The last whole periods: of 12.4 of them the first 0.4 are left over.
            let left_over = (periods.fract() * period_s * RATE_HZ) as usize;
            assert!(first.abs_diff(300 + left_over) < 10, "{period_s} s: {found:?}");
        }
    }

    #[test]
    fn a_first_period_that_has_not_settled_is_left_out() {
        let found = recurrence(&record(10.0, 6.0, 1e-5, (2e-3, 2.0)), 3, None).expect("a period");
        assert!(found.periods == 5 && found.first.abs_diff(1300) < 30, "{found:?}");
        let stated = recurrence(&record(10.0, 6.0, 1e-5, (2e-3, 2.0)), 3, Some(1000.0)).expect("the part");
        assert_eq!((stated.first, stated.periods, stated.period_samples), (found.first, 5, 1000.0));
        assert_eq!(recurrence(&record(10.0, 6.0, 1e-5, (2e-3, 2.0)), 3, Some(0.2)), None);
    }

    #[test]
    fn analytic_the_first_of_five_periods_is_left_out_above_twice_the_median_of_the_later_ones() {
        // A transient whose part a period is r times that of the one before: the first difference is 1/r² times the median of three.
        for (r, left) in [(0.6_f64, 4), (0.8, 5)] {
            let rate = -r.ln() / 10.0;
            let found = recurrence(&record(10.0, 5.0, 0.0, (4e-3, rate)), 3, Some(1000.0)).expect("the part");
            assert_eq!(found.periods, left, "{r}: {found:?}");
        }
    }

    #[test]
    fn a_motion_that_does_not_repeat_has_no_period() {
        let tone = |hertz: f64, t: f64| libm::sin(std::f64::consts::TAU * hertz * t);
        let of =
            |at: &dyn Fn(f64) -> [f64; 2]| -> Vec<f64> { (0..4000).flat_map(|k| at(f64::from(k) / RATE_HZ)).collect() };
        let chirp = of(&|t| [tone(0.1 + 0.01 * t, t), 0.3 * tone(0.21, t)]);
        let incommensurate = of(&|t| [tone(0.1, t) + tone(0.1 * 2.0_f64.sqrt(), t), tone(0.173, t)]);
        let drifting = of(&|t| [tone(0.2, t) + 0.02 * t, tone(0.4, t)]);
        let twice = record(10.0, 2.0, 0.0, STEADY);
        for (name, q, dof) in
            [("chirp", chirp, 2), ("two tones", incommensurate, 2), ("drift", drifting, 2), ("two periods", twice, 3)]
        {
            assert_eq!(recurrence(&q, dof, None), None, "{name}");
        }
        assert_eq!(recurrence(&vec![0.5; 3000], 3, None), None);
        assert_eq!(recurrence(&[], 3, None), None);
    }
}
