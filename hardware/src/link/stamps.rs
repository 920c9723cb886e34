//! What the stamps of joint states show about their transport.
//!
//! ```text
//! Δ = stamp − last stamp        δ = arrival − last arrival, by the local monotonic clock
//! duplicate    Δ = 0
//! reordered    −½ s ≤ Δ < 0                       dropped: a newer one was already used
//! gap          Δ > 1.5 periods                    round(Δ/period) − 1 messages are missing
//! clock jump   Δ < −½ s, or Δ > δ + ½ s           a clock cannot be faster than time
//! drift        the clocks are apart by more than 20 ms within a second ([`ClockWatch`])
//! ```

use serde::{Deserialize, Serialize};

use super::clock::ClockWatch;

/// Largest difference between the robot's time and ours that lateness explains, s.
const LATENESS_S: f64 = 0.5;

/// What was wrong with the stamps of one experiment, as numbers for the reader.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StampFindings {
    /// Messages received.
    pub messages: usize,
    /// Gaps: more than 1.5 periods between two stamps.
    pub gaps: usize,
    /// Messages that the gaps have swallowed.
    pub lost: usize,
    /// Longest time between two stamps, s.
    pub longest_gap_s: f64,
    /// Messages with the stamp of the one before.
    pub duplicates: usize,
    /// Messages that came after a newer one.
    pub reordered: usize,
    /// Times that the robot's clock jumped.
    pub clock_jumps: usize,
    /// Size of the largest of these jumps, s.
    pub largest_jump_s: f64,
    /// Longest silence by the local clock, s.
    pub longest_silence_s: f64,
    /// Largest transport time above the shortest, s.
    pub latest_s: f64,
    /// Samples of the experiment that no pair of neighbouring messages covers; they lie on the line across the gap.
    pub missing: Vec<usize>,
}

impl StampFindings {
    /// Whether there is nothing to report.
    pub fn is_clean(&self) -> bool {
        self.gaps + self.duplicates + self.reordered + self.clock_jumps == 0 && self.missing.is_empty()
    }
}

/// What to do with a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stamp {
    /// It is newer than all before.
    Fresh,
    /// It says nothing new: a duplicate, or one that was overtaken.
    Stale,
    /// The clock jumped by so many seconds: nothing after it can be placed on the time axis of what was before.
    Jumped(f64),
    /// The clock gained so many seconds on ours within a second, or lost them (negative): it is no measure of time.
    Drifted(f64),
}

/// Watches the stamps of one stream.
#[derive(Clone, Debug)]
pub struct StampWatch {
    period_s: f64,
    last: Option<(i64, f64)>,
    clock: ClockWatch,
    findings: StampFindings,
}

impl StampWatch {
    /// Watches a stream that should have a message every `period_s` seconds.
    pub fn new(period_s: f64) -> Self {
        Self { period_s, last: None, clock: ClockWatch::default(), findings: StampFindings::default() }
    }

    /// Returns this watch, which knows the clocks from before.
    pub(crate) fn with_clock(mut self, clock: ClockWatch) -> Self {
        self.clock = clock;
        self
    }

    /// What is known of the clocks.
    pub(crate) fn clock(&self) -> &ClockWatch {
        &self.clock
    }

    /// Transport time of the last message above the shortest, s.
    pub fn lateness_s(&self) -> f64 {
        self.clock.lateness_s()
    }

    /// Judges a message with the stamp `stamp_ns` that arrived at `arrival_s` of a local monotonic clock.
    pub fn see(&mut self, stamp_ns: i64, arrival_s: f64) -> Stamp {
        let stamp = self.judge(stamp_ns, arrival_s);
        if let Stamp::Jumped(_) = stamp {
            // A transport time across a jump means nothing.
            self.clock = ClockWatch::default();
        }
        let drift = self.clock.see(stamp_ns, arrival_s);
        self.findings.latest_s = self.findings.latest_s.max(self.clock.lateness_s());
        drift.map_or(stamp, Stamp::Drifted)
    }

    fn judge(&mut self, stamp_ns: i64, arrival_s: f64) -> Stamp {
        let found = &mut self.findings;
        found.messages += 1;
        let Some((last_ns, last_arrival)) = self.last else {
            self.last = Some((stamp_ns, arrival_s));
            return Stamp::Fresh;
        };
        let (step, silence) = ((stamp_ns - last_ns) as f64 * 1e-9, arrival_s - last_arrival);
        found.longest_silence_s = found.longest_silence_s.max(silence);
        let stamp = if stamp_ns == last_ns {
            found.duplicates += 1;
            Stamp::Stale
        } else if step < -LATENESS_S || step > silence + LATENESS_S {
            found.clock_jumps += 1;
            if step.abs() > found.largest_jump_s.abs() {
                found.largest_jump_s = step;
            }
            Stamp::Jumped(step)
        } else if step < 0.0 {
            found.reordered += 1;
            Stamp::Stale
        } else {
            if step > 1.5 * self.period_s {
                found.gaps += 1;
                found.lost += ((step / self.period_s).round() as usize).saturating_sub(1);
            }
            found.longest_gap_s = found.longest_gap_s.max(step);
            Stamp::Fresh
        };
        if stamp == Stamp::Stale {
            // The stream is alive, though: silence counts from here.
            self.last = Some((last_ns, arrival_s));
        } else {
            self.last = Some((stamp_ns, arrival_s));
        }
        stamp
    }

