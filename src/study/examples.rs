//! Examples that the figures of a report show: a design against its limits, a measured torque against its prediction.

use super::design::StudyDesign;
use super::outcome::ScoredEstimate;
use super::setup::StudySetup;
use crate::dynamics::{Dynamics, States};
use crate::model::{Robot, StandardParameters};
use crate::signal::Samples;
use crate::trajectory::PeriodicTrajectory;
use nalgebra::DVector;

/// Samples of every example.
const SAMPLES: usize = 250;

/// The examples that the figures of a report show.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Examples {
    /// One design of each family against its limits.
    pub limits: Vec<LimitExample>,
    /// A validation experiment: torque measured and predicted.
    pub prediction: Option<PredictionExample>,
}

/// One design, every quantity over its limit: 1 is the limit.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LimitExample {
    /// Name of the family.
    pub family: String,
    /// Index of the design.
    pub design: usize,
    /// Time within the period, s.
    pub time_s: Vec<f64>,
    /// Position between its limits, −1 at the lower and 1 at the upper one: joint by joint, sample by sample.
    pub position: Vec<Vec<f64>>,
    /// Velocity over its limit.
    pub velocity: Vec<Vec<f64>>,
    /// Acceleration over its limit.
    pub acceleration: Vec<Vec<f64>>,
    /// Nominal torque over its rating.
    pub torque: Vec<Vec<f64>>,
}

impl LimitExample {
    /// One period of a trajectory against the limits of a robot; no samples of what has no limit, and none of torques
    /// without nominal parameters.
    pub fn new(robot: &Robot, nominal: Option<&StandardParameters>, trajectory: &PeriodicTrajectory) -> Self {
        let states = trajectory.sample(SAMPLES);
        let n = states.dof;
        let mut tau = vec![0.0; n * states.len()];
        if let Some(nominal) = nominal {
            let mut dynamics = Dynamics::new(robot, nominal);
            for (k, tau) in tau.chunks_exact_mut(n).enumerate() {
                dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
            }
        }
        let share = |values: &[f64], j: usize, middle: f64, limit: f64| -> Vec<f64> {
            let own = values.iter().skip(j).step_by(n).map(|value| (value - middle) / limit);
            if limit.is_finite() && middle.is_finite() { own.collect() } else { Vec::new() }
        };
        let mut example = Self { time_s: times(trajectory.period_s(), SAMPLES), ..Self::default() };
        for (j, limits) in robot.joints().iter().map(|joint| joint.limits).enumerate() {
            let (low, high) = limits.position;
            let rating = if nominal.is_some() { limits.torque } else { f64::INFINITY };
            example.position.push(share(&states.q, j, 0.5 * (low + high), 0.5 * (high - low)));
            example.velocity.push(share(&states.qd, j, 0.0, limits.velocity));
            example.acceleration.push(share(&states.qdd, j, 0.0, limits.acceleration));
            example.torque.push(share(&tau, j, 0.0, rating));
        }
        example
    }
}

/// Torque along a held-out trajectory.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PredictionExample {
    /// Name of the family whose design gave the estimate.
    pub family: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Time within the period, s.
    pub time_s: Vec<f64>,
    /// Measured torque, mean over the recorded periods, N·m: joint by joint, sample by sample.
    pub measured: Vec<Vec<f64>>,
    /// Predicted torque, N·m.
    pub predicted: Vec<Vec<f64>>,
    /// RMS of the difference, joint by joint, N·m.
    pub rms: Vec<f64>,
}

impl StudySetup {
    /// A design against its limits, with the torque of the nominal parameters.
    pub fn limit_example(&self, index: usize, design: &StudyDesign) -> LimitExample {
        let family = self.plan.designs[design.family].name.clone();
        let example = LimitExample::new(&self.robot, Some(&self.nominal), &design.trajectory);
        LimitExample { family, design: index, ..example }
    }

    /// Measured torque of a validation experiment beside what an estimate of `design` predicts for its states.
    pub fn prediction_example(
        &self,
        design: &StudyDesign,
        estimate: &ScoredEstimate,
        measured: &Samples,
    ) -> PredictionExample {
        let n = self.robot.dof();
        let beta = DVector::from_column_slice(&estimate.beta);
        let predicted = self.base.select_columns(&self.regressor.stack(&measured.states)) * beta;
        let by_joint = |values: &[f64]| -> Vec<Vec<f64>> {
            (0..n).map(|j| values.iter().skip(j).step_by(n).copied().collect()).collect()
        };
        let (measured_torque, predicted) = (by_joint(&measured.tau), by_joint(predicted.as_slice()));
        let rms = |(m, p): (&Vec<f64>, &Vec<f64>)| {
            let difference: Vec<f64> = m.iter().zip(p).map(|(a, b)| a - b).collect();
            crate::statistics::root_mean_square(&difference)
        };
        let rms = measured_torque.iter().zip(&predicted).map(rms).collect();
        PredictionExample {
            family: self.plan.designs[design.family].name.clone(),
            estimator: estimate.estimator.clone(),
            time_s: times(self.plan.experiment.period_s, measured.len()),
            measured: measured_torque,
            predicted,
            rms,
        }
    }
}

fn times(period_s: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| period_s * k as f64 / count as f64).collect()
}

/// The exact states of one period, as the scorer sees them: positions, velocities and held torques of the plant, and
/// the accelerations that the true parameters give them.
pub fn exact_states(dynamics: &mut Dynamics, q: &[f64], qd: &[f64], tau: &[f64]) -> States {
    let n = dynamics.dof();
    let mut states = States::new(n);
    let mut qdd = vec![0.0; n];
    for ((q, qd), tau) in q.chunks_exact(n).zip(qd.chunks_exact(n)).zip(tau.chunks_exact(n)) {
        dynamics.forward(q, qd, tau, &mut qdd);
        states.push(q, qd, &qdd);
    }
    states
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::chains;
    use crate::trajectory::table_one;

    #[test]
    fn analytic_shares_of_limits_are_those_of_table_one() {
        let robot = chains::crs_a460().with_joints(|joint| joint.limits.velocity = f64::INFINITY).unwrap();
        let trajectory: PeriodicTrajectory = table_one::corrected().into();
        let example = LimitExample::new(&robot, None, &trajectory);
        // What has no limit has no share, and torques are unknown without parameters.
        assert!(example.velocity.iter().chain(&example.torque).all(Vec::is_empty));
        for (j, joint) in robot.joints().iter().enumerate() {
            let (low, high) = joint.limits.position;
            let position = example.position[j][0] * 0.5 * (high - low) + 0.5 * (low + high);
            assert!((position - trajectory.sample(1).q(0)[j]).abs() < 1e-12);
            assert_eq!(example.acceleration[j].len(), example.time_s.len());
        }
    }
}
