//! Random states that excite everything a robot can do: `radkhah2007` step 1.

use nalgebra::Vector3;
use rand::RngExt;

use super::geometry::Geometry;
use super::structural::BaseMotion;
use crate::dynamics::States;
use crate::model::JointKind;
use crate::regressor::BaseState;
use crate::seed::Stream;
use crate::spatial::Motion;

/// Rows of a stacked regressor for each of its columns. Three times as many rows as unknowns bring the condition number
/// of random columns close to its limit for infinitely many.
const ROWS_PER_COLUMN: usize = 3;

/// The least number of states, `radkhah2007`'s `N ≥ 10`.
pub(super) const LEAST_STATES: usize = 10;

impl Geometry {
    /// Independent states that a regressor of `columns` columns is stacked from: angles within ±π, rates within ±f,
    /// accelerations within ±f², with `f = √(g / length)` the frequency at which the arm's own motion weighs as much as
    /// gravity; limits do not matter to geometry.
    pub(super) fn random_states(&self, columns: usize, rng: &mut Stream) -> States {
        let f = self.frequency;
        let mut states = States::new(self.dof());
        for _ in 0..(ROWS_PER_COLUMN * columns).div_ceil(self.dof()).max(LEAST_STATES) {
            let mut draw = |bound: f64| -> Vec<f64> {
                (0..self.dof()).map(|i| self.coordinate_unit(i) * rng.random_range(-bound..bound)).collect()
            };
            let (mut q, qd, qdd) = (draw(1.0), draw(f), draw(f * f));
            for (q, kind) in q.iter_mut().zip(&self.kinds) {
                if *kind == JointKind::Revolute {
                    *q *= std::f64::consts::PI;
                }
            }
            states.push(&q, &qd, &qdd);
        }
        states
    }

    /// A random state of a base that moves as stated, its rates of the size of the joints'; `gravity` (m/s², in the frame
    /// of the base at rest) turns with it.
    pub(super) fn random_base_state(&self, motion: BaseMotion, gravity: &Vector3<f64>, rng: &mut Stream) -> BaseState {
        let f = self.frequency;
        let mut draw = |bound: f64| {
            motion.directions().iter().fold(Motion::zero(), |sum, direction| {
                let unit = if direction.ang == Vector3::zeros() { self.length } else { 1.0 };
                sum + *direction * (unit * rng.random_range(-bound..bound))
            })
        };
        let (velocity, acceleration) = (draw(f), draw(f * f));
        let mut turned = *gravity;
        let turns = motion.directions().into_iter().filter(|direction| direction.ang != Vector3::zeros());
        for turn in turns {
            // Rodrigues' formula about one axis after the other reaches every orientation that the base can take.
            let (s, c) = libm::sincos(rng.random_range(-std::f64::consts::PI..std::f64::consts::PI));
            let axis = turn.ang;
            turned = turned * c + axis.cross(&turned) * s + axis * (axis.dot(&turned) * (1.0 - c));
        }
        BaseState { velocity, acceleration, gravity: turned }
    }
}
