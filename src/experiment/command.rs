//! The commanded motion of a plan as a function of time, from the first moment of settling to rest again.

use super::{ExperimentPlan, Layout, Phase};
use crate::excitation::Trajectory;

/// The commanded motion: position, velocity and acceleration are continuous from beginning to end.
///
/// See the plan's module for the ramps.
#[derive(Clone, Copy)]
pub struct Command<'a> {
    trajectory: &'a dyn Trajectory,
    ramp_s: f64,
    ramp_in_s: f64,
    periodic_s: f64,
    ramp_out_s: f64,
}

/// `∫ σ̇` of the ramp from 0 to `u`, in units of the ramp's length; 1/2 at `u = 1`.
fn travelled(u: f64) -> f64 {
    let u4 = u * u * u * u;
    u4 * (2.5 - 3.0 * u + u * u)
}

impl<'a> Command<'a> {
    /// The commanded motion of a plan whose layout is known.
    #[must_use]
    pub fn new(plan: &'a ExperimentPlan, layout: &Layout) -> Self {
        let at = |sample: usize| sample as f64 / plan.rate_hz;
        let (ramp_in, ramp_out) = (layout.span(Phase::RampIn), layout.span(Phase::RampOut));
        Self {
            trajectory: &plan.trajectory,
            ramp_s: at(ramp_in.end) - at(ramp_in.start),
            ramp_in_s: at(ramp_in.start),
            periodic_s: at(ramp_in.end),
            ramp_out_s: at(ramp_out.start),
        }
    }

    /// When the periodic motion begins, s after the beginning of the experiment: its phase is zero there.
    #[must_use]
    pub fn periodic_begin_s(&self) -> f64 {
        self.periodic_s
    }

    /// When the ramp out begins, s after the beginning of the experiment.
    #[must_use]
    pub fn periodic_end_s(&self) -> f64 {
        self.ramp_out_s
    }

    /// Time on the trajectory, its rate and the rate of that, at time `t` of the experiment: `σ, σ̇, σ̈` in s, 1, 1/s.
    #[must_use]
    pub fn progress(&self, t: f64) -> (f64, f64, f64) {
        let span = self.ramp_s;
        let smooth =
            |u: f64| (u * u * u * (10.0 - 15.0 * u + 6.0 * u * u), 30.0 * u * u * (1.0 - u) * (1.0 - u) / span);
        if t >= self.periodic_s && t <= self.ramp_out_s {
            (t - self.periodic_s, 1.0, 0.0)
        } else if t < self.periodic_s {
            let u = ((t - self.ramp_in_s) / span).clamp(0.0, 1.0);
            let (rate, growth) = smooth(u);
            (span * (travelled(u) - 0.5), rate, growth)
        } else {
            let u = ((t - self.ramp_out_s) / span).clamp(0.0, 1.0);
            let (rate, growth) = smooth(1.0 - u);
            (self.ramp_out_s - self.periodic_s + span * (0.5 - travelled(1.0 - u)), rate, -growth)
        }
    }

    /// Commanded position, velocity and acceleration at time `t` (s since the beginning of the experiment), n each.
    pub fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let (sigma, rate, growth) = self.progress(t);
        self.trajectory.evaluate(sigma, q, qd, qdd);
        for i in 0..q.len() {
            qdd[i] = qdd[i] * rate * rate + qd[i] * growth;
            qd[i] *= rate;
        }
    }

    /// The start pose: where the arm rests before the ramp, n.
    pub fn start(&self, q: &mut [f64]) {
        let (mut qd, mut qdd) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        self.evaluate(0.0, q, &mut qd, &mut qdd);
    }
}
