//! The regressor of an arm whose base is carried about.

use nalgebra::Vector3;

use super::JointTorqueRegressor;
use crate::spatial::Motion;

/// A prescribed motion of the base, everything in the frame of the base.
///
/// The base's own equations are not part of the model: what moves it is strong enough. Its position does not matter, and
/// its orientation only through the direction of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseMotion {
    /// Spatial velocity `(ω, v)`, rad/s and m/s.
    pub velocity: Motion,
    /// Spatial acceleration `(ω̇, v̇)`, rad/s² and m/s², the component-wise rate of `velocity`; the base's origin then
    /// accelerates by `v̇ + ω × v`.
    pub acceleration: Motion,
    /// Gravity, m/s²; it turns as the base does.
    pub gravity: Vector3<f64>,
}

impl BaseMotion {
    /// A base at rest under this gravity, m/s².
    #[must_use]
    pub fn at_rest(gravity: Vector3<f64>) -> Self {
        Self { velocity: Motion::zero(), acceleration: Motion::zero(), gravity }
    }
}

impl JointTorqueRegressor {
    /// One sample on a base that moves: overwrites `out` with Y (n × p row-major), the joints' efforts only.
    ///
    /// ```text
    /// v_0 = base velocity        a_0 = base acceleration − (0, g)
    /// ```
    /// and the recursions as ever. A moving base reveals what a fixed one hides: on an arm with a vertical first axis,
    /// most of link 1.
    ///
    /// ```
    /// use armid::conformance::chains;
    /// use armid::model::Columns;
    /// use armid::regressor::{BaseMotion, JointTorqueRegressor};
    /// let robot = chains::planar_2r();
    /// let regressor = JointTorqueRegressor::new(&robot, Columns::Rigid);
    /// let (mut fixed, mut moving) = (vec![0.0; 40], vec![0.0; 40]);
    /// let (q, qd, qdd) = ([0.1, 0.2], [0.3, -0.4], [0.5, 0.6]);
    /// regressor.evaluate(&q, &qd, &qdd, &mut fixed);
    /// regressor.with_base_motion(&BaseMotion::at_rest(robot.gravity()), &q, &qd, &qdd, &mut moving);
    /// assert_eq!(fixed, moving);
    /// ```
    ///
    /// # Panics
    /// If a slice is shorter than n, or `out` than n·p.
    pub fn with_base_motion(&self, base: &BaseMotion, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        let gravity = Motion::new(Vector3::zeros(), base.gravity);
        self.evaluate_from((base.velocity, base.acceleration - gravity), q, qd, qdd, out);
    }
}
