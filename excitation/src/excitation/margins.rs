//! Which part of each limit a design may use.

use crate::trajectory::Quantity;

/// Which part of each limit a design may use.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Margins {
    /// Of half the position range, about its middle.
    pub position: f64,
    /// Of the speed limit.
    pub velocity: f64,
    /// Of the acceleration limit.
    pub acceleration: f64,
    /// Of the torque rating.
    pub torque: f64,
}

impl Margins {
    /// The part for one quantity.
    pub const fn part(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Position => self.position,
            Quantity::Velocity => self.velocity,
            Quantity::Acceleration => self.acceleration,
        }
    }
}

impl Default for Margins {
    /// All of the limits that are known exactly, and nine tenths of the torque ratings: the parameters that torque is
    /// computed with are a guess.
    fn default() -> Self {
        Self { position: 1.0, velocity: 1.0, acceleration: 1.0, torque: 0.9 }
    }
}
