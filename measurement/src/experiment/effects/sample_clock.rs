//! Samples that are not taken when their stamp says, or not at all.
//!
//! ```text
//! sample k is stamped k/f and taken at k/f + ε_k, ε_k ~ N(0, σ²), |ε_k| ≤ half a servo step
//! q̂(k/f + ε) = q + ε q̇        î = (½ − ε/Δ) i_before + (½ + ε/Δ) i_after        Δ the servo step
//! ```
//! The servo's own clock is right: only what is recorded is off. A sample gets lost with probability `p`, by itself; in
//! its place stands the one before, as a logger without sequence numbers would write it. A recording has no gaps, and its
//! stamps are those of the ideal clock: they do not show which samples these are.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use crate::seed::{RunNoise, Stream};

/// The clock of one run's samples.
#[derive(Clone, Debug)]
pub(in crate::experiment) struct SampleClock {
    jitter_s: f64,
    most_s: f64,
    lost: f64,
    jitter: Stream,
    loss: Stream,
    fresh: bool,
    /// 1, or −1 in a run with opposite noise.
    sign: f64,
}

impl SampleClock {
    pub(super) fn new(jitter_s: f64, lost: f64, servo_step_s: f64, run: RunNoise) -> Self {
        let (jitter, loss) = (run.stream("clock jitter"), run.stream("dropped samples"));
        Self { jitter_s, most_s: 0.5 * servo_step_s, lost, jitter, loss, fresh: true, sign: run.sign() }
    }

    /// How late the next sample is taken, s.
    pub(in crate::experiment) fn lateness(&mut self) -> f64 {
        if self.jitter_s == 0.0 {
            return 0.0;
        }
        let z: f64 = StandardNormal.sample(&mut self.jitter);
        (self.sign * self.jitter_s * z).clamp(-self.most_s, self.most_s)
    }

    /// Whether the next sample is lost; the first never is.
    pub(in crate::experiment) fn loses(&mut self) -> bool {
        let lost = self.lost > 0.0 && self.loss.random::<f64>() < self.lost;
        !std::mem::replace(&mut self.fresh, false) && lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    #[test]
    fn analytic_lateness_and_losses_have_their_rates() {
        let mut clock = SampleClock::new(1e-4, 0.02, 1e-3, Seed::new(1).of_run(0));
        assert!(!clock.loses());
        let count = 20_000;
        let square: f64 = (0..count).map(|_| clock.lateness().powi(2)).sum();
        // χ² with 20 000 degrees of freedom: 0.5 % of σ; 4 of them.
        assert!(((square / f64::from(count)).sqrt() / 1e-4 - 1.0).abs() < 0.02);
        let lost = (0..count).filter(|_| clock.loses()).count();
        // Binomial: 400 ± 20; 4 of them.
        assert!((320..=480).contains(&lost), "{lost}");
    }
}
