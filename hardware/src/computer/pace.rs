//! Servo steps by the wall clock.

use std::time::{Duration, Instant};

/// How well the deadlines of the servo steps were kept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deadlines {
    /// Steps so far.
    pub steps: u64,
    /// Steps that ended after the next one was due.
    pub missed: u64,
    /// Latest end of a step after its deadline, s.
    pub latest_s: f64,
    /// Time by which the robot's clock has fallen behind the wall clock, s.
    pub behind_s: f64,
}

/// How far the steps may fall behind before the robot's clock is put back instead of catching up, s.
const GIVE_UP: Duration = Duration::from_secs(1);
/// How many times as fast as usual they catch up, at most: a burst of states would fill the queues of the network.
const CATCH_UP: u32 = 2;

/// Paces steps: each begins when it is due. After a delay they catch up, as the clock of a real robot never stands: short
/// delays that added up would look like states that take ever longer. After a very long delay the robot's clock has fallen
/// behind the wall clock for good, as if the whole robot had stood still, and the delay is counted.
#[derive(Debug)]
pub(crate) struct Pace {
    step: Duration,
    begun: Instant,
    due: Instant,
    deadlines: Deadlines,
}

impl Pace {
    pub(crate) fn new(step_s: f64) -> Self {
        Self::begin(step_s, Instant::now())
    }

    fn begin(step_s: f64, now: Instant) -> Self {
        let step = Duration::from_secs_f64(step_s);
        Self { step, begun: now, due: now + step, deadlines: Deadlines::default() }
    }

    /// Ends a step: waits until the next one is due.
    pub(crate) fn wait(&mut self) {
        let rest = self.end(Instant::now());
        if !rest.is_zero() {
            std::thread::sleep(rest);
        }
    }

    /// Ends a step at `now`, and says how long to wait until the next one begins.
    fn end(&mut self, now: Instant) -> Duration {
        self.deadlines.steps += 1;
        let late = now.saturating_duration_since(self.due);
        if !late.is_zero() {
            self.deadlines.missed += 1;
            self.deadlines.latest_s = self.deadlines.latest_s.max(late.as_secs_f64());
        }
        if late > GIVE_UP {
            self.deadlines.behind_s += late.as_secs_f64();
            self.due = now;
        }
        self.begun = self.due.max(self.begun + self.step / CATCH_UP).max(now);
        self.due += self.step;
        self.begun - now
    }

    /// From now on a step of `step_s` takes that time divided by `rate`.
    pub(crate) fn set_rate(&mut self, step_s: f64, rate: f64) {
        self.step = Duration::from_secs_f64(step_s / rate);
    }

    pub(crate) fn deadlines(&self) -> Deadlines {
        self.deadlines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of 2 ms, each of which takes 0.1 ms and the 1000th a `delay_ms` more. How far behind they begin after the
    /// delay, step for step, ms; and what was counted.
    fn behind_ms(delay_ms: u64) -> (Vec<f64>, Deadlines) {
        let begin = Instant::now();
        let mut pace = Pace::begin(2e-3, begin);
        let (mut now, mut behind) = (begin, Vec::new());
        for k in 1..=4000_u32 {
            now += Duration::from_micros(100 + if k == 1000 { 1000 * delay_ms } else { 0 });
            now += pace.end(now);
            if k >= 1000 {
                behind.push(1e3 * (now - begin).as_secs_f64() - 2.0 * f64::from(k));
            }
        }
        (behind, pace.deadlines())
    }

    #[test]
    fn analytic_a_delay_is_made_up_for_at_twice_the_speed() {
        // From 2 ms of its own step on: 0.1 ms of work and the delay, of which the step takes 2 ms.
        for delay_ms in [50, 300, 900] {
            let (behind, deadlines) = behind_ms(delay_ms);
            for (k, behind_ms) in behind.iter().enumerate() {
                let expected = (delay_ms as f64 - 1.9 - k as f64).max(0.0);
                assert!((behind_ms - expected).abs() < 1e-3, "{delay_ms} ms, step {k}: {behind_ms} ms");
            }
            assert_eq!(deadlines.behind_s, 0.0);
            assert!((1e3 * deadlines.latest_s - (delay_ms as f64 - 1.9)).abs() < 1e-3, "{deadlines:?}");
        }
    }

    #[test]
    fn after_a_very_long_delay_the_clock_is_behind_for_good() {
        let (behind, deadlines) = behind_ms(2000);
        assert!(behind.iter().all(|behind_ms| (behind_ms - 1998.1).abs() < 1e-3), "{behind:?}");
        assert!((deadlines.behind_s - 1.9981).abs() < 1e-6, "{deadlines:?}");
        assert_eq!(deadlines.missed, 1);
    }
}
