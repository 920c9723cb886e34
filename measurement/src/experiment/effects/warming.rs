//! The temperature of a gear.
//!
//! ```text
//! T ẇ = P/P_w − w       P = |τ_friction q̇|       P_w = (Fc + Fv v_w) v_w
//! ```
//! `w` is the normalised temperature rise, 0 at the beginning of the experiment and 1 for a gear that has long turned
//! at `v_w`, a quarter of its speed limit. T = 300 s. Viscosity of grease falls with temperature; share, speed and time
//! constant are assumed, of the size that L. Simoni et al., "Friction modeling with temperature effects", IROS 2015,
//! measured on industrial arms.

use crate::excitation::WarmGear;

/// Time in which a gear warms up, s.
const TIME_S: f64 = 300.0;

/// Share of the speed v_w that counts as standstill where a drive does not say at what speed its friction turns.
const STANDSTILL: f64 = 0.01;

/// v_w, rad/s or m/s.
fn rated_speed(limit: f64) -> f64 {
    if limit.is_finite() { 0.25 * limit } else { 1.0 }
}

/// Normalised temperature rise of one gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Warming {
    viscous: f64,
    coulomb: f64,
    per_power: f64,
    warmth: f64,
}

impl Warming {
    /// A cold gear with this friction (N·m·s/rad, N·m) and speed limit.
    pub(super) fn new(viscous: f64, coulomb: f64, speed_limit: f64) -> Self {
        let v = rated_speed(speed_limit);
        let power = (coulomb + viscous * v) * v;
        let per_power = if power > 0.0 { 1.0 / power } else { 0.0 };
        Self { viscous, coulomb, per_power, warmth: 0.0 }
    }

    /// The gear as a design expects it, of which a warm one has lost so much viscous friction, in the first minute of a motion.
    pub(super) fn expected(&self, lost: f64, speed_limit: f64, fade: f64) -> WarmGear {
        let minute = 60.0 / TIME_S;
        let mean = 1.0 - (1.0 - libm::exp(-minute)) / minute;
        let fade = if fade > 0.0 { fade } else { STANDSTILL * rated_speed(speed_limit) };
        let Self { viscous, coulomb, per_power, .. } = *self;
        WarmGear { viscous, coulomb, fade, rise_per_watt: mean * per_power, lost }
    }

    /// Its normalised temperature rise, 0 cold to 1.
    pub(super) fn warmth(&self) -> f64 {
        self.warmth.min(1.0)
    }

    /// Turns at speed `v` for `dt` s.
    pub(super) fn turn(&mut self, v: f64, dt: f64) {
        if self.per_power == 0.0 {
            return;
        }
        let power = (self.coulomb + self.viscous * v.abs()) * v.abs();
        self.warmth += (power * self.per_power - self.warmth) * (dt / TIME_S);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_warmth_rises_exponentially_at_constant_speed() {
        let mut gear = Warming::new(5.0, 4.0, 4.0);
        for _ in 0..300_000 {
            gear.turn(1.0, 1e-3);
        }
        // After one time constant 1 − 1/e; Euler's error is dt/2T of it.
        let expected = 1.0 - (-1.0_f64).exp();
        assert!((gear.warmth() - expected).abs() < 5e-6, "{}", gear.warmth());
        // Over the first minute the mean is that of the law that a design expects.
        let (mut young, mut sum) = (Warming::new(5.0, 4.0, 4.0), 0.0);
        for _ in 0..60_000 {
            young.turn(0.5, 1e-3);
            sum += young.warmth() / 60_000.0;
        }
        let expected = young.expected(2.0, 4.0, 0.0);
        assert!(
            (sum - expected.rise_per_watt * (4.0 + 5.0 * 0.5) * 0.5).abs() < 1e-5 && expected.fade == 0.01,
            "{sum}"
        );
        // Long at rest it is cold again.
        for _ in 0..10_000 {
            gear.turn(0.0, 1.0);
        }
        assert!(gear.warmth() < 1e-12);
    }
}
