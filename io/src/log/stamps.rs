//! What the stamps of a log say: its rate, its jitter, and where it breaks off.
//!
//! A log whose steps are equal within a hundredth is even, and taken as it is. Any other one is brought onto an even grid,
//! segment by segment: a step of more than five usual ones is a gap, and a step back is a reset of the clock; both end a
//! segment. A row with the stamp of the one before it is left out. Segments shorter than half a second hold no more than
//! the transient of a filter, and are left out. Everything that is left out is counted.

use std::ops::Range;

use armid::remedy::{Remedy, Setting};
use serde::Serialize;

/// Largest relative difference from the mean step in an even log.
const EVEN: f64 = 0.01;
/// Usual steps in a step from which on it is a gap.
const GAP: f64 = 5.0;
/// Shortest segment that is kept, s.
const SHORTEST_S: f64 = 0.5;
/// Part of equal stamps from which on they are too coarse to be taken for times.
const COARSE: f64 = 0.1;

/// What was found in the stamps.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Timing {
    /// Rows in the file.
    pub rows: usize,
    /// Whether the stamps were even, so that no sample was moved.
    pub even: bool,
    /// Samples per second of the even grid, Hz.
    pub rate_hz: f64,
    /// Shortest and longest step that is no gap, s.
    pub steps_s: [f64; 2],
    /// Steps of more than five usual ones.
    pub gaps: usize,
    /// Time inside them, s.
    pub gaps_s: f64,
    /// Steps back.
    pub resets: usize,
    /// Rows left out, since they have the stamp of the row before.
    pub duplicates: usize,
    /// Rows left out, since a value is missing.
    pub incomplete_rows: usize,
    /// Rows left out in segments of less than half a second.
    #[serde(rename = "rows_in_short_stretches")]
    pub rows_in_short_segments: usize,
}

/// Rows that follow each other without a break.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SegmentRows {
    /// Places in the list of rows that are kept.
    pub(super) rows: Range<usize>,
    /// Whether its steps are those of the even grid.
    pub(super) even: bool,
    /// Its first time since the beginning of the log, s.
    pub(super) start_s: f64,
}

/// Stamps, looked at.
#[derive(Clone, Debug)]
pub(super) struct Stamps {
    /// Which rows are kept.
    pub(super) kept: Vec<usize>,
    /// Their segments.
    pub(super) segments: Vec<SegmentRows>,
    pub(super) timing: Timing,
}

impl Stamps {
    /// The stamps of a log that has a rate instead.
    pub(super) fn even(rows: usize, rate_hz: f64) -> Self {
        let timing = Timing { rows, even: true, rate_hz, steps_s: [1.0 / rate_hz; 2], ..Timing::default() };
        let segments = vec![SegmentRows { rows: 0..rows, even: true, start_s: 0.0 }];
        Self { kept: (0..rows).collect(), segments, timing }
    }

    /// Looks at stamps, s.
    ///
    /// # Errors
    /// A sentence and the row that it is about.
    pub(super) fn of(t: &[f64]) -> Result<Self, (usize, String)> {
        let rows = t.len();
        if rows < 2 {
            return Err((0, format!("found {rows} samples, expected at least 2")));
        }
        let mean = (t[rows - 1] - t[0]) / (rows - 1) as f64;
        let steps = || t.windows(2).map(|pair| pair[1] - pair[0]);
        if mean > 0.0 && steps().all(|step| (step - mean).abs() <= EVEN * mean) {
            return Ok(Self::even(rows, whole(1.0 / mean, 1e-6)));
        }
        let mut rising: Vec<f64> = steps().filter(|step| *step > 0.0).collect();
        if rising.is_empty() {
            return Err((1, "the stamps never rise, expected times".to_owned()));
        }
        rising.sort_by(f64::total_cmp);
        let usual = rising[rising.len() / 2];
        let ordinary: Vec<f64> = rising.iter().copied().filter(|step| *step <= GAP * usual).collect();
        let step = ordinary.iter().sum::<f64>() / ordinary.len() as f64;
        let mut timing = Timing {
            rows,
            rate_hz: whole(1.0 / step, 1e-3),
            steps_s: [ordinary[0], ordinary[ordinary.len() - 1]],
            ..Timing::default()
        };
        let (mut kept, mut segments, mut begin, mut shift) = (vec![0], Vec::new(), 0, -t[0]);
        let mut starts_s = 0.0;
        for row in 1..rows {
            let found = t[row] - t[row - 1];
            if found == 0.0 {
                timing.duplicates += 1;
                continue;
            }
            if found < 0.0 || found > GAP * usual {
                segments.push((begin..kept.len(), starts_s));
                begin = kept.len();
                if found < 0.0 {
                    timing.resets += 1;
                    shift += step - found;
                } else {
                    timing.gaps += 1;
                    timing.gaps_s += found - step;
                }
                starts_s = t[row] + shift;
            }
            kept.push(row);
        }
        segments.push((begin..kept.len(), starts_s));
        if timing.duplicates as f64 > COARSE * rows as f64 {
            let (found, rate) = (timing.duplicates, whole((rows - 1) as f64 / (t[rows - 1] - t[0]), 1e-3));
            let message = format!(
                "{found} of {rows} stamps are those of the row before, expected stamps fine enough for times; where the \
                 steps are equal, {} says so",
                Remedy::set(Setting::Rate, rate.to_string())
            );
            return Err((1, message));
        }
        let mut all = Self { kept, segments: Vec::new(), timing };
        all.keep_long(t, segments);
        if all.segments.is_empty() {
            return Err((0, format!("no segment of {SHORTEST_S} s without a break, expected at least one")));
        }
        Ok(all)
    }

