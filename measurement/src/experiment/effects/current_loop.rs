//! Between a set point of current and the current that flows: delay, then a first-order lag.
//!
//! ```text
//! T di/dt = s(t − d/f) − i        s held over a servo step of rate f, d whole steps
//! ```
//! solved exactly: over a time h under a constant s the current comes nearer to it by the factor exp(−h/T), and its mean
//! is `s + (i − s) (1 − exp(−h/T)) T/h`. The controller reports its set point, as drives without a current readout do; a
//! drive that reports what flows would show the loop's lag to no identification.

use std::collections::VecDeque;

/// The current loops of all motors.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CurrentLoop {
    lag_s: f64,
    waiting: VecDeque<Vec<f64>>,
    current: Vec<f64>,
}

impl CurrentLoop {
    /// Loops of `count` motors with a time constant in s and a delay in servo steps, at rest.
    pub(super) fn new(lag_s: f64, delay: usize, count: usize) -> Self {
        Self { lag_s, waiting: vec![vec![0.0; count]; delay + 1].into(), current: vec![0.0; count] }
    }

    /// A new servo step with these set points, A.
    pub(super) fn set(&mut self, set_points: &[f64]) {
        if let Some(mut oldest) = self.waiting.pop_front() {
            oldest.copy_from_slice(set_points);
            self.waiting.push_back(oldest);
        }
    }

    /// Mean currents over the next `h` s, A; advances by them.
    pub(super) fn flow(&mut self, h: f64, mean: &mut [f64]) {
        let Some(set_points) = self.waiting.front() else { return };
        if self.lag_s == 0.0 {
            mean.copy_from_slice(set_points);
            return;
        }
        let (left, share) = (libm::exp(-h / self.lag_s), self.lag_s / h);
        for i in 0..mean.len() {
            let away = self.current[i] - set_points[i];
            mean[i] = set_points[i] + away * (1.0 - left) * share;
            self.current[i] = set_points[i] + away * left;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_a_step_arrives_late_and_rises_exponentially() {
        let (h, lag) = (1e-3, 4e-3);
        let mut drive = CurrentLoop::new(lag, 3, 1);
        let mut charge = 0.0;
        for step in 0..50 {
            drive.set(&[2.0]);
            let mut mean = [0.0];
            drive.flow(h, &mut mean);
            charge += mean[0] * h;
            if step < 3 {
                assert_eq!(mean, [0.0], "three steps of delay");
            }
            // ∫ 2 (1 − exp(−t/T)) dt = 2 (t − T (1 − exp(−t/T))), t from the end of the delay.
            let t: f64 = (f64::from(step - 2) * h).max(0.0);
            let expected = 2.0 * (t - lag * (1.0 - (-t / lag).exp()));
            assert!((charge - expected).abs() < 1e-15, "{charge} {expected}");
        }
    }

    #[test]
    fn identity_without_lag_and_delay_the_current_is_the_set_point() {
        let mut drive = CurrentLoop::new(0.0, 0, 2);
        let mut mean = [0.0; 2];
        drive.set(&[1.0, -3.0]);
        drive.flow(1e-3, &mut mean);
        assert_eq!(mean, [1.0, -3.0]);
    }
}
