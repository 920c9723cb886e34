//! The regressor of an arm whose base is carried about.

use nalgebra::Vector3;

use super::joint_torque::JointTorqueRegressor;
use crate::spatial::Motion;

/// A prescribed state of motion of the base, everything in the frame of the base.
///
/// The base's own equations are not part of the model: what moves it is strong enough. Its position does not matter, and
/// its orientation only through the direction of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseState {
    /// Spatial velocity `(ω, v)`, rad/s and m/s.
    pub velocity: Motion,
    /// Spatial acceleration `(ω̇, v̇)`, rad/s² and m/s², the component-wise rate of `velocity`; the base's origin then
    /// accelerates by `v̇ + ω × v`.
    pub acceleration: Motion,
    /// Gravity, m/s²; it turns as the base does.
    pub gravity: Vector3<f64>,
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
    /// # use armid_mechanics as armid;
    /// use armid::chains;
    /// use armid::model::Columns;
    /// use armid::regressor::{BaseState, JointTorqueRegressor};
    /// use armid::spatial::Motion;
    /// let robot = chains::planar_2r();
    /// let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID).unwrap();
    /// let (mut fixed, mut moving) = (vec![0.0; 40], vec![0.0; 40]);
    /// let (q, qd, qdd) = ([0.1, 0.2], [0.3, -0.4], [0.5, 0.6]);
    /// regressor.evaluate(&q, &qd, &qdd, &mut fixed);
    /// let base = BaseState { velocity: Motion::zero(), acceleration: Motion::zero(), gravity: robot.gravity() };
    /// regressor.with_base_motion(&base, &q, &qd, &qdd, &mut moving);
    /// assert_eq!(fixed, moving);
    /// ```
    ///
    /// # Panics
    /// If a slice is shorter than n, or `out` than n·p.
    pub fn with_base_motion(&self, base: &BaseState, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        let gravity = Motion::new(Vector3::zeros(), base.gravity);
        self.evaluate_from((base.velocity, base.acceleration - gravity), 0..self.rows(), q, qd, qdd, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{self, ChainRecipe};
    use crate::linalg::{RankRevealingQr, RankTolerance};
    use crate::model::{Columns, Robot, bundled, format::parse_robot};
    use crate::seed::Seed;
    use nalgebra::DMatrix;
    use rand::RngExt;

    fn a460() -> Robot {
        let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
        parse_robot(entry.robot).unwrap()
    }

    /// `W` over random states of the arm, with the base's state drawn by `base`.
    fn stacked(robot: &Robot, mut base: impl FnMut(&mut dyn FnMut() -> f64) -> BaseState) -> DMatrix<f64> {
        let regressor = JointTorqueRegressor::new(robot, Columns::RIGID).unwrap();
        let (n, p, samples) = (regressor.rows(), regressor.cols(), 60);
        let mut rng = Seed::new(31).stream("moving base", 0);
        let mut rows = Vec::new();
        for _ in 0..samples {
            let (q, qd, qdd) = chains::random_state(&mut rng, n);
            let state = base(&mut || rng.random_range(-2.0..2.0));
            let mut y = vec![0.0; n * p];
            regressor.with_base_motion(&state, &q, &qd, &qdd, &mut y);
            rows.extend(y);
        }
        DMatrix::from_row_slice(n * samples, p, &rows)
    }

    fn free(draw: &mut dyn FnMut() -> f64) -> BaseState {
        let mut vector = || Vector3::new(draw(), draw(), draw());
        BaseState {
            velocity: Motion::new(vector(), vector()),
            acceleration: Motion::new(vector(), vector()),
            gravity: vector().normalize() * 9.81,
        }
    }

    fn rank(w: &DMatrix<f64>) -> usize {
        RankRevealingQr::new(w, RankTolerance::default()).rank()
    }

    #[test]
    fn published_a460_on_a_free_base_has_rank_42_and_on_a_planar_base_38() {
        // Counts of an independent computation; `radkhah2007` hoped for 45.
        let robot = a460();
        let w = stacked(&robot, free);
        assert_eq!(rank(&w), 42);
        for (c, id) in Columns::RIGID.parameters(&robot).iter().enumerate().take(10) {
            let vanishes = w.column(c).amax() == 0.0;
            assert_eq!(vanishes, ["m1", "mcy1"].contains(&id.to_string().as_str()), "{id}");
        }
        // Ixx1 and Izz1 act by their difference alone: y of frame 1 lies along joint axis 1.
        let (xx, zz) = (w.column(4), w.column(9));
        assert!((xx + zz).amax() < 1e-12 * xx.amax());
        let planar = |draw: &mut dyn FnMut() -> f64| {
            let mut rates = || Motion::new(Vector3::new(0.0, 0.0, draw()), Vector3::new(draw(), draw(), 0.0));
            BaseState { velocity: rates(), acceleration: rates(), gravity: robot.gravity() }
        };
        assert_eq!(rank(&stacked(&robot, planar)), 38);
        let still = BaseState { velocity: Motion::zero(), acceleration: Motion::zero(), gravity: robot.gravity() };
        assert_eq!(rank(&stacked(&robot, |_| still)), 36);
    }

    #[test]
    fn identity_a_moving_base_is_a_longer_chain() {
        // The first two joints of a chain carry the rest of it: their motion is the base motion of the shorter arm.
        let mut rng = Seed::new(32).stream("chains", 0);
        for _ in 0..20 {
            let (robot, _) = ChainRecipe { tilted: true, ..ChainRecipe::new(6) }.draw(&mut rng);
            let (q, qd, qdd) = chains::random_state(&mut rng, 6);
            let whole = JointTorqueRegressor::new(&robot, Columns::RIGID).unwrap();
            let mut y = vec![0.0; 6 * 60];
            whole.evaluate(&q, &qd, &qdd, &mut y);
            let (mut velocity, mut acceleration) = (Motion::zero(), Motion::zero());
            let mut gravity = robot.gravity();
            for k in 0..2 {
                let x = robot.joints()[k].placement(q[k]);
                let rate = robot.axes()[k] * qd[k];
                velocity = x.motion_to_child(&velocity) + rate;
                acceleration = x.motion_to_child(&acceleration) + robot.axes()[k] * qdd[k] + velocity.cross(&rate);
                gravity = x.rotation.tr_mul(&gravity);
            }
            let carried = Robot::new(crate::model::RobotSpec {
                name: "carried".to_owned(),
                joints: robot.joints()[2..].to_vec(),
                ..crate::model::RobotSpec::default()
            })
            .unwrap();
            let short = JointTorqueRegressor::new(&carried, Columns::RIGID).unwrap();
            let mut found = vec![0.0; 4 * 40];
            let base = BaseState { velocity, acceleration, gravity };
            short.with_base_motion(&base, &q[2..], &qd[2..], &qdd[2..], &mut found);
            for i in 0..4 {
                for c in 0..40 {
                    let expected = y[(i + 2) * 60 + 20 + c];
                    assert!((found[i * 40 + c] - expected).abs() < 1e-12 * expected.abs().max(10.0));
                }
            }
        }
    }
}
