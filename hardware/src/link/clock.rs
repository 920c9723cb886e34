//! The robot's clock against ours.
//!
//! ```text
//! w       arrival − stamp                   transport time, and how far the clocks are apart
//! w₀(t)   least w so far, grown by 1 % of the time that has passed since
//! late    w − w₀
//! gained  w₀(t − 1 s) − w > 20 ms           no transport makes a state younger than it is
//! lost    min w over [t − ½ s, t] − min w over [t − 1½ s, t − 1 s] > 20 ms
//! ```
//! A robot controller that stands still sends nothing, and its clock may stand too: what is missing from the stamps across
//! a silence is not counted as lost, unless states come in a burst after it. The guard judges silences by themselves
//! (`stale-state`).

use std::collections::VecDeque;

/// What the robot's clock may gain or lose on ours over a second, s.
const APART_S: f64 = 0.02;
/// The time over which it is judged, s.
const OVER_S: f64 = 1.0;
/// Growth of the least transport time with time, s/s.
const DRIFT: f64 = 0.01;
/// Time from which the first least transport time is taken: the first states may all have been late, s.
const FIRST_S: f64 = 0.25;
/// Time between two marks of the least transport time, and length of an interval with a minimum, s.
const MARK_S: f64 = 0.05;
/// Length of the two intervals that show a loss, s.
const INTERVAL_S: f64 = 0.5;
/// Time after which clocks that are apart are found so, s.
pub(crate) const FOUND_S: f64 = OVER_S + INTERVAL_S + 2.0 * MARK_S;
/// A silence: an arrival so many times later than the stamps explain, and so many seconds.
const SILENCE: (f64, f64) = (2.0, 0.001);
/// A burst: an arrival sooner than this part of what the stamps say.
const BURST: f64 = 0.5;

/// Compares stamps with arrivals.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClockWatch {
    /// Stamp and arrival of the first state and of the newest one.
    span: Option<[(i64, f64); 2]>,
    /// When the clocks began to agree.
    agree_from_s: f64,
    /// Least transport time, and when that was.
    least: Option<(f64, f64)>,
    lateness_s: f64,
    /// What the least transport time was, over the last second.
    marks: VecDeque<(f64, f64)>,
    /// Time missing from the stamps across silences, s.
    stood_s: f64,
    /// Part of the last silence that a burst may still show to have been none, s.
    open_s: f64,
    /// Minima of the transport time without that, from when on.
    minima: VecDeque<(f64, f64)>,
}

impl ClockWatch {
    /// Transport time of the last state above the least, s.
    pub(crate) const fn lateness_s(&self) -> f64 {
        self.lateness_s
    }

    /// For how long the clocks have agreed, s.
    pub(crate) fn agree_s(&self) -> f64 {
        self.span.map_or(0.0, |[_, (_, arrival_s)]| arrival_s - self.agree_from_s)
    }

    /// How far the robot's clock has come since the first state, and ours, s.
    pub(crate) fn progress(&self) -> (f64, f64) {
        let [first, last] = self.span.unwrap_or_default();
        ((last.0 - first.0) as f64 * 1e-9, last.1 - first.1)
    }

    /// Takes the stamp of a state and its arrival by the local monotonic clock. Returns by how many seconds the robot's
    /// clock has gained on ours within a second, negative for a loss, where that is too much. It then begins anew.
    pub(crate) fn see(&mut self, stamp_ns: i64, arrival_s: f64) -> Option<f64> {
        let [first, last] = *self.span.get_or_insert([(stamp_ns, arrival_s); 2]);
        self.span = Some([first, (stamp_ns, arrival_s)]);
        let transport_s = arrival_s - (stamp_ns - first.0) as f64 * 1e-9;
        let (step_s, wait_s) = ((stamp_ns - last.0).max(0) as f64 * 1e-9, arrival_s - last.1);
        if wait_s > SILENCE.0 * step_s + SILENCE.1 {
            self.open_s = wait_s - step_s;
            self.stood_s += self.open_s;
        } else if wait_s < BURST * step_s {
            let back_s = (step_s - wait_s).min(self.open_s);
            (self.open_s, self.stood_s) = (self.open_s - back_s, self.stood_s - back_s);
        } else {
            self.open_s = 0.0;
        }
        if self.least.is_none() {
            self.agree_from_s = arrival_s;
        }
        let (before_s, least_s) = self.least.unwrap_or((arrival_s, transport_s));
        let least_s = (least_s + DRIFT * (arrival_s - before_s)).min(transport_s);
        self.least = Some((arrival_s, least_s));
        self.lateness_s = transport_s - least_s;
        let apart_s = self.gained(arrival_s, transport_s).or_else(|| self.lost(arrival_s, transport_s - self.stood_s));
        if apart_s.is_some() {
            *self = Self { span: self.span, agree_from_s: arrival_s, ..Self::default() };
        } else if arrival_s >= self.agree_from_s + FIRST_S
            && self.marks.back().is_none_or(|(at_s, _)| arrival_s >= at_s + MARK_S)
        {
            self.marks.push_back((arrival_s, least_s));
        }
        apart_s
    }

