//! Drive gains against the gains that simulated logs were made with.

use nalgebra::{DMatrix, DVector};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::base::{BaseReduction, Method, reduce};
use crate::chains::{random_inertia, random_robot, random_state};
use crate::dynamics::{Dynamics, States};
use crate::estimation::{
    DriveGains, EstimationError, EstimationProblem, EstimatorKind, GainMethod, Observation, drive_gains, gain_slopes,
};
use crate::model::{Columns, Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::{NoiseModel, Samples};
use crate::spatial::Inertia;

const GAINS: [f64; 3] = [1.1, 0.85, 1.02];

struct Arm {
    robot: Robot,
    regressor: JointTorqueRegressor,
    base: BaseReduction,
    truth: StandardParameters,
    load: Inertia,
    states: [States; 2],
}

impl Arm {
    fn new(seed: u64) -> Self {
        let seed = Seed::new(seed);
        let (robot, truth) = random_robot(&mut seed.stream("arm", 0), 3);
        let columns = Columns::RIGID_ROTOR_FRICTION;
        let base = reduce(&robot, columns, Method::Structural, seed).unwrap();
        let load = Inertia::from_array(&random_inertia(&mut seed.stream("load", 0)).to_array().map(|x| 3.0 * x));
        let states = [0, 1].map(|log| {
            let mut states = States::new(3);
            let mut rng = seed.stream("states", log);
            for _ in 0..150 {
                let (q, qd, qdd) = random_state(&mut rng, 3);
                states.push(&q, &qd, &qdd);
            }
            states
        });
        Self { regressor: JointTorqueRegressor::new(&robot, columns).unwrap(), robot, base, truth, load, states }
    }

    fn beta(&self) -> DVector<f64> {
        self.base.beta(&self.truth.vector(&self.robot, Columns::RIGID_ROTOR_FRICTION))
    }

    /// Logs without and with the load, each joint's noise a part of the torque's RMS.
    fn logs(&self, noise: f64, rng: &mut impl Rng) -> [Observation; 2] {
        [0, 1].map(|log| {
            let mut parameters = self.truth.clone();
            if log == 1 {
                let last = parameters.links.last_mut().unwrap();
                let sum: Vec<f64> = last.to_array().iter().zip(self.load.to_array()).map(|(a, b)| a + b).collect();
                *last = Inertia::from_array(&sum.try_into().unwrap());
            }
            let states = &self.states[log];
            let mut tau = vec![0.0; 3 * states.len()];
            let mut dynamics = Dynamics::new(&self.robot, &parameters);
            for (k, tau) in tau.chunks_exact_mut(3).enumerate() {
                dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
            }
            for i in 0..3 {
                let power: f64 = tau.iter().skip(i).step_by(3).map(|tau| tau * tau).sum();
                let sigma = noise * (power / states.len() as f64).sqrt();
                for tau in tau.iter_mut().skip(i).step_by(3) {
                    let z: f64 = StandardNormal.sample(rng);
                    *tau = (*tau + sigma * z) / GAINS[i];
                }
            }
            let samples = Samples::exact(states.clone(), tau, vec!["N·m".to_owned(); 3], 100.0);
            Observation::new(&self.robot, &self.regressor, &self.base, &samples).unwrap()
        })
    }

    fn find(&self, [without, with]: &[Observation; 2], method: GainMethod) -> DriveGains {
        drive_gains(without, with, &self.load, method).unwrap()
    }
}

#[test]
fn identity_exact_logs_give_the_gains_and_the_parameters() {
    let arm = Arm::new(61);
    let logs = arm.logs(0.0, &mut Seed::new(0).stream("noise", 0));
    for method in GainMethod::ALL {
        let found = arm.find(&logs, method);
        for (found, expected) in found.gains.iter().zip(GAINS) {
            assert!((found.value - expected).abs() < 1e-8, "{method:?}: {found:?}");
        }
        assert!((&found.beta - arm.beta()).norm() < 1e-7 * arm.beta().norm() && found.termination.was_successful());
    }
}

#[test]
fn analytic_intervals_cover_the_gains_of_two_arms() {
    for seed in [61, 62] {
        let (arm, runs) = (Arm::new(seed), 200);
        let mut covered = [0; 3];
        for run in 0..runs {
            let found = arm.find(&arm.logs(0.05, &mut Seed::new(1).stream("noise", run)), GainMethod::Total);
            for (covered, (gain, truth)) in covered.iter_mut().zip(found.gains.iter().zip(GAINS)) {
                let ends = gain.ci95.unwrap();
                *covered += usize::from(ends[0] <= truth && truth <= ends[1]);
            }
        }
        // 200 draws of 95 %: outside of 182 to 199 with a probability of 0.3 % for each of six gains.
        assert!(covered.iter().all(|covered| (182..=199).contains(covered)), "arm {seed}: {covered:?} of {runs}");
    }
}

#[test]
fn a_method_that_noise_biases_has_no_interval() {
    let arm = Arm::new(61);
    let logs = arm.logs(0.05, &mut Seed::new(1).stream("noise", 0));
    for method in GainMethod::ALL {
        let found = arm.find(&logs, method);
        let has_intervals = found.gains.iter().all(|gain| gain.std.is_some() && gain.ci95.is_some());
        assert_eq!(has_intervals, method == GainMethod::Total);
        assert_eq!(found.degrees_of_freedom.is_some(), has_intervals);
    }
}

#[test]
fn analytic_noise_draws_the_gains_of_least_squares_to_zero_and_not_those_of_total_least_squares() {
    let arm = Arm::new(61);
    let runs = 40;
    let (mut plain, mut total, mut spread) = (0.0, 0.0, 0.0);
    for run in 0..runs {
        let logs = arm.logs(0.2, &mut Seed::new(2).stream("noise", run));
        let mean = |method| {
            let found = arm.find(&logs, method);
            assert!(found.termination.was_successful(), "{:?}", found.termination);
            found.gains.iter().zip(GAINS).map(|(gain, truth)| gain.value / truth - 1.0).sum::<f64>() / 3.0
        };
        let (of_plain, of_total) = (mean(GainMethod::Weighted), mean(GainMethod::Total));
        plain += of_plain / runs as f64;
        total += of_total / runs as f64;
        spread += of_total * of_total / runs as f64;
    }
    let error = (spread / runs as f64).sqrt();
    assert!(plain < -4.0 * error && total.abs() < 3.0 * error, "{plain} {total} of {error}");
}

#[test]
fn identity_all_gains_together_move_every_parameter_in_proportion() {
    let arm = Arm::new(61);
    let [mut without, _] = arm.logs(0.01, &mut Seed::new(3).stream("noise", 0));
    // Stated noise, so that weights do not follow the torque.
    without.noise =
        Some(NoiseModel::white(DMatrix::from_diagonal(&DVector::from_vec(vec![0.04, 0.3, 0.01])), false, 1e6));
    let moved = gain_slopes(&without).unwrap();
    let beta = |observation: &Observation| {
        EstimatorKind::Wls.estimator().estimate(&EstimationProblem::new(observation)).unwrap().beta()
    };
    let own = beta(&without);
    assert!((moved.column_sum() - &own).norm() < 1e-9 * own.norm());
    // Another route for one of them: the torque of joint 2 half as large again.
    let mut other = without.clone();
    other.y.iter_mut().skip(1).step_by(3).for_each(|y| *y *= 1.5);
    assert!(((beta(&other) - &own) * 2.0 - moved.column(1)).norm() < 1e-9 * moved.column(1).norm());
}

#[test]
fn without_a_load_no_gain_is_found() {
    let mut arm = Arm::new(61);
    arm.load = Inertia::from_array(&[0.0; 10]);
    let [without, with] = arm.logs(0.0, &mut Seed::new(0).stream("noise", 0));
    let refused = drive_gains(&without, &with, &arm.load, GainMethod::Total).unwrap_err();
    assert!(
        matches!(&refused, EstimationError::NotExcited { parameter, .. } if parameter.contains("gain")),
        "{refused}"
    );
    let other = Observation { robot: "another".to_owned(), ..with };
    let refused = drive_gains(&without, &other, &arm.load, GainMethod::Total).unwrap_err();
    assert!(matches!(refused, EstimationError::OtherRobot { .. }), "{refused}");
}
