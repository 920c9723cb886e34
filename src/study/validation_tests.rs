//! Every kind of validation motion against the limits, its definition, and predictions by another route.

use nalgebra::{DVector, Vector3};

use super::motion_kind::MotionKind;
use super::motions_to_predict::motions_to_predict;
use super::plan::{ExperimentSettings, StudyPlan, ValidationSettings};
use super::scorer::Scorer;
use super::setup::StudySetup;
use super::truth::Truth;
use super::truth_files::truth_text;
use super::validation::{ValidationError, ValidationMotions};
use crate::base::{Method, reduce};
use crate::dynamics::{Dynamics, States};
use crate::excitation::{EvaluationMotions, radkhah2007_start};
use crate::model::format::{parse_nominal, parse_robot};
use crate::model::{Columns, Limits, ReferenceUnits, Robot, StandardParameters, bundled};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::statistics::root_mean_square;

const SEED: Seed = Seed::new(1989);

/// Settings of 06, with fewer motions.
fn settings(trajectories: usize) -> (ExperimentSettings, ValidationSettings) {
    let experiment =
        ExperimentSettings { period_s: 10.0, harmonics: 5, rate_hz: 1000.0, periods: 5, discarded_periods: 1 };
    (experiment, ValidationSettings { trajectories, samples: 40, measured: 0, measured_on: MotionKind::Random })
}

fn named(name: &str) -> (Robot, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == name).unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let nominal = parse_nominal(entry.nominal, &robot).unwrap().parameters;
    (robot, nominal)
}

fn draw(robot: &Robot, nominal: &StandardParameters, count: usize) -> ValidationMotions {
    let (experiment, validation) = settings(count);
    ValidationMotions::draw(robot, nominal, &experiment, &validation, SEED).unwrap()
}

/// A study of 06 with few samples.
fn setup() -> StudySetup {
    let mut plan = StudyPlan::from_toml(include_str!("../../experiments/06-model-error/study.toml")).unwrap();
    plan.validation = settings(3).1;
    let (robot, nominal) = named(&plan.robot);
    let truth = Truth::from_toml(truth_text("crs-a460").unwrap(), &robot).unwrap();
    StudySetup::new(plan, robot, nominal, &truth).unwrap()
}

#[test]
fn identity_a_family_predicts_other_motions_of_its_kind_than_it_is_scored_on() {
    let (robot, nominal) = named("crs-a460");
    let mut plan = setup().plan;
    plan.validation.measured = 20;
    let of = |kind| motions_to_predict(kind, &robot, &nominal, &plan.experiment, plan.seed).unwrap();
    let kinds = [MotionKind::Random, MotionKind::Slow, MotionKind::PointToPoint].map(|kind| {
        let settings = ValidationSettings { measured_on: kind, ..plan.validation.clone() };
        let scored = ValidationMotions::draw(&robot, &nominal, &plan.experiment, &settings, plan.seed).unwrap();
        assert_eq!(of(kind), of(kind));
        assert_ne!(of(kind), EvaluationMotions::new(scored.measured, robot.dof()).unwrap());
        // Torque on them, of the nominal arm.
        let regressor = JointTorqueRegressor::new(&robot, Columns::default()).unwrap();
        let base = reduce(&robot, Columns::default(), Method::Structural, SEED).unwrap();
        let beta = base.beta(&nominal.vector(&robot, Columns::default()));
        (beta.transpose() * of(kind).gram(&robot, &regressor, &base) * beta)[(0, 0)]
    });
    assert!(kinds[1] < kinds[0], "{kinds:?}");
}

/// The torque of states by the regressor of every column of the parameters, which inverse dynamics has no part in.
fn torque(robot: &Robot, parameters: &StandardParameters, states: &States) -> Vec<f64> {
    let columns = Columns::default().with_terms_of(parameters);
    let regressor = JointTorqueRegressor::with_load(robot, columns, parameters);
    (regressor.stack(states) * parameters.vector(robot, columns)).as_slice().to_vec()
}

/// States of one kind of motion far more densely than they are drawn and tested with.
fn dense(motions: &ValidationMotions, kind: MotionKind) -> Vec<States> {
    match kind {
        MotionKind::Random => motions.random.iter().map(|motion| motion.sample(2003)).collect(),
        MotionKind::Slow => motions.random.iter().map(|motion| motion.at_speed(0.3).sample(2003)).collect(),
        MotionKind::PointToPoint => motions.moves.iter().map(|made| made.sample(1999)).collect(),
        MotionKind::Static => motions.states(MotionKind::Static),
    }
}