    fn gained(&mut self, arrival_s: f64, transport_s: f64) -> Option<f64> {
        while self.marks.get(1).is_some_and(|(at_s, _)| *at_s <= arrival_s - OVER_S) {
            self.marks.pop_front();
        }
        self.marks.front().map(|(_, least_s)| least_s - transport_s).filter(|gained_s| *gained_s > APART_S)
    }

    fn lost(&mut self, arrival_s: f64, transport_s: f64) -> Option<f64> {
        match self.minima.back_mut().filter(|(from_s, _)| arrival_s < from_s + MARK_S) {
            Some((_, least_s)) => *least_s = least_s.min(transport_s),
            None => self.minima.push_back((arrival_s, transport_s)),
        }
        while self.minima.front().is_some_and(|(from_s, _)| *from_s < arrival_s - OVER_S - INTERVAL_S) {
            self.minima.pop_front();
        }
        let least = |from_s: f64| {
            let inside = self.minima.iter().filter(|(at_s, _)| (from_s..=from_s + INTERVAL_S).contains(at_s));
            inside.map(|(_, least_s)| *least_s).reduce(f64::min)
        };
        // A loss is known once the earlier interval lies wholly after the beginning.
        let whole = arrival_s - self.agree_from_s >= OVER_S + INTERVAL_S;
        let lost_s = least(arrival_s - INTERVAL_S)? - least(arrival_s - OVER_S - INTERVAL_S)?;
        (whole && lost_s > APART_S).then_some(-lost_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// States every 2 ms of the robot's time for 4 s of ours; `clock` gives the robot's time at ours, and `late` how long
    /// a state is on its way. Returns when the clocks are found apart, and by how much.
    fn apart(clock: impl Fn(f64) -> f64, late: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let mut watch = ClockWatch::default();
        let (mut newest_s, mut last_s) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for k in 0..40_000 {
            // A step of ours of a tenth of a millisecond: a state goes out where the robot's time passes a multiple of 2 ms.
            let t = f64::from(k) * 1e-4;
            let stamp_s = (clock(t) * 500.0).floor() / 500.0;
            if stamp_s == newest_s {
                continue;
            }
            newest_s = stamp_s;
            last_s = (t + 1e-3 + late(t)).max(last_s);
            if let Some(by_s) = watch.see((stamp_s * 1e9).round() as i64, last_s) {
                return Some((t, by_s));
            }
        }
        None
    }

    #[test]
    fn analytic_a_clock_within_a_hundredth_agrees_and_one_beyond_a_fiftieth_does_not() {
        for rate in [0.985, 0.995, 1.0, 1.005, 1.015] {
            assert_eq!(apart(|t| rate * t, |_| 0.0), None, "{rate}");
        }
        // From 2 s on; a gain is seen once it is 20 ms, a loss half a second later.
        for (rate, by_s) in [(0.9, 2.8), (0.97, 3.25), (1.03, 2.75), (1.05, 2.45), (1.3, 2.1), (2.0, 2.03)] {
            let (t, found_s) = apart(|t| if t < 2.0 { t } else { 2.0 + rate * (t - 2.0) }, |_| 0.0).unwrap();
            assert!(t > 2.0 && t < by_s && (found_s > 0.0) == (rate > 1.0), "{rate}: {t} s, {found_s} s");
        }
        // And from the beginning on.
        for rate in [0.9, 1.05, 2.0] {
            assert!(apart(|t| rate * t, |_| 0.0).is_some(), "{rate}");
        }
    }

    #[test]
    fn analytic_a_step_is_seen_a_gain_at_once() {
        for step_s in [-0.45, -0.1, -0.05, 0.05, 0.1, 0.45] {
            let (t, by_s) = apart(|t| if t < 2.0 { t } else { t + step_s }, |_| 0.0).unwrap();
            let within_s = if step_s > 0.0 { 0.003 } else { 0.6 };
            assert!(t >= 2.0 - 1e-9 && t < 2.0 + within_s, "{step_s}: {t}");
            assert!((by_s - step_s).abs() < 3e-3, "{step_s}: {by_s}");
        }
    }

    #[test]
    fn states_that_are_late_or_do_not_come_are_no_clock() {
        // Bursts every 50 ms, from the beginning on.
        assert_eq!(apart(|t| t, |t| 0.05 - t % 0.05), None);
        // 0.4 s of states that are 40 ms late, and a silence of 0.3 s after which they all come at once.
        assert_eq!(apart(|t| t, |t| if (1.0..1.4).contains(&t) { 0.04 } else { 0.0 }), None);
        assert_eq!(apart(|t| t, |t| if (1.0..1.3).contains(&t) { 1.3 - t } else { 0.0 }), None);
        // A controller that stands still for 0.1 s, twice: its clock stands as well.
        // And one that does so for 8 ms, ten times a second.
        assert_eq!(apart(|t| t - 0.008 * (10.0 * t).floor() - (t % 0.1).min(0.008), |_| 0.0), None);
        let stands = |t: f64| t - (t - 1.0).clamp(0.0, 0.1) - (t - 2.0).clamp(0.0, 0.1);
        assert_eq!(apart(stands, |_| 0.0), None);
    }
}
