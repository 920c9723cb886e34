//! What an arm is asked to do: a periodic motion with everything around it.
//!
//! ```text
//! settle → ramp in → discarded periods → P recorded periods → ramp out
//! ```
//! The ramps run the same path as the periodic motion, at a speed that rises smoothly: with `u = t / T_ramp`
//!
//! ```text
//! q(t) = r(σ(t))    σ̇ = 10u³ − 15u⁴ + 6u⁵    σ = T_ramp (5/2 u⁴ − 3u⁵ + u⁶ − 1/2)
//! q̇ = r′ σ̇          q̈ = r″ σ̇² + r′ σ̈         σ̈ = 30 u² (1 − u)² / T_ramp
//! ```
//! so it starts at rest at `r(−T_ramp/2)` and arrives at phase 0 with the motion's own position, velocity and
//! acceleration; the ramp out is its mirror image. Position limits and clearances hold because the path is the
//! trajectory's; speed limits because `σ̇ ≤ 1`; acceleration may exceed the trajectory's by `15/8 · |r′| / T_ramp` at
//! most, where `σ̇² = 1/4`, which [`ExperimentPlan::check_limits`] looks at sample by sample.

use std::ops::Range;

use super::{Phase, PhaseSpan};
use crate::excitation::PeriodicTrajectory;
use crate::model::Robot;

/// An experiment: which motion, how often, how it begins and ends, and how fast it is sampled.
///
/// ```
/// use armid::experiment::{ExperimentPlan, Phase};
/// use armid::excitation::{FourierJoint, FourierTrajectory};
/// let joint = FourierJoint { name: "hinge".into(), a: vec![0.3], b: vec![0.1], q0: 0.2 };
/// let plan = ExperimentPlan::new(FourierTrajectory { period_s: 2.0, joints: vec![joint] });
/// let layout = plan.layout().unwrap();
/// assert_eq!(layout.period_samples, 2000);
/// assert_eq!(layout.span(Phase::Record).len(), plan.periods * 2000);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ExperimentPlan {
    /// The periodic motion.
    pub trajectory: PeriodicTrajectory,
    /// Samples per second that are recorded, Hz; the period must hold a whole number of them.
    pub rate_hz: f64,
    /// Time at rest before the motion, s.
    pub settle_s: f64,
    /// Length of each ramp, s.
    pub ramp_s: f64,
    /// Periods thrown away before those that count.
    pub discarded_periods: usize,
    /// Periods that count.
    pub periods: usize,
}

/// Why a plan cannot be performed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A number is outside what is possible.
    #[error("{quantity} is {found}, expected {expected}")]
    Quantity {
        /// Which quantity, with its unit.
        quantity: &'static str,
        /// What was found.
        found: f64,
        /// What is possible.
        expected: &'static str,
    },
    /// A period does not hold a whole number of samples.
    #[error("a period of {period_s} s holds {samples} samples at {rate_hz} Hz, expected a whole number")]
    PeriodNotWhole {
        /// Length of the period, s.
        period_s: f64,
        /// Sampling rate, Hz.
        rate_hz: f64,
        /// Samples in a period.
        samples: f64,
    },
    /// The trajectory has another number of joints than the robot.
    #[error("the trajectory moves {found} joints, expected the robot's {expected}")]
    Dof {
        /// Joints of the trajectory.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// The commanded motion leaves a limit of the robot.
    #[error("joint \"{joint}\": {quantity} {found:.4} {unit} exceeds its limit {limit:.4} {unit} at t = {t:.3} s ({})", phase.name())]
    Limit {
        /// Name of the joint.
        joint: String,
        /// Position, speed or acceleration.
        quantity: &'static str,
        /// What is commanded.
        found: f64,
        /// What is allowed.
        limit: f64,
        /// Unit of both.
        unit: String,
        /// Time since the beginning of the experiment, s.
        t: f64,
        /// In which phase.
        phase: Phase,
    },
}

/// Which samples belong to which phase of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// All five phases in order; the first begins at sample 0, each begins where the one before ends.
    pub spans: Vec<PhaseSpan>,
    /// Samples in one period of the motion.
    pub period_samples: usize,
}

impl Layout {
    /// The samples of one phase.
    #[must_use]
    pub fn span(&self, phase: Phase) -> Range<usize> {
        self.spans.iter().find(|span| span.phase == phase).map_or(0..0, |span| span.samples.clone())
    }

    /// All samples.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.spans.last().map_or(0, |span| span.samples.end)
    }

    /// The phase of one sample; beyond the last one it is the last phase.
    #[must_use]
    pub fn phase(&self, sample: usize) -> Phase {
        self.spans.iter().find(|span| span.samples.contains(&sample)).map_or(Phase::RampOut, |span| span.phase)
    }
}

