//! How well the servo followed its command while it counted.

/// Largest and mean errors and efforts over the recorded periods, taken from the plant's true state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracking {
    /// Largest distance of each joint from its command, rad (m); n.
    pub peak_error: Vec<f64>,
    /// Root mean square distance of each joint from its command, rad (m); n.
    pub rms_error: Vec<f64>,
    /// Largest effort of the motors on each joint, N·m (N); n.
    pub peak_effort: Vec<f64>,
    /// Largest current of each motor, A; n.
    pub peak_current: Vec<f64>,
    /// Servo steps of the whole experiment in which a current was at its limit.
    pub saturated_steps: usize,
    /// Servo steps that the means are over.
    pub steps: usize,
}

impl Tracking {
    pub(super) fn new(dof: usize) -> Self {
        let zero = vec![0.0; dof];
        Self {
            peak_error: zero.clone(),
            rms_error: zero.clone(),
            peak_effort: zero.clone(),
            peak_current: zero,
            ..Self::default()
        }
    }

    /// Adds one servo step; `rms_error` holds sums of squares until [`Tracking::finish`].
    pub(super) fn add(&mut self, command: &[f64], q: &[f64], effort: &[f64], current: &[f64]) {
        let n = command.len();
        // Of one known length, so that no entry is checked by itself.
        let [q, effort, current] = [q, effort, current].map(|x| &x[..n]);
        let [peak_error, rms_error, peak_effort, peak_current] =
            [&mut self.peak_error, &mut self.rms_error, &mut self.peak_effort, &mut self.peak_current]
                .map(|x| &mut x[..n]);
        for i in 0..n {
            let error = command[i] - q[i];
            peak_error[i] = peak_error[i].max(error.abs());
            rms_error[i] += error * error;
            peak_effort[i] = peak_effort[i].max(effort[i].abs());
            peak_current[i] = peak_current[i].max(current[i].abs());
        }
        self.steps += 1;
    }

    pub(super) fn finish(&mut self) {
        for sum in &mut self.rms_error {
            *sum = (*sum / self.steps.max(1) as f64).sqrt();
        }
    }
}