/// Asserts that states are inside every limit, the root mean square over them inside the continuous torque.
fn assert_inside(robot: &Robot, nominal: &StandardParameters, states: &States, kind: MotionKind) {
    let (n, tau) = (robot.dof(), torque(robot, nominal, states));
    for (j, joint) in robot.joints().iter().enumerate() {
        let of = |values: &[f64]| values.iter().skip(j).step_by(n).copied().collect::<Vec<f64>>();
        let largest = |values: &[f64]| of(values).into_iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let (limits, name) = (&joint.limits, format!("{} {} {kind:?}", robot.name(), joint.name));
        let (low, high) = limits.position;
        assert!(of(&states.q).iter().all(|q| (low..=high).contains(q)), "{name}");
        assert!(largest(&states.qd) <= limits.velocity, "{name}: {} rad/s", largest(&states.qd));
        assert!(largest(&states.qdd) <= limits.acceleration, "{name}: {} rad/s²", largest(&states.qdd));
        assert!(largest(&tau) <= limits.torque, "{name}: {} of {} N·m", largest(&tau), limits.torque);
        let effective = if kind == MotionKind::Static { largest(&tau) } else { root_mean_square(&of(&tau)) };
        assert!(effective <= limits.continuous_torque, "{name}: {effective} N·m");
    }
}

#[test]
fn every_kind_of_validation_motion_is_inside_all_ratings_between_samples_too() {
    for name in ["crs-a460", "puma-560", "staubli-tx40"] {
        let (robot, nominal) = named(name);
        // The robots state no continuous torque: here it is 80 % of the rating.
        let robot = robot.with_joints(|joint| joint.limits.continuous_torque = 0.8 * joint.limits.torque).unwrap();
        let motions = draw(&robot, &nominal, 6);
        for kind in MotionKind::ALL {
            let all = dense(&motions, kind);
            assert_eq!(all.len(), 6);
            all.iter().for_each(|states| assert_inside(&robot, &nominal, states, kind));
        }
    }
}

#[test]
fn what_an_arm_measures_is_inside_all_ratings_in_periods_of_whole_samples() {
    let (robot, nominal) = named("crs-a460");
    for measured_on in [MotionKind::Random, MotionKind::Slow, MotionKind::PointToPoint] {
        let (experiment, validation) = settings(1);
        let validation = ValidationSettings { measured: 3, measured_on, ..validation };
        let motions = ValidationMotions::draw(&robot, &nominal, &experiment, &validation, SEED).unwrap();
        assert_eq!((motions.measured.len(), motions.random.len()), (3, 3));
        for (motion, random) in motions.measured.iter().zip(&motions.random) {
            let blocks = motion.period_s() * experiment.rate_hz / 500.0;
            assert!((blocks - blocks.round()).abs() < 1e-9, "{blocks}");
            assert_inside(&robot, &nominal, &motion.sample(4001), measured_on);
            let slower = motion.period_s() / random.period_s();
            assert!(measured_on != MotionKind::Slow || (1.0 / 0.3..1.0 / 0.3 + 0.05).contains(&slower), "{slower}");
        }
    }
}

#[test]
fn identity_random_motions_without_ratings_are_the_first_draws_and_others_are_drawn_again() {
    let (robot, nominal) = named("crs-a460");
    let (experiment, _) = settings(20);
    let first: Vec<_> = (0..20)
        .map(|index| {
            radkhah2007_start(&robot, experiment.period_s, experiment.harmonics, SEED.child("validation", 0), index)
                .unwrap()
                .into()
        })
        .collect();
    let free = robot.clone().with_joints(|joint| joint.limits.torque = f64::INFINITY).unwrap();
    assert_eq!(draw(&free, &nominal, 20).random, first);
    let motions = draw(&robot, &nominal, 20);
    let mut again = 0;
    for (motion, first) in motions.random.iter().zip(&first) {
        let states: States = first.sample(2003);
        let tau = torque(&robot, &nominal, &states);
        let mut joints = (0..tau.len()).map(|row| tau[row].abs() / robot.joints()[row % 6].limits.torque);
        if motion == first {
            assert!(joints.all(|used| used <= 1.0));
        } else {
            // Some use between 99 and 100 % of a rating.
            assert!(joints.any(|used| used > 0.98));
            again += 1;
        }
    }
    assert!((1..10).contains(&again), "{again} of 20 were drawn again");
    // A motion does not depend on how many there are.
    assert_eq!(draw(&robot, &nominal, 5).random, motions.random[..5]);
    assert_eq!(draw(&robot, &nominal, 5).moves, motions.moves[..5]);
}

