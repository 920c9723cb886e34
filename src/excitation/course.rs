//! Every instant of an experiment as an instant of the periodic motion: the ramps run the same path at another speed.
//!
//! ```text
//! q(t) = r(σ)      q̇ = r′ σ̇      q̈ = r″ σ̇² + r′ σ̈        σ̇ = 10u³ − 15u⁴ + 6u⁵,   u = t / T_ramp on the ramp in
//! ```
//! On the period itself σ̇ = 1 and σ̈ = 0. So everything that is linear in the coefficients of the motion stays linear
//! on the ramps.

use std::f64::consts::TAU;

/// Time on the path, its rate and the rate of that, at the part `u` of a ramp of `span` s that rises from rest:
/// `σ − σ(1)` in s, σ̇, and σ̈ in 1/s.
#[must_use]
pub fn rise(u: f64, span: f64) -> (f64, f64, f64) {
    let u = u.clamp(0.0, 1.0);
    let cube = u * u * u;
    let travelled = cube * u * (2.5 - 3.0 * u + u * u);
    let rest = (1.0 - u) * (1.0 - u);
    (span * (travelled - 0.5), cube * (10.0 - 15.0 * u + 6.0 * u * u), 30.0 * u * u * rest / span)
}

/// One part of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stretch {
    /// The periodic motion.
    Period,
    /// From rest into it.
    RampIn,
    /// Back to rest.
    RampOut,
}

/// An instant of an experiment, as an instant of the motion and the speed at which it is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Phase ωσ of the motion, rad.
    pub phase: f64,
    /// Speed σ̇ at which the path is run; 1 on the period.
    pub rate: f64,
    /// Its rate σ̈, 1/s.
    pub growth: f64,
}

impl Instant {
    /// Weights of the motion's position, velocity and acceleration in a quantity whose weights on the commanded ones
    /// are given.
    #[must_use]
    pub fn weights(&self, [q, qd, qdd]: [f64; 3]) -> [f64; 3] {
        [q, self.rate * qd + self.growth * qdd, self.rate * self.rate * qdd]
    }
}

/// The stretches of an experiment around a motion of one period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// Period of the motion, s.
    pub period_s: f64,
    /// Length of each ramp, s; without it only the period counts.
    pub ramp_s: Option<f64>,
}

impl Course {
    /// The stretches that count.
    #[must_use]
    pub fn stretches(&self) -> &'static [Stretch] {
        match self.ramp_s {
            Some(_) => &[Stretch::Period, Stretch::RampIn, Stretch::RampOut],
            None => &[Stretch::Period],
        }
    }

    /// Length of a stretch, s.
    #[must_use]
    pub fn length_s(&self, stretch: Stretch) -> f64 {
        match stretch {
            Stretch::Period => self.period_s,
            Stretch::RampIn | Stretch::RampOut => self.ramp_s.unwrap_or(0.0),
        }
    }

    /// Samples of a stretch, where the period has `samples`: as dense, and at least eight.
    #[must_use]
    pub fn samples(&self, stretch: Stretch, samples: usize) -> usize {
        match stretch {
            Stretch::Period => samples,
            _ => ((samples as f64 * self.length_s(stretch) / self.period_s).ceil() as usize).max(8),
        }
    }

    /// The instant after the part `part` of a stretch, from 0 to 1.
    #[must_use]
    pub fn instant(&self, stretch: Stretch, part: f64) -> Instant {
        let omega = TAU / self.period_s;
        let span = self.length_s(stretch);
        match stretch {
            Stretch::Period => Instant { phase: TAU * part, rate: 1.0, growth: 0.0 },
            Stretch::RampIn => {
                let (sigma, rate, growth) = rise(part, span);
                Instant { phase: omega * sigma, rate, growth }
            }
            Stretch::RampOut => {
                let (sigma, rate, growth) = rise(1.0 - part, span);
                Instant { phase: -omega * sigma, rate, growth: -growth }
            }
        }
    }

    /// The rate of σ̈ at that instant, 1/s²: what jerk has beside velocity and acceleration.
    #[must_use]
    pub fn burst(&self, stretch: Stretch, part: f64) -> f64 {
        let span = self.length_s(stretch);
        let u = match stretch {
            Stretch::Period => return 0.0,
            Stretch::RampIn => part,
            Stretch::RampOut => 1.0 - part,
        };
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (span * span)
    }

    /// The time of that instant, s, where 0 is the beginning of the first period: negative on the ramp in, beyond the
    /// period on the ramp out.
    #[must_use]
    pub fn time_s(&self, stretch: Stretch, part: f64) -> f64 {
        match stretch {
            Stretch::Period => part * self.period_s,
            Stretch::RampIn => (part - 1.0) * self.length_s(stretch),
            Stretch::RampOut => self.period_s + part * self.length_s(stretch),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_ramps_join_the_period_and_begin_at_rest() {
        let course = Course { period_s: 10.0, ramp_s: Some(2.0) };
        let begin = course.instant(Stretch::RampIn, 0.0);
        assert_eq!((begin.rate, begin.growth), (0.0, 0.0));
        assert!((begin.phase + TAU / 10.0).abs() < 1e-15);
        for seam in [course.instant(Stretch::RampIn, 1.0), course.instant(Stretch::RampOut, 0.0)] {
            assert_eq!((seam.phase.abs(), seam.rate, seam.growth.abs()), (0.0, 1.0, 0.0));
        }
        // σ̇ is the derivative of σ, σ̈ that of σ̇.
        for part in [0.2, 0.5, 0.9] {
            let h = 1e-6;
            let (a, b) = (rise(part - h, 2.0), rise(part + h, 2.0));
            let here = rise(part, 2.0);
            assert!(((b.0 - a.0) / (4.0 * h) - here.1).abs() < 1e-9);
            assert!(((b.1 - a.1) / (4.0 * h) - here.2).abs() < 1e-9);
        }
        assert_eq!(course.samples(Stretch::RampOut, 200), 40);
    }
}
