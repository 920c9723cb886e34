//! The servos of up to eight runs of one arm, side by side on the lanes of the processor.
//!
//! The laws are those of [`super::joint_loop::JointLoop`], motor by motor, so each run has the bits that it has alone.
//! An arm with coupled motors, or with effects of its drives and sensors, is not for this: its runs step one by one.

use pulp::{Arch, Simd, WithSimd};

use super::controller::{MotorPid, PidMemory};
use super::joint_loop::JointLoop;
use super::motors::Motors;
use super::sensing::{Ammeter, Encoder, Sensors};
use crate::lanes::{Lane, MOST_LANES, Wide};
use crate::model::EffortInterface;

/// One number of each run of a group. Where there are fewer runs, what stands on the lanes that are left means nothing.
pub type Runs = [f64; MOST_LANES];

const NONE: Runs = [0.0; MOST_LANES];

/// One joint of all runs: what is remembered of it, aligned to lines of the cache, and its laws.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct JointRuns {
    grid: Runs,
    position_noise: Runs,
    current_noise: Runs,
    command: Runs,
    measured: Runs,
    last_error: Runs,
    rate: Runs,
    integral: Runs,
    before: Runs,
    current: Runs,
    effort: Runs,
    pid: MotorPid,
    encoder: Encoder,
    meter: Ammeter,
    /// Torque that the motor really gives, N·m/A (N/A).
    per_ampere: f64,
    /// Reported effort per ampere.
    reported: f64,
}

/// The loops of the joints of a group of runs.
#[derive(Clone, Debug)]
pub(super) struct JointLoops {
    joints: Vec<JointRuns>,
    motors: Motors,
    /// Lanes beyond them are left out but for those that fill a vector.
    runs: usize,
    position_noise: bool,
    fresh: bool,
    pub(super) arch: Arch,
}

impl JointLoops {
    /// These loops of one arm, none of which has taken a step, side by side; `None` where they must step one by one.
    pub(super) fn new(loops: &[&JointLoop]) -> Option<Self> {
        let (first, last) = (loops.first()?, loops.len() - 1);
        if !loops.iter().all(|each| each.is_plain()) {
            return None;
        }
        let sensors = loops.iter().map(|each| each.sensors.plain()).collect::<Option<Vec<_>>>()?;
        let (encoders, meters) = sensors[0];
        let joint = |i: usize| JointRuns {
            pid: first.controller.motors[i],
            encoder: encoders[i].clone(),
            meter: meters[i].clone(),
            per_ampere: first.motors.per_ampere[i],
            reported: match first.effort {
                EffortInterface::Current => 1.0,
                EffortInterface::Torque => first.transmission.per_ampere[i],
            },
            grid: std::array::from_fn(|run| sensors[run.min(last)].0[i].grid),
            position_noise: NONE,
            current_noise: NONE,
            command: NONE,
            measured: NONE,
            last_error: NONE,
            rate: NONE,
            integral: NONE,
            before: NONE,
            current: NONE,
            effort: NONE,
        };
        let joints: Vec<JointRuns> = (0..encoders.len()).map(joint).collect();
        let position_noise = encoders.iter().any(|encoder| encoder.noise > 0.0);
        Some(Self {
            joints,
            motors: first.motors.clone(),
            runs: loops.len(),
            position_noise,
            fresh: true,
            arch: Arch::new(),
        })
    }

    /// Commands these coordinates (n) on lanes of one run.
    pub(super) fn command(&mut self, lanes: std::ops::Range<usize>, command: &[f64]) {
        for (joint, command) in self.joints.iter_mut().zip(command) {
            joint.command[lanes.clone()].fill(*command);
        }
    }

    /// Draws the noise of the next step on the lane of one run: of positions (rad, m), and where a sample is `due` of currents (A).
    pub(super) fn draw_noise(&mut self, run: usize, sensors: &mut Sensors, due: bool) {
        let ([positions, currents], sign) = sensors.normals();
        if self.position_noise {
            for joint in self.joints.iter_mut().filter(|joint| joint.encoder.noise > 0.0) {
                joint.position_noise[run] = joint.encoder.noise * sign * positions.draw();
            }
        }
        if due {
            for joint in self.joints.iter_mut().filter(|joint| joint.meter.noise > 0.0) {
                joint.current_noise[run] = joint.meter.noise * (sign * currents.draw());
            }
        }
    }