#[test]
fn identity_slow_motions_are_the_random_ones_in_longer_time() {
    let (robot, nominal) = named("crs-a460");
    let motions = draw(&robot, &nominal, 3);
    let (random, slow) = (motions.states(MotionKind::Random), motions.states(MotionKind::Slow));
    let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID).unwrap();
    let phi = nominal.vector(&robot, Columns::RIGID);
    for ((motion, random), slow) in motions.random.iter().zip(&random).zip(&slow) {
        let stretched = motion.at_speed(0.3).sample(40);
        assert_eq!(slow.q, random.q);
        for (found, expected) in [(&slow.q, &stretched.q), (&slow.qd, &stretched.qd), (&slow.qdd, &stretched.qdd)] {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 * (1.0 + b.abs())));
        }
        // Of rigid bodies, what is not weight falls with the square of speed.
        let rest = States { qd: vec![0.0; 240], qdd: vec![0.0; 240], ..random.clone() };
        let [fast, slow, weight] = [random, slow, &rest].map(|states| regressor.stack(states) * &phi);
        let left: DVector<f64> = (&slow - &weight) - 0.09 * (&fast - &weight);
        assert!(left.amax() < 1e-12 * fast.amax(), "{}", left.amax());
    }
}

#[test]
fn moves_rest_at_their_poses_and_are_as_fast_as_the_limits_allow() {
    let (robot, nominal) = named("puma-560");
    let motions = draw(&robot, &nominal, 8);
    for (made, states) in motions.moves.iter().zip(motions.states(MotionKind::PointToPoint)) {
        let last = states.len() - 1;
        assert_eq!((states.q(0), states.qd(0), states.qdd(0)), (&made.from[..], &[0.0; 6][..], &[0.0; 6][..]));
        assert!(states.q(last).iter().zip(&made.to).all(|(q, to)| (q - to).abs() < 1e-14));
        assert!(states.qd(last).iter().chain(states.qdd(last)).all(|value| value.abs() == 0.0));
        // 90 % of a limit of motion, or a torque that a speed higher by a step would take beyond 90 % of its rating.
        let states = made.sample(2001);
        let mut faster = states.clone();
        faster.qd.iter_mut().for_each(|speed| *speed *= 1.05);
        faster.qdd.iter_mut().for_each(|acceleration| *acceleration *= 1.05 * 1.05);
        let tau = torque(&robot, &nominal, &faster);
        let used = |values: &[f64], limit: fn(&Limits) -> f64| {
            let shares = (0..values.len()).map(|row| values[row].abs() / limit(&robot.joints()[row % 6].limits));
            shares.fold(0.0_f64, f64::max)
        };
        let motion = used(&states.qd, |limits| limits.velocity).max(used(&states.qdd, |limits| limits.acceleration));
        let torque = used(&tau, |limits| limits.torque);
        assert!(motion < 0.9 + 1e-9 && (motion > 0.9 - 1e-5 || torque > 0.9), "{motion} {torque}");
    }
}

#[test]
fn motions_of_an_arm_that_cannot_carry_itself_are_refused() {
    let (robot, nominal) = named("crs-a460");
    let (experiment, validation) = settings(1);
    let weak = robot.with_joints(|joint| joint.limits.torque = 0.01).unwrap();
    let fault = ValidationMotions::draw(&weak, &nominal, &experiment, &validation, SEED).unwrap_err();
    assert!(matches!(fault, ValidationError::Rating { kind: MotionKind::Random, draws: 100 }), "{fault}");
    assert!(fault.to_string().starts_with("none of 100 draws of a random validation motion"), "{fault}");
}

