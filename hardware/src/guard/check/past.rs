//! What was seen lately.

use std::collections::VecDeque;

/// The values of the last so many seconds, and the one before them.
pub(super) struct Past<T> {
    window_s: f64,
    values: VecDeque<(f64, T)>,
}

impl<T> Past<T> {
    pub(super) const fn new(window_s: f64) -> Self {
        Self { window_s, values: VecDeque::new() }
    }

    /// The newest value that is a window old at `now`, and its time.
    pub(super) fn at(&mut self, now: f64) -> Option<&(f64, T)> {
        // Half a microsecond for the rounding of time stamps.
        let begin = now - self.window_s + 5e-7;
        while self.values.get(1).is_some_and(|(t, _)| *t <= begin) {
            self.values.pop_front();
        }
        self.values.front().filter(|(t, _)| *t <= begin)
    }

    pub(super) fn push(&mut self, t: f64, value: T) {
        self.values.push_back((t, value));
    }
}
