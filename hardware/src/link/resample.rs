//! Stamped samples onto the grid of the plan.
//!
//! The rule: tick k of the plan is at `t_k = start + k / rate_hz` by the robot's clock. Its sample lies on the straight
//! line between the two messages around it,
//!
//! ```text
//! x(t_k) = x_a + (x_b − x_a) (t_k − t_a) / (t_b − t_a)        t_a < t_k ≤ t_b
//! ```
//! where these are no further apart than two periods of the plan and a tenth of one for jitter; further apart, the
//! sample counts as *missing*: it still lies on that line, so that every tick has a value, and its number is kept so
//! that averaging can leave its period out. The error of the line is `(t_b − t_a)² max|ẍ| / 8`: 2.5 µrad at 2 ms and
//! 5 rad/s², below half a count of the A460's encoders. A message on a tick is taken as it is.

use super::JointRow;

/// The sample of one tick.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSample {
    /// Number of the tick.
    pub index: usize,
    /// Positions, rad (m); n.
    pub q: Vec<f64>,
    /// Efforts or currents; n.
    pub effort: Vec<f64>,
    /// Whether its neighbours are close enough; otherwise it counts as missing.
    pub measured: bool,
}

/// Puts one experiment's messages onto its grid.
#[derive(Clone, Debug)]
pub struct Resampler {
    start_ns: i64,
    rate_hz: f64,
    next: usize,
    samples: usize,
    reach_ns: i64,
    last: Option<JointRow>,
}

impl Resampler {
    /// A grid of `samples` ticks at `rate_hz` (Hz) that begins at `start_ns` of the robot's clock.
    #[must_use]
    pub fn new(start_ns: i64, rate_hz: f64, samples: usize) -> Self {
        let reach_ns = (2.1e9 / rate_hz).round() as i64;
        Self { start_ns, rate_hz, next: 0, samples, reach_ns, last: None }
    }

    /// When a tick is, ns of the robot's clock.
    fn tick_ns(&self, index: usize) -> i64 {
        self.start_ns + (index as f64 * 1e9 / self.rate_hz).round() as i64
    }

    /// Whether every tick has its sample.
    pub fn is_done(&self) -> bool {
        self.next >= self.samples
    }

    /// Takes the next message, newer than the one before, and appends the samples that are now settled to `out`.
    pub fn push(&mut self, row: JointRow, out: &mut Vec<GridSample>) {
        let last = self.last.take().unwrap_or_else(|| row.clone());
        let span = row.stamp_ns - last.stamp_ns;
        while !self.is_done() && self.tick_ns(self.next) <= row.stamp_ns {
            let tick = self.tick_ns(self.next);
            // Where the stream began too late, the first message stands for the ticks before it, and they are missing.
            let share = if span > 0 { (tick - last.stamp_ns) as f64 / span as f64 } else { 1.0 };
            let mix = |a: &[f64], b: &[f64]| -> Vec<f64> {
                let line = |(a, b): (&f64, &f64)| if share == 1.0 { *b } else { a + share * (b - a) };
                a.iter().zip(b).map(line).collect()
            };
            let measured = span <= self.reach_ns && (span > 0 || tick == row.stamp_ns);
            let (q, effort) = (mix(&last.q, &row.q), mix(&last.effort, &row.effort));
            out.push(GridSample { index: self.next, q, effort, measured: measured || tick == row.stamp_ns });
            self.next += 1;
        }
        self.last = Some(row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const START: i64 = 1_700_000_000_000_000_000;

    /// Position 0.5 sin(3 t), effort 2 − t: curved and straight.
    fn row(t: f64) -> JointRow {
        let stamp_ns = START + (t * 1e9).round() as i64;
        let t = (stamp_ns - START) as f64 * 1e-9;
        JointRow { stamp_ns, q: vec![0.5 * (3.0 * t).sin()], qd: Vec::new(), effort: vec![2.0 - t] }
    }

    fn resampled(times: &[f64], samples: usize) -> Vec<GridSample> {
        let mut grid = Resampler::new(START, 500.0, samples);
        let mut out = Vec::new();
        for &t in times {
            grid.push(row(t), &mut out);
        }
        assert!(grid.is_done());
        out
    }

    #[test]
    fn identity_stamps_on_the_grid_are_taken_as_they_are() {
        let times: Vec<f64> = (-3..=100).map(|k| f64::from(k) * 2e-3).collect();
        for sample in resampled(&times, 100) {
            let exact = row(sample.index as f64 * 2e-3);
            assert_eq!((sample.q, sample.effort, sample.measured), (exact.q, exact.effort, true));
        }
    }

    proptest! {
        #[test]
        fn analytic_jittered_stamps_stay_within_the_error_of_the_line(jitter in proptest::collection::vec(-0.45..0.45_f64, 210)) {
            let times: Vec<f64> = jitter.iter().enumerate().map(|(k, j)| (k as f64 - 5.0 + j) * 2e-3).collect();
            for sample in resampled(&times, 200) {
                let t = sample.index as f64 * 2e-3;
                prop_assert!(sample.measured);
                // Neighbours are 1.9 periods apart at most and ẍ ≤ 4.5 rad/s²; stamps are whole nanoseconds.
                let bound = (1.9 * 2e-3_f64).powi(2) * 4.5 / 8.0 + 3e-9;
                prop_assert!((sample.q[0] - 0.5 * (3.0 * t).sin()).abs() < bound);
                // A straight line is met exactly, but for the rounding of stamps and sums.
                prop_assert!((sample.effort[0] - (2.0 - t)).abs() < 3e-9);
            }
        }

        #[test]
        fn analytic_samples_are_missing_exactly_where_neighbours_are_too_far_apart(kept in proptest::collection::vec(proptest::bool::weighted(0.7), 199)) {
            let mut there = vec![true];
            there.extend(kept);
            there.push(true);
            let times: Vec<f64> = (0..there.len()).filter(|&k| there[k]).map(|k| k as f64 * 2e-3).collect();
            for sample in resampled(&times, there.len()) {
                let k = sample.index;
                let before = (0..k).rev().find(|&i| there[i]).unwrap_or(0);
                let after = (k..there.len()).find(|&i| there[i]).unwrap();
                prop_assert_eq!(sample.measured, there[k] || after - before <= 2, "{}", k);
                prop_assert!((sample.effort[0] - (2.0 - k as f64 * 2e-3)).abs() < 3e-9);
            }
        }
    }

    #[test]
    fn ticks_before_the_first_message_are_missing() {
        let out = resampled(&[0.005, 0.007, 0.009], 5);
        assert_eq!(out.iter().map(|sample| sample.measured).collect::<Vec<_>>(), [false, false, false, true, true]);
        assert_eq!(out[0].q, row(0.005).q);
    }
}
