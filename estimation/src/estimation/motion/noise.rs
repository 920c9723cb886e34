//! The errors of position, velocity and acceleration that the noise of positions makes.
//!
//! ```text
//! G_ab = ∫_0^B S(f) Re(H_a H_b*) df        S = 2 σ²/(P f_s) · |sin(πfD/f_s)/(D sin(πf/f_s))|²        H = 1, 2πif, −(2πf)²
//! ```
//! σ² is the variance of a raw sample of position, P the periods that were averaged, B the band that positions are kept in, D the samples
//! of one equation. The band is taken as sharp.

use nalgebra::{DMatrix, Matrix3};

use crate::dynamics::States;
use crate::estimation::error::EstimationError;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::linalg::BlockWhitening;
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;

/// Intervals of the quadrature over the band.
const INTERVALS: usize = 512;

/// Covariance of the error of (q, q̇, q̈) of the mean that makes an equation, for each joint.
pub(super) struct MotionNoise<'a> {
    pub(super) joints: Vec<Matrix3<f64>>,
    regressor: JointTorqueRegressor,
    samples: &'a Samples,
}

impl<'a> MotionNoise<'a> {
    /// `None` where the noise of positions or the noise of torque was not measured, or robot or samples are not there.
    pub(super) fn of(problem: &EstimationProblem<'a>) -> Option<Self> {
        let (samples, robot) = (problem.samples?, problem.robot?);
        let deviations = samples.position_noise.as_ref()?;
        problem.observation.noise.as_ref()?;
        let joints = deviations.iter().zip(&samples.position_band_hz).map(|(&std, &band)| spread(samples, std, band));
        let regressor = problem.observation.joint_regressor(robot);
        Some(Self { joints: joints.collect(), regressor, samples })
    }

    /// `(W(x + s e) − W(x − s e))/2s` for joint j and q, q̇ or q̈ (order 0 to 2), where s is the standard deviation of its error:
    /// what an error of that size does, also where a law of friction bends. Zero in rows that are no equation.
    pub(super) fn slope(&self, observation: &Observation, joint: usize, order: usize) -> DMatrix<f64> {
        let step = self.joints[joint][(order, order)].sqrt();
        let n = observation.dof;
        if step == 0.0 {
            return DMatrix::zeros(observation.y.len(), observation.regressor.ncols());
        }
        let stack = |side: f64| {
            let mut states: States = self.samples.states.clone();
            let moved = [&mut states.q, &mut states.qd, &mut states.qdd].into_iter().nth(order);
            for value in moved.into_iter().flat_map(|all| all.iter_mut().skip(joint).step_by(n)) {
                *value += side * step;
            }
            self.regressor_at(observation, &states)
        };
        (stack(1.0) - stack(-1.0)) / (2.0 * step)
    }

    /// W at these states, (n·M) × b; zero in rows that are no equation.
    fn regressor_at(&self, observation: &Observation, states: &States) -> DMatrix<f64> {
        let mut w = self.regressor.stack_means(states, &observation.base.kept, self.samples.block);
        for (row, _) in observation.used.iter().enumerate().filter(|(_, used)| !**used) {
            w.row_mut(row).fill(0.0);
        }
        w
    }

    /// `E Σ_k ΔW_kᵀ P ΔW_k`, b × b.
    pub(super) fn error_products(
        &self,
        observation: &Observation,
        weights: &BlockWhitening,
    ) -> Result<DMatrix<f64>, EstimationError> {
        let b = observation.regressor.ncols();
        let mut sum = DMatrix::zeros(b, b);
        for (joint, covariance) in self.joints.iter().enumerate() {
            if covariance.trace() == 0.0 {
                continue;
            }
            let white =
                |order| Ok(weights.clone().whiten(&self.slope(observation, joint, order), &observation.used)?);
            let slopes: Vec<DMatrix<f64>> = (0..3).map(white).collect::<Result<_, EstimationError>>()?;
            for a in 0..3 {
                for c in 0..3 {
                    if covariance[(a, c)] != 0.0 {
                        sum += crate::linalg::transpose_product(&slopes[a], &slopes[c]) * covariance[(a, c)];
                    }
                }
            }
        }
        Ok((&sum + sum.transpose()) * 0.5)
    }
}