impl ExperimentPlan {
    /// The usual experiment around a motion: 1 kHz, settle 1 s, ramps of 2 s, 1 period discarded, 10 recorded.
    #[must_use]
    pub fn new(trajectory: impl Into<PeriodicTrajectory>) -> Self {
        Self {
            trajectory: trajectory.into(),
            rate_hz: 1000.0,
            settle_s: 1.0,
            ramp_s: 2.0,
            discarded_periods: 1,
            periods: 10,
        }
    }

    /// The same plan with another number of recorded periods.
    #[must_use]
    pub fn with_periods(mut self, periods: usize) -> Self {
        self.periods = periods;
        self
    }

    /// The same path at `part` of the speed, for first runs: the motion's period grows, ramps and settling stay.
    #[must_use]
    pub fn at_speed(mut self, part: f64) -> Self {
        self.trajectory = self.trajectory.at_speed(part);
        self
    }

    /// Which samples belong to which phase. Settling time and ramps are rounded up to whole samples.
    ///
    /// # Errors
    /// [`PlanError::Quantity`] where a number is impossible, [`PlanError::PeriodNotWhole`] where a period is no whole
    /// number of samples.
    pub fn layout(&self) -> Result<Layout, PlanError> {
        let quantity = |quantity, found: f64, expected| Err(PlanError::Quantity { quantity, found, expected });
        let period_s = self.trajectory.period_s();
        if !(self.rate_hz.is_finite() && self.rate_hz > 0.0) {
            return quantity("rate_hz", self.rate_hz, "a finite number above zero");
        }
        if !(period_s.is_finite() && period_s > 0.0) {
            return quantity("period_s", period_s, "a finite number above zero");
        }
        if !(self.settle_s.is_finite() && self.settle_s >= 0.0) {
            return quantity("settle_s", self.settle_s, "a finite number not below zero");
        }
        if !(self.ramp_s.is_finite() && self.ramp_s > 0.0) {
            return quantity("ramp_s", self.ramp_s, "a finite number above zero");
        }
        if self.periods == 0 {
            return quantity("periods", 0.0, "at least 1");
        }
        let samples = period_s * self.rate_hz;
        if (samples - samples.round()).abs() > 1e-9 * samples || samples < 1.0 {
            return Err(PlanError::PeriodNotWhole { period_s, rate_hz: self.rate_hz, samples });
        }
        let period_samples = samples.round() as usize;
        // A thousandth of a sample of slack: 0.3 s at 1 kHz is 300 samples although 0.3 · 1000 is a little above.
        let whole = |seconds: f64| (seconds * self.rate_hz - 1e-3).ceil().max(0.0) as usize;
        let ramp = whole(self.ramp_s).max(1);
        let lengths = [
            (Phase::Settle, whole(self.settle_s)),
            (Phase::RampIn, ramp),
            (Phase::Discard, self.discarded_periods * period_samples),
            (Phase::Record, self.periods * period_samples),
            (Phase::RampOut, ramp),
        ];
        let mut begin = 0;
        let spans = lengths
            .into_iter()
            .map(|(phase, length)| {
                let samples = begin..begin + length;
                begin += length;
                PhaseSpan { phase, samples }
            })
            .collect();
        Ok(Layout { spans, period_samples })
    }

    /// How long the whole experiment takes, s.
    ///
    /// # Errors
    /// As [`ExperimentPlan::layout`].
    pub fn duration_s(&self) -> Result<f64, PlanError> {
        Ok(self.layout()?.samples() as f64 / self.rate_hz)
    }

    /// Checks that the plan can be performed on a robot with `dof` joints.
    ///
    /// # Errors
    /// [`PlanError`] with what was found and what is possible.
    pub fn check(&self, dof: usize) -> Result<Layout, PlanError> {
        let found = self.trajectory.dof();
        if found != dof {
            return Err(PlanError::Dof { found, expected: dof });
        }
        self.layout()
    }