/// An arm without weight and friction: every torque is one of motion.
fn weightless() -> (Robot, StandardParameters) {
    let (robot, nominal) = named("planar-2r");
    let robot = robot.with_gravity(Vector3::zeros()).with_joints(|joint| joint.limits.torque = 1.0).unwrap();
    (robot, nominal.links_alone())
}

#[test]
fn motions_that_no_draw_keeps_inside_a_small_rating_become_smaller() {
    let (robot, nominal) = weightless();
    let motions = draw(&robot, &nominal, 3);
    for kind in MotionKind::ALL {
        dense(&motions, kind).iter().for_each(|states| assert_inside(&robot, &nominal, states, kind));
    }
    for motion in &motions.random {
        let states = motion.sample(400);
        let fastest = states.qd.iter().fold(0.0_f64, |most, speed| most.max(speed.abs()));
        assert!(motion.period_s() == 10.0 && fastest > 0.05 && fastest < 0.8 * robot.joints()[0].limits.velocity);
    }
}

#[test]
fn an_arm_without_weight_has_no_score_at_rest() {
    let (robot, nominal) = weightless();
    let motions = draw(&robot, &nominal, 2);
    let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID).unwrap();
    let base = reduce(&robot, Columns::RIGID, Method::Structural, SEED).unwrap();
    let truths = [Truth::without_effects(nominal)];
    let scorer = Scorer::new(&robot, &truths, &regressor, &base, &motions, &ReferenceUnits::default());
    let score = scorer.score(&(&scorer.truths[0] * 1.1), 0, None);
    assert!(score.static_rmse_nm.is_none() && score.slow_rmse_nm > 0.0 && score.point_to_point_rmse_nm > 0.0);
}

#[test]
fn identity_scores_of_the_truth_are_zero() {
    let setup = setup();
    let score = setup.scorer.score(&setup.scorer.truths[0], 0, None);
    let found = [score.prediction_rmse_nm, score.slow_rmse_nm, score.point_to_point_rmse_nm];
    assert_eq!((found, score.static_rmse_nm, score.measured_rmse_nm), ([0.0; 3], Some(0.0), None));
    // Off by one unit in each parameter.
    let score = setup.scorer.score(&(&setup.scorer.truths[0] + &setup.scorer.units), 0, None);
    let units = root_mean_square(setup.scorer.units.as_slice());
    assert!((score.reference_rmse - 1.0).abs() < 1e-9 && (score.si_rmse / units - 1.0).abs() < 1e-9, "{score:?}");
}

#[test]
fn identity_scores_are_the_difference_of_torques_by_inverse_dynamics() {
    let setup = setup();
    let truth = setup.truth(0).parameters.clone();
    // An estimate that is the nominal arm: the torques of both come from recursions that no base parameter enters.
    let estimate = setup.base.beta(&setup.nominal.vector(&setup.robot, setup.regressor.columns()));
    let score = setup.scorer.score(&estimate, 0, None);
    let found = [
        Some(score.prediction_rmse_nm),
        Some(score.slow_rmse_nm),
        Some(score.point_to_point_rmse_nm),
        score.static_rmse_nm,
    ];
    let (mut of_truth, mut of_nominal) =
        (Dynamics::new(&setup.robot, &truth), Dynamics::new(&setup.robot, &setup.nominal));
    for (kind, found) in MotionKind::ALL.into_iter().zip(found) {
        let (mut differences, mut a, mut b) = (Vec::new(), [0.0; 6], [0.0; 6]);
        for states in setup.validation.states(kind) {
            for k in 0..states.len() {
                of_truth.inverse(states.q(k), states.qd(k), states.qdd(k), &mut a);
                of_nominal.inverse(states.q(k), states.qd(k), states.qdd(k), &mut b);
                differences.extend(a.iter().zip(b).map(|(a, b)| a - b));
            }
        }
        let expected = root_mean_square(&differences);
        assert!(expected > 0.01 && (found.unwrap() / expected - 1.0).abs() < 1e-9, "{kind:?}: {found:?} {expected}");
        if kind == MotionKind::Random {
            let rating = |row: usize| setup.robot.joints()[row % 6].limits.torque;
            let shares: Vec<f64> = differences.iter().enumerate().map(|(row, nm)| nm / rating(row)).collect();
            let (found, expected) = (score.prediction_rmse_of_rating, root_mean_square(&shares));
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }
}