    /// Keeps the segments that are long enough.
    fn keep_long(&mut self, t: &[f64], segments: Vec<(Range<usize>, f64)>) {
        let rate = self.timing.rate_hz;
        for (rows, start_s) in segments {
            let stamp = |at: usize| t[self.kept[at]];
            if stamp(rows.end - 1) - stamp(rows.start) < SHORTEST_S {
                self.timing.rows_in_short_segments += rows.len();
                continue;
            }
            let even = (rows.start + 1..rows.end).all(|at| ((stamp(at) - stamp(at - 1)) * rate - 1.0).abs() <= EVEN);
            self.segments.push(SegmentRows { rows, even, start_s });
        }
    }
}

/// A rate that is a whole number of Hz to the precision of its stamps is meant to be that.
fn whole(rate: f64, tolerance: f64) -> f64 {
    let whole = rate.round();
    if whole > 0.0 && (rate / whole - 1.0).abs() < tolerance { whole } else { rate }
}

impl Timing {
    /// Sentences about what was not as it should be; none where all was well.
    pub fn sentences(&self) -> Vec<String> {
        let mut found = Vec::new();
        if !self.even {
            found.push(format!(
                "steps of {:.3} to {:.3} ms: brought onto {} Hz, positions by cubic pieces, efforts by straight lines",
                1e3 * self.steps_s[0],
                1e3 * self.steps_s[1],
                (1e3 * self.rate_hz).round() / 1e3
            ));
        }
        let left_out = [
            (self.duplicates, "with the stamp of the row before"),
            (self.incomplete_rows, "in which a value is missing"),
            (self.rows_in_short_segments, "in segments of less than half a second"),
        ];
        for (count, why) in left_out.into_iter().filter(|(count, _)| *count > 0) {
            found.push(format!("{count} of {} rows left out: {why}", self.rows));
        }
        if self.gaps > 0 {
            found.push(format!("{} gaps, together {:.3} s: filters do not reach across them", self.gaps, self.gaps_s));
        }
        if self.resets > 0 {
            found.push(format!("the clock goes back {} times: each begins a new segment", self.resets));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::Stamps;

    fn stamps(n: usize, step: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut t = 5.0;
        (0..n)
            .map(|k| {
                t += step(k);
                t
            })
            .collect()
    }

    #[test]
    fn even_stamps_stay_and_uneven_ones_are_counted() {
        let even = Stamps::of(&stamps(1000, |_| 0.002)).unwrap();
        assert!(even.timing.even && even.timing.rate_hz == 500.0 && even.timing.sentences().is_empty());
        let two = Stamps::of(&stamps(1001, |k| if k % 2 == 0 { 0.010 } else { 0.012 })).unwrap();
        // The whole number of hertz within a thousandth of 1/11 ms.
        assert!(!two.timing.even && two.timing.rate_hz == 91.0, "{:?}", two.timing);
        assert_eq!((two.segments.len(), two.kept.len()), (1, 1001));
        assert!(two.timing.sentences()[0].starts_with("steps of 10.000 to 12.000 ms"), "{:?}", two.timing.sentences());
    }

    #[test]
    fn gaps_resets_and_duplicates_are_found_where_they_are() {
        let mut t = stamps(3000, |k| if k == 1000 { 0.5 } else { 0.001 });
        t[1500] = t[1499];
        for stamp in &mut t[2000..] {
            *stamp -= 2.0;
        }
        let found = Stamps::of(&t).unwrap();
        assert_eq!((found.timing.gaps, found.timing.resets, found.timing.duplicates), (1, 1, 1));
        assert!((found.timing.gaps_s - 0.499).abs() < 1e-5 && found.timing.rate_hz == 1000.0);
        let rows: Vec<_> = found.segments.iter().map(|segment| segment.rows.clone()).collect();
        assert_eq!(rows, [0..1000, 1000..1999, 1999..2999]);
        // Time goes on behind a reset.
        assert!((found.segments[2].start_s - 2.499).abs() < 2e-3, "{:?}", found.segments);
        assert_eq!(found.timing.sentences().len(), 4);
    }

    #[test]
    fn short_segments_are_left_out_and_coarse_stamps_refused() {
        let found = Stamps::of(&stamps(2000, |k| if k == 100 { 1.0 } else { 0.001 })).unwrap();
        assert_eq!((found.timing.rows_in_short_segments, found.segments.len()), (100, 1));
        let coarse: Vec<f64> = (0..100).map(|k| f64::from(k / 5) * 0.001).collect();
        let (_, fault) = Stamps::of(&coarse).unwrap_err();
        assert!(fault.contains("rate 5"), "{fault}");
        assert!(Stamps::of(&[1.0]).is_err() && Stamps::of(&[1.0, 1.0]).is_err());
    }
}