    /// Checks that the commanded motion, ramps included, stays inside the robot's position, speed and acceleration
    /// limits at every sample.
    ///
    /// # Errors
    /// [`PlanError::Limit`] for the first sample that leaves one, or as [`ExperimentPlan::check`].
    pub fn check_limits(&self, robot: &Robot) -> Result<(), PlanError> {
        let layout = self.check(robot.dof())?;
        let command = super::Command::new(self, &layout);
        let (ramp_in, ramp_out) = (layout.span(Phase::RampIn), layout.span(Phase::RampOut));
        // One period stands for all of them.
        let periodic = ramp_in.end..ramp_in.end + layout.period_samples;
        let n = robot.dof();
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in ramp_in.chain(periodic).chain(ramp_out) {
            let t = k as f64 / self.rate_hz;
            command.evaluate(t, &mut q, &mut qd, &mut qdd);
            for (i, joint) in robot.joints().iter().enumerate() {
                let limits = &joint.limits;
                let (low, high) = limits.position;
                let unit = joint.kind.unit();
                let broken = if q[i] < low {
                    Some(("position", q[i], low, unit.to_owned()))
                } else if q[i] > high {
                    Some(("position", q[i], high, unit.to_owned()))
                } else if qd[i].abs() > limits.velocity {
                    Some(("speed", qd[i].abs(), limits.velocity, format!("{unit}/s")))
                } else if qdd[i].abs() > limits.acceleration {
                    Some(("acceleration", qdd[i].abs(), limits.acceleration, format!("{unit}/s²")))
                } else {
                    None
                };
                if let Some((quantity, found, limit, unit)) = broken {
                    let joint = joint.name.clone();
                    return Err(PlanError::Limit { joint, quantity, found, limit, unit, t, phase: layout.phase(k) });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Command, hinges};

    fn plan() -> ExperimentPlan {
        ExperimentPlan { settle_s: 0.3, ramp_s: 0.8, periods: 2, ..ExperimentPlan::new(hinges::trajectory(2)) }
    }

    #[test]
    fn analytic_layout_counts_samples() {
        let layout = plan().layout().unwrap();
        let lengths: Vec<usize> = layout.spans.iter().map(|span| span.samples.len()).collect();
        assert_eq!(lengths, [300, 800, 2000, 4000, 800]);
        assert_eq!(layout.samples(), 7900);
        assert_eq!(
            (layout.phase(0), layout.phase(1100), layout.phase(3100)),
            (Phase::Settle, Phase::Discard, Phase::Record)
        );
    }

    #[test]
    fn impossible_numbers_are_named() {
        for (broken, word) in [
            (ExperimentPlan { rate_hz: 0.0, ..plan() }, "rate_hz"),
            (ExperimentPlan { ramp_s: 0.0, ..plan() }, "ramp_s"),
            (ExperimentPlan { settle_s: f64::NAN, ..plan() }, "settle_s"),
            (ExperimentPlan { periods: 0, ..plan() }, "periods"),
            (ExperimentPlan { rate_hz: 333.3, ..plan() }, "666.6"),
        ] {
            let message = broken.layout().unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
        assert!(matches!(plan().check(3), Err(PlanError::Dof { found: 2, expected: 3 })));
    }

    #[test]
    fn analytic_command_is_continuous_to_the_second_derivative_and_starts_and_ends_at_rest() {
        let plan = plan();
        let layout = plan.layout().unwrap();
        let command = Command::new(&plan, &layout);
        let at = |t: f64| {
            let mut state = [[0.0; 2]; 3];
            let [q, qd, qdd] = &mut state;
            command.evaluate(t, q, qd, qdd);
            state
        };
        let joints =
            [layout.span(Phase::RampIn).start, layout.span(Phase::Discard).start, layout.span(Phase::RampOut).start];
        for seam in joints.iter().map(|&k| k as f64 * 1e-3).chain([layout.samples() as f64 * 1e-3]) {
            let (before, after) = (at(seam - 1e-7), at(seam + 1e-7));
            for (x, y) in before.iter().flatten().zip(after.iter().flatten()) {
                // 2e-7 s of a motion whose jerk stays below 100 rad/s³.
                assert!((x - y).abs() < 2e-5, "{x} {y} at {seam}");
            }
        }
        for end in [at(0.0), at(1e9)] {
            assert_eq!((end[1], end[2]), ([0.0; 2], [0.0; 2]));
        }
        // Inside the ramps, velocity and acceleration are the derivatives of position.
        for t in [0.35, 0.6, 0.93, 7.2, 7.6] {
            let h = 1e-4;
            let (low, mid, high) = (at(t - h), at(t), at(t + h));
            for i in 0..2 {
                assert!(((high[0][i] - low[0][i]) / (2.0 * h) - mid[1][i]).abs() < 1e-6);
                assert!(((high[1][i] - low[1][i]) / (2.0 * h) - mid[2][i]).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn limits_hold_or_the_first_break_is_named() {
        let robot = hinges::coupled();
        assert_eq!(plan().check_limits(&robot), Ok(()));
        let mut series = hinges::trajectory(2);
        series.joints[1].a[0] = 4.0;
        let fast = ExperimentPlan { trajectory: series.into(), ..plan() };
        let message = fast.check_limits(&robot).unwrap_err().to_string();
        assert!(
            message.contains("hinge2") && message.contains("exceeds its limit 12.0000 rad/s² at t = 0.8"),
            "{message}"
        );
        // A hurried ramp asks for more acceleration than the motion itself.
        let hurried = ExperimentPlan { ramp_s: 0.05, ..plan() };
        let fault = hurried.check_limits(&robot).unwrap_err();
        assert!(matches!(fault, PlanError::Limit { quantity: "acceleration", phase: Phase::RampIn, .. }), "{fault}");
    }
}
