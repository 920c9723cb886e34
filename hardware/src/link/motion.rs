//! A motion to perform.

use armid::experiment::{Command, ExperimentPlan, Layout};

/// A commanded motion from rest to rest, at any time between.
pub trait Motion {
    /// Number of joints n.
    fn dof(&self) -> usize;

    /// How long it takes, s.
    fn duration_s(&self) -> f64;

    /// Position, velocity and acceleration at time `t` after its beginning, n each; at rest before and after it.
    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]);
}

/// The motion of an experiment.
#[derive(Clone, Copy)]
pub struct PlanMotion<'a> {
    command: Command<'a>,
    dof: usize,
    duration_s: f64,
}

impl<'a> PlanMotion<'a> {
    /// The motion of `plan`, whose layout is known, for a robot with `dof` joints.
    pub fn new(plan: &'a ExperimentPlan, layout: &Layout, dof: usize) -> Self {
        Self { command: Command::new(plan, layout), dof, duration_s: layout.samples() as f64 / plan.rate_hz }
    }
}

impl Motion for PlanMotion<'_> {
    fn dof(&self) -> usize {
        self.dof
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.command.evaluate(t, q, qd, qdd);
    }
}