    /// One servo step of all runs, as [`JointLoop::step`] and then [`JointLoop::sense`]. Coordinates and velocities of the joints in,
    /// efforts on them out, n each.
    pub(super) fn step(&mut self, q: &[Runs], qd: &[Runs], tau: &mut [Runs]) {
        let fresh = std::mem::take(&mut self.fresh);
        let Self { joints, motors, runs, .. } = self;
        self.arch.dispatch(Step { joints, motors, runs: *runs, q, qd, tau, fresh });
    }

    /// What the sensors of one run said at the last step, n each.
    pub(super) fn read(&self, run: usize, q: &mut [f64], effort: &mut [f64]) {
        for ((joint, q), effort) in self.joints.iter().zip(q).zip(effort) {
            (*q, *effort) = (joint.measured[run], joint.effort[run]);
        }
    }
}

struct Step<'a> {
    joints: &'a mut [JointRuns],
    motors: &'a Motors,
    runs: usize,
    q: &'a [Runs],
    qd: &'a [Runs],
    tau: &'a mut [Runs],
    fresh: bool,
}

impl WithSimd for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { joints, motors, runs, q, qd, tau, fresh } = self;
        for (i, (((joint, q), qd), tau)) in joints.iter_mut().zip(q).zip(qd).zip(tau).enumerate() {
            joint.step(simd, motors, (i, runs), (q, qd), tau, fresh);
        }
    }
}

/// What runs that fill the lanes of this processor have, from a multiple of their number on.
#[inline(always)]
fn load<S: Simd>(simd: S, runs: &Runs, first: usize) -> Wide<S> {
    Wide::new(simd, S::as_simd_f64s(runs).0[first / S::F64_LANES])
}

#[inline(always)]
fn store<S: Simd>(runs: &mut Runs, first: usize, wide: Wide<S>) {
    S::as_mut_simd_f64s(runs).0[first / S::F64_LANES] = wide.x;
}

impl JointRuns {
    #[inline(always)]
    fn step<S: Simd>(
        &mut self,
        simd: S,
        motors: &Motors,
        (i, runs): (usize, usize),
        (q, qd): (&Runs, &Runs),
        tau: &mut Runs,
        fresh: bool,
    ) {
        let mut far = true;
        self.before = self.current;
        for first in (0..runs).step_by(S::F64_LANES) {
            let at = if self.encoder.noise > 0.0 {
                load(simd, q, first) + load(simd, &self.position_noise, first)
            } else {
                load(simd, q, first)
            };
            let measured = self.encoder.reading(at, load(simd, &self.grid, first));
            let (last_error, rate, integral) =
                (load(simd, &self.last_error, first), load(simd, &self.rate, first), load(simd, &self.integral, first));
            let mut memory = PidMemory { last_error, rate, integral };
            let decision = self.pid.step(&mut memory, load(simd, &self.command, first), measured, fresh);
            far &= motors.is_far_below(i, load(simd, qd, first), decision.current);
            store(&mut self.measured, first, measured);
            store(&mut self.last_error, first, memory.last_error);
            store(&mut self.rate, first, memory.rate);
            store(&mut self.integral, first, memory.integral);
            store(&mut self.current, first, decision.current);
        }
        if !far {
            // Of a run that has ended the plant may have no number left.
            for run in (0..runs).filter(|&run| qd[run].is_finite()) {
                self.current[run] = motors.held(i, qd[run], self.current[run]);
            }
        }
        if fresh {
            self.before = self.current;
        }
        for first in (0..runs).step_by(S::F64_LANES) {
            let current = load(simd, &self.current, first);
            store(tau, first, current.splat(self.per_ampere) * current);
            let mean = current.splat(0.5) * (load(simd, &self.before, first) + current);
            let noisy = if self.meter.noise > 0.0 { mean + load(simd, &self.current_noise, first) } else { mean };
            store(&mut self.effort, first, current.splat(self.reported) * self.meter.converted(noisy));
        }
    }
}
