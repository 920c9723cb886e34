//! One plan from rest to the mean of its recorded periods.

use armid::estimation::ClosedLoopError;
use armid::experiment::{CommandTable, DivergenceError, JointLoop, Layout, Phase, Plant, PlantError};
use armid::model::Robot;
use armid::observer::{Observer, Progress, Work};

use super::bodies::Body;
use super::period_mean::{Period, PeriodMean};
use crate::AnalyticPlant;

/// A plan as the servo sees it.
#[derive(Debug)]
pub(super) struct Motion {
    pub(super) layout: Layout,
    pub(super) table: CommandTable,
    /// Servo steps in a sample.
    pub(super) per_sample: usize,
}

impl Motion {
    /// Commanded joint coordinates at a servo step after a sample of a recorded period.
    pub(super) fn command(&self, sample: usize, step: usize) -> &[f64] {
        self.table.row((self.layout.span(Phase::Record).start + sample) * self.per_sample + step)
    }
}

/// Positions, velocities, accelerations and torque of the mean recorded period (N × n each), then the tables of `body`, sums
/// over blocks of `block` samples.
///
/// # Errors
/// [`ClosedLoopError::MassMatrix`] or [`ClosedLoopError::Diverged`] with the time, [`ClosedLoopError::Interrupted`].
pub(super) fn mean_period(
    robot: &Robot,
    motion: &Motion,
    mut joints: JointLoop,
    (plant, body): (&mut AnalyticPlant, &mut dyn Body),
    block: usize,
    observer: &dyn Observer,
) -> Result<Period, ClosedLoopError> {
    let Motion { layout, table, per_sample } = motion;
    let (n, dt) = (robot.dof(), joints.dt());
    let (discard, record) = (layout.span(Phase::Discard), layout.span(Phase::Record));
    let length = layout.period_samples;
    let mut mean = PeriodMean::new(record.len() / length);
    let empty = || vec![Vec::new(); 4];
    let mut period: Period = empty();
    period.extend(body.tables(length / block));
    let (mut before, mut qdd) = (vec![0.0; n], vec![0.0; n]);
    body.reset(table.row(0));
    for step in 0.. {
        let t = step as f64 * dt;
        let (q, qd) = body.state();
        if let Some(reason) = runaway(robot, q, qd) {
            return Err(ClosedLoopError::Diverged { t, reason });
        }
        joints.step(table.row(step), q, qd);
        body.decided(&joints);
        if step == 0 {
            before.copy_from_slice(joints.tau());
        }
        let sample = step / per_sample;
        if step.is_multiple_of(*per_sample) {
            go_on(observer, sample, record.end)?;
            for (before, now) in before.iter_mut().zip(joints.tau()) {
                *before = 0.5 * (*before + now);
            }
            let (q, qd) = body.state();
            Plant::reset(plant, q, qd);
            if !plant.definite_acceleration(&before, &mut qdd) {
                return Err(ClosedLoopError::MassMatrix { t });
            }
            if sample >= discard.start {
                for (table, values) in period.iter_mut().zip([q, qd, &qdd[..], &before[..]]) {
                    table.extend_from_slice(values);
                }
                let within = (sample - discard.start) % length;
                if within / block < length / block {
                    body.sample(within / block, &mut period[4..]);
                }
                if within + 1 == length {
                    let whole = std::mem::replace(&mut period, empty());
                    period.extend(body.tables(length / block));
                    if let Some(mean) = mean.take(whole, sample >= record.start) {
                        return Ok(mean);
                    }
                }
            }
        }
        before.copy_from_slice(joints.tau());
        if let Err(fault) = body.step(&joints, dt) {
            return Err(ClosedLoopError::Diverged { t, reason: DivergenceError::Plant(fault) });
        }
    }
    unreachable!("the mean is there when the last recorded period is")
}

/// Asks the observer at every tenth sample whether the simulation goes on: a sample with the derivatives by sixty parameters
/// takes about a millisecond.
///
/// # Errors
/// [`ClosedLoopError::Interrupted`].
pub(super) fn go_on(observer: &dyn Observer, done: usize, total: usize) -> Result<(), ClosedLoopError> {
    let asks = done.is_multiple_of(10);
    match asks && observer.observe(Progress { work: Work::Samples, done, total }).is_break() {
        true => Err(ClosedLoopError::Interrupted),
        false => Ok(()),
    }
}

/// As the servo of an arm finds it: a speed of ten times its limit.
pub(super) fn runaway(robot: &Robot, q: &[f64], qd: &[f64]) -> Option<DivergenceError> {
    if let Some(fault) = PlantError::of_state(q, qd) {
        return Some(DivergenceError::Plant(fault));
    }
    let (joint, qd) = robot.joints().iter().zip(qd).find(|(joint, qd)| qd.abs() > 10.0 * joint.limits.velocity)?;
    Some(DivergenceError::Speed { joint: joint.name.clone(), found: qd.abs(), limit: joint.limits.velocity })
}
