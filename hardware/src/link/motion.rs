//! A motion to perform, and the points by which it is handed over.

use armid::experiment::{Command, ExperimentPlan, Layout};

use crate::message::{Time, TrajectoryPoint};

/// A commanded motion from rest to rest, at any time between.
pub trait Motion {
    /// Number of joints n.
    fn dof(&self) -> usize;

    /// How long it takes, s.
    fn duration_s(&self) -> f64;

    /// Position, velocity and acceleration at time `t` after its beginning, n each; at rest before and after it.
    fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]);
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
    #[must_use]
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

    fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.command.evaluate(t, q, qd, qdd);
    }
}

/// Points of a motion, no further apart than `spacing_s`, from its beginning to its end.
///
/// With position, velocity and acceleration in every point the robot's computer joins two of them by a polynomial of
/// degree five, whose error is `h⁶ max|q⁗⁗| / 46080` (the sixth derivative): at 50 ms and the fifth harmonic of a
/// period of 10 s it is 2e-11 of the amplitude, of a period of 2 s 3e-7.
#[must_use]
pub fn points(motion: &dyn Motion, spacing_s: f64) -> Vec<TrajectoryPoint> {
    let count = (motion.duration_s() / spacing_s).ceil().max(1.0) as usize;
    let point = |k: usize| {
        let time_from_start = Time::from_s(motion.duration_s() * k as f64 / count as f64);
        let zero = vec![0.0; motion.dof()];
        let (mut positions, mut velocities, mut accelerations) = (zero.clone(), zero.clone(), zero);
        motion.at(time_from_start.seconds(), &mut positions, &mut velocities, &mut accelerations);
        TrajectoryPoint { positions, velocities, accelerations, effort: Vec::new(), time_from_start }
    };
    (0..=count).map(point).collect()
}
