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

use super::layout::Layout;
use super::phase::{Phase, PhaseSpan};
use super::plan_error::PlanError;
use crate::input::size::{EXPERIMENT_SAMPLES, HELD_SAMPLES, PERIOD_S, PERIOD_SAMPLES, RATE_HZ};
use crate::trajectory::{PeriodicTrajectory, Timeline};

/// An experiment: which motion, how often, how it begins and ends, and how fast it is sampled.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::experiment::{ExperimentPlan, Phase};
/// use armid::trajectory::{FourierJoint, FourierTrajectory};
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

impl ExperimentPlan {
    /// The usual experiment around a motion: 1 kHz, settle 1 s, ramps of 2 s, 1 period discarded, 10 recorded.
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

    /// Returns this plan with another number of recorded periods.
    #[must_use]
    pub fn with_periods(mut self, periods: usize) -> Self {
        self.periods = periods;
        self
    }

    /// Returns this plan with its path at `part` of the speed, for first runs: the motion's period grows, ramps and settling stay.
    #[must_use]
    pub fn at_speed(mut self, part: f64) -> Self {
        self.trajectory = self.trajectory.at_speed(part);
        self
    }

    /// Which samples belong to which phase. Settling time and ramps are rounded up to whole samples.
    ///
    /// # Errors
    /// [`PlanError::Quantity`] where a number is impossible, [`PlanError::Size`] where one is larger than is
    /// allowed, [`PlanError::PeriodNotWhole`] where a period is no whole number of samples.
    pub fn layout(&self) -> Result<Layout, PlanError> {
        let holds = |quantity, found, holds: bool, expected| {
            if holds { Ok(()) } else { Err(PlanError::Quantity { quantity, found, expected }) }
        };
        let positive = |quantity, found: f64| {
            holds(quantity, found, found.is_finite() && found > 0.0, "a finite number above zero")
        };
        let (period_s, settle_s) = (self.trajectory.period_s(), self.settle_s);
        positive("rate_hz", self.rate_hz)?;
        positive("period_s", period_s)?;
        holds("settle_s", settle_s, settle_s.is_finite() && settle_s >= 0.0, "a finite number not below zero")?;
        positive("ramp_s", self.ramp_s)?;
        holds("periods", self.periods as f64, self.periods > 0, "at least 1")?;
        self.check_size()?;
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
        let span = |(phase, length): (Phase, usize)| {
            let samples = begin..begin + length;
            begin += length;
            PhaseSpan { phase, samples }
        };
        let spans = lengths.into_iter().map(span).collect();
        Ok(Layout { spans, period_samples })
    }

    /// Looks at how much is asked for, before anything is counted in whole samples.
    fn check_size(&self) -> Result<(), PlanError> {
        let period_s = self.trajectory.period_s();
        RATE_HZ.check("rate_hz", self.rate_hz)?;
        PERIOD_S.check("period_s", period_s)?;
        let period = period_s * self.rate_hz;
        PERIOD_SAMPLES.check("period_s by rate_hz", period)?;
        let periods = self.periods as f64 + self.discarded_periods as f64;
        EXPERIMENT_SAMPLES.check("settle_s by rate_hz", self.settle_s * self.rate_hz)?;
        EXPERIMENT_SAMPLES.check("ramp_s by rate_hz", self.ramp_s * self.rate_hz)?;
        EXPERIMENT_SAMPLES.check("periods by samples of one", periods * period)?;
        Ok(())
    }

    /// How many samples the experiment has, where all of them are to be held in memory.
    ///
    /// # Errors
    /// As [`ExperimentPlan::layout`], and [`PlanError::Size`] where they are too many for that.
    pub fn check_held(&self) -> Result<usize, PlanError> {
        let samples = self.layout()?.samples();
        HELD_SAMPLES.check_count("number of samples", samples)?;
        Ok(samples)
    }

    /// The ramps and the period as they are performed: what the commanded motion is evaluated on, and its limits verified.
    /// The ramps are those of the layout, in whole samples.
    pub fn timeline(&self, layout: &Layout) -> Timeline {
        let ramp = layout.span(Phase::RampIn);
        let at = |sample: usize| sample as f64 / self.rate_hz;
        Timeline { period_s: self.trajectory.period_s(), ramp_s: Some(at(ramp.end) - at(ramp.start)) }
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges;

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
            (ExperimentPlan { rate_hz: 1e9, ..plan() }, "rate_hz is 1000000000 Hz, expected at most 100000 Hz"),
            (ExperimentPlan { ramp_s: 1e300, ..plan() }, "ramp_s by rate_hz is 1e303, expected at most 1000000000"),
            (ExperimentPlan { settle_s: 1e15, ..plan() }, "settle_s by rate_hz is 1e18"),
            (ExperimentPlan { periods: usize::MAX, ..plan() }, "periods by samples of one is"),
            (ExperimentPlan { discarded_periods: usize::MAX, ..plan() }, "periods by samples of one is"),
        ] {
            let message = broken.layout().unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
        assert!(matches!(plan().check(3), Err(PlanError::Dof { found: 2, expected: 3 })));
    }
}
