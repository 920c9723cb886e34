//! The friction of one joint or motor with everything that a straight line of speed leaves out.

use super::EffectKind as Kind;
use super::Effects;
use super::warming::Warming;
use super::{load_friction, stribeck};
use crate::model::smooth_sign;

/// Coulomb and viscous friction of one coordinate, and its effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GearFriction {
    coulomb: f64,
    viscous: f64,
    coulomb_velocity: f64,
    stribeck: f64,
    per_load: f64,
    warming: Warming,
}

impl GearFriction {
    /// Friction of a coordinate with these parameters (N·m, N·m·s/rad) on an arm with these effects.
    pub(super) fn new(
        effects: &Effects,
        (coulomb, viscous): (f64, f64),
        (coulomb_velocity, speed_limit): (f64, f64),
    ) -> Self {
        Self {
            coulomb,
            viscous,
            coulomb_velocity,
            stribeck: effects.magnitude(Kind::Stribeck),
            // Load makes friction where there is any.
            per_load: if coulomb > 0.0 { effects.magnitude(Kind::LoadFriction) } else { 0.0 },
            warming: Warming::new(effects.magnitude(Kind::Warming), viscous, coulomb, speed_limit),
        }
    }

    /// Friction beyond the identification model's at speed `v` under a transmitted torque, N·m.
    pub(super) fn excess(&self, v: f64, load: f64) -> f64 {
        let mut excess = self.warming.excess(v);
        if self.stribeck > 0.0 {
            excess += stribeck::excess(self.stribeck, self.coulomb, v, self.coulomb_velocity);
        }
        if self.per_load > 0.0 {
            excess += load_friction::excess(self.per_load, load, v, self.coulomb_velocity);
        }
        excess
    }

    /// All friction, N·m.
    pub(super) fn whole(&self, v: f64, load: f64) -> f64 {
        self.viscous * v + self.coulomb * smooth_sign(v, self.coulomb_velocity) + self.excess(v, load)
    }

    /// Steepest slope of the excess alone, N·m·s/rad, under a load of at most `load`.
    pub(super) fn excess_slope(&self, load: f64) -> f64 {
        let height = self.stribeck * self.coulomb + self.per_load * load;
        if height > 0.0 { height / self.coulomb_velocity } else { 0.0 }
    }

    /// Steepest slope of all friction, N·m·s/rad.
    pub(super) fn slope(&self, load: f64) -> f64 {
        let own = if self.coulomb > 0.0 { self.coulomb / self.coulomb_velocity } else { 0.0 };
        self.viscous + own + self.excess_slope(load)
    }

    /// Warms up at speed `v` for `dt` s.
    pub(super) fn turn(&mut self, v: f64, dt: f64) {
        self.warming.turn(v, dt);
    }
}
