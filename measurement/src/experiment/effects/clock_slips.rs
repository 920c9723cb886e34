//! A clock that slips for a while: what is written was measured earlier than its stamp says.
//!
//! ```text
//! outside a slip   (q̂, î)(k/f) = (q̂, î) measured at k/f
//! in a slip        (q̂, î)(k/f) = (q̂, î) measured at k/f − 20 ms        slips of 50 ms, a share p of all samples
//! begin of one     with probability p/(p + L (1 − p)) at each sample outside     L = 50 ms f, at least 1
//! ```
//! Positions and currents slip together, so that inside a slip the equations of motion still hold between them; where it begins and
//! ends the position jumps, and what differentiates it has a wrong velocity and a far larger wrong acceleration. Neither
//! the servo nor the arm knows of it.

use std::collections::VecDeque;

use rand::RngExt;

use crate::seed::{RunNoise, Stream};

/// How much too early a slipped sample was measured, s.
const EARLY_S: f64 = 0.02;
/// How long a slip lasts, s.
const LENGTH_S: f64 = 0.05;

/// One sample as the sensors gave it: positions, efforts, voltages.
type Reading = [Vec<f64>; 4];

/// The slips of one run, and the samples that they bring back.
#[derive(Clone, Debug)]
pub(in crate::experiment) struct ClockSlips {
    begins: f64,
    length: usize,
    early: usize,
    left: usize,
    stream: Stream,
    past: VecDeque<Reading>,
}

impl ClockSlips {
    /// Slips of this share of samples, above 0 and below 1, at a sampling rate of `rate_hz`.
    pub(super) fn new(share: f64, rate_hz: f64, run: RunNoise) -> Self {
        let samples = |time_s: f64| ((time_s * rate_hz).round() as usize).max(1);
        let (length, early) = (samples(LENGTH_S), samples(EARLY_S));
        Self {
            begins: share / (share + length as f64 * (1.0 - share)),
            length,
            early,
            left: 0,
            stream: run.stream("clock slips"),
            past: VecDeque::with_capacity(early + 1),
        }
    }

    /// What is written where the sensors give `now`; slips begin as soon as there is a sample early enough.
    pub(in crate::experiment) fn written(&mut self, now: [&[f64]; 4]) -> [&[f64]; 4] {
        let mut newest =
            if self.past.len() > self.early { self.past.pop_front().unwrap_or_default() } else { Reading::default() };
        for (values, now) in newest.iter_mut().zip(now) {
            values.clear();
            values.extend_from_slice(now);
        }
        self.past.push_back(newest);
        if self.left > 0 {
            self.left -= 1;
        } else if self.past.len() > self.early && self.stream.random::<f64>() < self.begins {
            self.left = self.length - 1;
        } else {
            return self.last();
        }
        self.past.front().map_or([&[]; 4], views)
    }

    fn last(&self) -> [&[f64]; 4] {
        self.past.back().map_or([&[]; 4], views)
    }
}

fn views(reading: &Reading) -> [&[f64]; 4] {
    reading.each_ref().map(Vec::as_slice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    /// How many samples early each of `count` is, from samples that say their own number.
    fn early(share: f64, rate_hz: f64, count: usize) -> Vec<usize> {
        let mut slips = ClockSlips::new(share, rate_hz, Seed::new(9).of_run(2));
        let mut found = Vec::with_capacity(count);
        for k in 0..count {
            let [q, effort, voltage, link] = slips.written([&[k as f64], &[-(k as f64)], &[], &[k as f64]]);
            assert_eq!((effort, voltage, link), (&[-q[0]][..], &[][..], q), "positions and efforts slip together");
            found.push(k - q[0] as usize);
        }
        found
    }

    #[test]
    fn analytic_slips_have_their_share_length_and_size() {
        let found = early(0.05, 1000.0, 400_000);
        assert!(found.iter().all(|&early| early == 0 || early == 20));
        // 400 slips of 50 samples, ± √400 and less; 4 of them.
        let share = found.iter().filter(|&&early| early > 0).count() as f64 / found.len() as f64;
        assert!((share - 0.05).abs() < 0.01, "{share}");
        // One may begin where another ends: every stretch is whole slips.
        let whole = found[..399_000].split(|&early| early == 0).filter(|slip| !slip.is_empty());
        assert!(whole.clone().count() > 300);
        assert!(
            whole
                .clone()
                .all(|slip| slip.len() % 50 == 0 || slip.as_ptr_range().end == found[..399_000].as_ptr_range().end)
        );
    }

    #[test]
    fn slips_of_slow_samples_are_whole_samples() {
        let found = early(0.2, 10.0, 1000);
        assert!(found.contains(&1) && found.iter().all(|&early| early <= 1));
    }
}