    /// Notes that sample `k` lies on a line across a gap.
    pub fn miss(&mut self, k: usize) {
        self.findings.missing.push(k);
    }

    /// What was found so far.
    pub fn findings(&self) -> &StampFindings {
        &self.findings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn watch(stamps_ms: &[(i64, f64)]) -> (Vec<Stamp>, StampFindings) {
        let mut watch = StampWatch::new(0.002);
        let judged = stamps_ms.iter().map(|&(stamp, arrival)| watch.see(stamp * MS, arrival * 1e-3)).collect();
        (judged, watch.findings().clone())
    }

    #[test]
    fn a_steady_stream_is_clean_however_late_it_comes() {
        // 500 Hz, arrivals in bursts of 25 after 50 ms of silence each.
        let stream: Vec<(i64, f64)> = (0..500).map(|k| (2 * k, 50.0 * ((k / 25) as f64 + 1.0))).collect();
        let (judged, found) = watch(&stream);
        assert!(judged.iter().all(|&stamp| stamp == Stamp::Fresh) && found.is_clean(), "{found:?}");
        assert_eq!((found.messages, found.lost), (500, 0));
        assert!((found.longest_silence_s - 0.05).abs() < 1e-12);
    }

    #[test]
    fn gaps_duplicates_and_reordering_are_counted() {
        let (judged, found) = watch(&[(0, 0.0), (2, 2.0), (2, 3.0), (8, 8.0), (6, 9.0), (4, 9.0), (10, 10.0)]);
        assert_eq!(judged.iter().filter(|&&stamp| stamp == Stamp::Stale).count(), 3);
        assert_eq!((found.gaps, found.lost, found.duplicates, found.reordered), (1, 2, 1, 2));
        assert!((found.longest_gap_s - 0.006).abs() < 1e-12 && found.clock_jumps == 0);
    }

    #[test]
    fn analytic_lateness_is_the_way_beyond_the_shortest_and_drift_is_none() {
        // Every 2 ms, always 5 ms on the way, but message 40 needs 60 ms more and is overtaken.
        let mut watch = StampWatch::new(0.002);
        let mut late: f64 = 0.0;
        for k in 0..100_i64 {
            if k != 40 {
                watch.see(2 * k * MS, 0.005 + 0.002 * k as f64);
                late = late.max(watch.lateness_s());
            }
            if k == 70 {
                assert_eq!(watch.see(80 * MS, 0.005 + 0.080 + 0.060 + 0.001), Stamp::Stale);
                // The shortest way may have grown by 1 % of the last millisecond.
                assert!((watch.lateness_s() - 0.061).abs() < 1e-4, "{}", watch.lateness_s());
            }
        }
        assert!(late < 1e-9 && (watch.findings().latest_s - 0.061).abs() < 1e-4, "{late} {:?}", watch.findings());
        // A clock that is slow by 0.5 %: after 10 s it is 50 ms behind, and nothing is late.
        let mut watch = StampWatch::new(0.002);
        for k in 0..5000_i64 {
            watch.see(2 * k * MS, 0.002 * 1.005 * k as f64);
        }
        assert!(watch.findings().latest_s < 1e-9, "{:?}", watch.findings());
    }

    #[test]
    fn a_clock_that_jumps_is_told_from_a_message_that_is_late() {
        // A message 300 ms late and a silence of 2 s are no jump; a clock 2 s ahead or back is one.
        assert_eq!(watch(&[(0, 0.0), (400, 400.0), (100, 401.0)]).1.clock_jumps, 0);
        assert_eq!(watch(&[(0, 0.0), (2000, 2000.0)]).1.clock_jumps, 0);
        let (judged, found) = watch(&[(5000, 0.0), (5002, 2.0), (7004, 4.0), (5006, 6.0)]);
        let [.., Stamp::Jumped(ahead), Stamp::Jumped(back)] = judged[..] else { panic!("{judged:?}") };
        assert!((ahead - 2.002).abs() < 1e-12 && (back + 1.998).abs() < 1e-12);
        assert_eq!(found.clock_jumps, 2);
        assert!((found.largest_jump_s - 2.002).abs() < 1e-12);
    }
}
