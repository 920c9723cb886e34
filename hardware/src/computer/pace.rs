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
const CATCH_UP: Duration = Duration::from_millis(5);

/// Paces steps: each begins when it is due. After a short delay they catch up; after a long one the robot's clock has
/// fallen behind the wall clock for good, as if the whole robot had stood still: its motion stays what it is in its own
/// time, and the delay is counted.
#[derive(Debug)]
pub(crate) struct Pace {
    step: Duration,
    due: Instant,
    deadlines: Deadlines,
}

impl Pace {
    pub(crate) fn new(step_s: f64) -> Self {
        let step = Duration::from_secs_f64(step_s);
        Self { step, due: Instant::now() + step, deadlines: Deadlines::default() }
    }

    /// Ends a step: waits until the next one is due.
    pub(crate) fn wait(&mut self) {
        self.deadlines.steps += 1;
        let now = Instant::now();
        if now <= self.due {
            std::thread::sleep(self.due - now);
        } else {
            let late = now - self.due;
            self.deadlines.missed += 1;
            self.deadlines.latest_s = self.deadlines.latest_s.max(late.as_secs_f64());
            if late > CATCH_UP {
                self.deadlines.behind_s += late.as_secs_f64();
                self.due = now;
            }
        }
        self.due += self.step;
    }

    /// From now on a step of `step_s` takes that time divided by `rate`.
    pub(crate) fn set_rate(&mut self, step_s: f64, rate: f64) {
        self.step = Duration::from_secs_f64(step_s / rate);
    }

    pub(crate) fn deadlines(&self) -> Deadlines {
        self.deadlines
    }
}
