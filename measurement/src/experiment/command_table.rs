//! The commanded motion of one experiment at every servo step, computed once.

use super::command::Command;
use super::layout::Layout;
use super::phase::Phase;
use super::plan::ExperimentPlan;

/// Commanded joint coordinates at every servo step: the ramps row by row, and one period for all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandTable {
    dof: usize,
    settle: usize,
    ramp: usize,
    period: usize,
    periodic: usize,
    /// Ramp in, one period, ramp out with the pose after it: rows of n.
    rows: Vec<f64>,
}

impl CommandTable {
    /// Tabulates a plan for a servo that takes `per_sample` steps for each recorded sample.
    pub fn new(plan: &ExperimentPlan, layout: &Layout, per_sample: usize) -> Self {
        let command = Command::new(plan, layout);
        let dof = plan.trajectory.dof();
        let steps = |phase: Phase| layout.span(phase).len() * per_sample;
        let (settle, ramp) = (steps(Phase::Settle), steps(Phase::RampIn));
        let period = layout.period_samples * per_sample;
        let periodic = steps(Phase::Discard) + steps(Phase::Record);
        let dt = 1.0 / (plan.rate_hz * per_sample as f64);
        let (mut q, mut qd, mut qdd) = (vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]);
        let mut rows = Vec::with_capacity((2 * ramp + period + 1) * dof);
        let begin = settle + ramp;
        for step in (settle..begin + period).chain(begin + periodic..=begin + periodic + ramp) {
            command.evaluate(step as f64 * dt, &mut q, &mut qd, &mut qdd);
            rows.extend_from_slice(&q);
        }
        Self { dof, settle, ramp, period, periodic, rows }
    }

    /// Commanded joint coordinates at a servo step, counted from the beginning of the experiment; n.
    pub fn row(&self, step: usize) -> &[f64] {
        let begin = self.settle + self.ramp;
        let row = if step < self.settle {
            0
        } else if step < begin {
            step - self.settle
        } else if step < begin + self.periodic {
            self.ramp + (step - begin) % self.period
        } else {
            self.ramp + self.period + (step - begin - self.periodic).min(self.ramp)
        };
        &self.rows[row * self.dof..(row + 1) * self.dof]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges;

    #[test]
    fn identity_table_is_the_command_at_every_servo_step() {
        let plan =
            ExperimentPlan { settle_s: 0.1, ramp_s: 0.4, periods: 2, ..ExperimentPlan::new(hinges::trajectory(2)) };
        let layout = plan.layout().unwrap();
        let command = Command::new(&plan, &layout);
        for per_sample in [1, 5] {
            let table = CommandTable::new(&plan, &layout, per_sample);
            let (mut q, mut qd, mut qdd) = ([0.0; 2], [0.0; 2], [0.0; 2]);
            for step in (0..(layout.samples() + 20) * per_sample).step_by(7) {
                command.evaluate(step as f64 * 1e-3 / per_sample as f64, &mut q, &mut qd, &mut qdd);
                for (x, y) in table.row(step).iter().zip(q) {
                    // The table wraps the period, the command's sine does not: rounding of a phase of 20 rad.
                    assert!((x - y).abs() < 1e-13, "{x} {y} at {step}");
                }
            }
        }
    }
}