/// G of one joint.
fn spread(samples: &Samples, std: f64, band_hz: f64) -> Matrix3<f64> {
    let (rate, block) = (samples.rate_hz, samples.block as f64);
    let band = band_hz.min(0.5 * rate);
    let density = 2.0 * std * std / (samples.periods as f64 * rate);
    let step = band / INTERVALS as f64;
    let mut powers = [0.0; 3];
    for k in 0..=INTERVALS {
        let f = k as f64 * step;
        let simpson = if k == 0 || k == INTERVALS {
            1.0
        } else if k % 2 == 1 {
            4.0
        } else {
            2.0
        };
        let phase = std::f64::consts::PI * f / rate;
        let mean = if phase == 0.0 { 1.0 } else { libm::sin(phase * block) / (block * libm::sin(phase)) };
        let omega = std::f64::consts::TAU * f;
        for (power, sum) in powers.iter_mut().enumerate() {
            *sum += simpson / 3.0 * step * density * mean * mean * omega.powi(2 * power as i32);
        }
    }
    let [q, qd, qdd] = powers;
    Matrix3::new(q, 0.0, -qd, 0.0, qd, 0.0, -qd, 0.0, qdd)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::chains::{random_robot, random_state};
    use crate::model::Columns;
    use crate::seed::Seed;

    #[test]
    fn analytic_white_noise_of_a_band() {
        let states = States::new(1);
        let mut samples = Samples::exact(states, Vec::new(), vec!["N·m".to_owned()], 100.0);
        samples.periods = 4;
        // σ²/P · B/(f_s/2) · (1, (2πB)²/3, (2πB)⁴/5).
        let (variance, omega) = (0.01 / 4.0 * 0.1, std::f64::consts::TAU * 5.0);
        let found = spread(&samples, 0.1, 5.0);
        assert!((found[(0, 0)] / variance - 1.0).abs() < 1e-12);
        assert!((found[(1, 1)] / (variance * omega * omega / 3.0) - 1.0).abs() < 1e-10);
        assert!((found[(2, 2)] / (variance * omega.powi(4) / 5.0) - 1.0).abs() < 1e-9);
        assert!((found[(0, 2)] + found[(1, 1)]).abs() < 1e-15 && found.cholesky().is_some());
        // Without a band, means over D samples of white noise have a D-th of its variance.
        samples.block = 5;
        assert!((spread(&samples, 0.1, 50.0)[(0, 0)] / (0.01 / 20.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn identity_slopes_of_polynomials_are_exact_differences_of_any_length() {
        // Without friction W is linear in the acceleration and of second degree in the speed.
        let mut rng = Seed::new(6).stream("slope", 0);
        let (robot, _) = random_robot(&mut rng, 2);
        let base = reduce(&robot, Columns::RIGID, Method::Structural, Seed::new(0)).unwrap();
        let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID).unwrap();
        let mut states = States::new(2);
        for _ in 0..12 {
            let (q, qd, qdd) = random_state(&mut rng, 2);
            states.push(&q, &qd, &qdd);
        }
        let mut samples = Samples::exact(states.clone(), vec![1.0; 24], vec!["N·m".to_owned(); 2], 100.0);
        samples.used[5] = false;
        let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
        let joints = vec![Matrix3::zeros(), Matrix3::from_diagonal(&nalgebra::Vector3::new(0.1, 0.04, 9.0))];
        let noise = MotionNoise { joints, regressor: observation.joint_regressor(&robot), samples: &samples };
        for order in [1, 2] {
            let moved = |by: f64| {
                let mut states = states.clone();
                let values = if order == 1 { &mut states.qd } else { &mut states.qdd };
                values.iter_mut().skip(1).step_by(2).for_each(|value| *value += by);
                regressor.stack_means(&states, &base.kept, 1)
            };
            let mut expected = (moved(1.0) - moved(-1.0)) * 0.5;
            expected.row_mut(5).fill(0.0);
            assert!(expected.norm() > 0.1 && (noise.slope(&observation, 1, order) - expected).norm() < 1e-9, "{order}");
        }
        assert_eq!(noise.slope(&observation, 0, 1).norm(), 0.0);
    }
}
