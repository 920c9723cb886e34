//! An effect that is a torque term is found by a model that has the term, and goes where theory says in one without.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use armid::base::{Method, reduce};
use armid::estimation::{EstimationProblem, Estimator, EstimatorKind, Observation};
use armid::experiment::{ActualArm, EffectKind, Effects, ExperimentPlan, Sensing, Servo, record};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::term::{COULOMB, COULOMB_DIRECTION, OFFSET, POSITION_COSINE, POSITION_SINE, SPRING, Term};
use armid::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters, bundled};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid::study::{Truth, truth_text};
use armid::trajectory::{FourierJoint, FourierTrajectory};
use armid_sim::AnalyticPlant;
use nalgebra::DVector;

/// The planar arm, and what is true of it.
fn planar() -> (Robot, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == "planar-2r").unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let truth = Truth::from_toml(truth_text("planar-2r").unwrap(), &robot).unwrap().parameters;
    (robot, truth)
}

/// Ten seconds of motion.
fn motion(robot: &Robot) -> FourierTrajectory {
    let series = [([0.9, 0.5, -0.4], [0.3, -0.6, 0.5]), ([-1.1, 0.6, 0.4], [0.5, 0.7, -0.6])];
    let joints = robot.joints().iter().zip(series).map(|(joint, (a, b))| FourierJoint {
        name: joint.name.clone(),
        a: a.to_vec(),
        b: b.to_vec(),
        q0: 0.4,
    });
    FourierTrajectory { period_s: 10.0, joints: joints.collect() }
}

/// An experiment on the arm with one effect.
struct Experiment {
    kind: EffectKind,
    magnitude: f64,
    /// Velocity scale of the smooth sign, rad/s.
    velocity: f64,
}

impl Experiment {
    fn arm(&self) -> (Robot, StandardParameters, ActualArm) {
        let (robot, truth) = planar();
        let robot = robot.with_joints(|joint| joint.drive.coulomb_velocity = self.velocity).unwrap();
        let arm = ActualArm::new(&Effects::none().with_effect(self.kind, self.magnitude), &robot, &truth);
        (robot, truth, arm)
    }

    /// What is true of a term: of the arm with the effect, and of the arm itself.
    fn truth(&self, of: Term) -> [(f64, f64); 2] {
        let (_, truth, arm) = self.arm();
        [0, 1].map(|i| (arm.parameters().drives[i][of], truth.drives[i][of]))
    }

    /// What OLS finds of one term by ideal sensors, with friction and these terms; equations near reversals are left out.
    fn found(&self, terms: &[Term], of: Term) -> [f64; 2] {
        let (robot, _, arm) = self.arm();
        let entry = bundled().iter().find(|entry| entry.name == "planar-2r").unwrap();
        let nominal = parse_nominal(entry.nominal, &robot).unwrap().parameters;
        let columns = terms.iter().fold(Columns::RIGID_ROTOR_FRICTION, |columns, &term| columns.with_term(term));
        let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
        let regressor = JointTorqueRegressor::new(&robot, columns).expect("columns of motion");
        let plant = AnalyticPlant::new(arm.robot(), arm.parameters()).unwrap();
        let mut servo = Servo::new(&robot, &nominal, plant).unwrap().with_sensing(Sensing::ideal()).with_effects(arm);
        let plan = ExperimentPlan { settle_s: 0.2, ramp_s: 1.0, periods: 1, ..ExperimentPlan::new(motion(&robot)) };
        let (recording, ending) = record(&mut servo, &plan).unwrap();
        assert!(ending.is_complete(), "{ending:?}");
        let processing = Processing { samples_per_period: 1000, reversal_fraction: 0.1, ..Processing::default() };
        let samples = process(&recording, &robot, &processing).unwrap();
        let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
        let beta = EstimatorKind::Ols.estimate(&EstimationProblem::new(&observation)).unwrap().beta();
        [0, 1].map(|index| {
            let id = ParameterId { kind: ParameterKind::Term(of), index };
            let place = base.kept.iter().position(|&kept| regressor.parameters()[kept] == id);
            beta[place.unwrap()]
        })
    }
}

#[test]
fn simulated_friction_of_two_directions_is_an_offset_and_with_its_term_itself() {
    let experiment = Experiment { kind: EffectKind::DirectionFriction, magnitude: 0.3, velocity: 0.01 };
    let (by_direction, offset) = (experiment.truth(COULOMB_DIRECTION), experiment.found(&[], OFFSET));
    let (own, coulomb) = (experiment.truth(OFFSET), experiment.found(&[], COULOMB));
    for i in 0..2 {
        let expected = own[i].1 + by_direction[i].0;
        assert!((offset[i] - expected).abs() < 2e-3 * by_direction[i].0.abs(), "{offset:?} {expected}");
        assert!((coulomb[i] / experiment.truth(COULOMB)[i].1 - 1.0).abs() < 2e-3, "{coulomb:?}");
    }
    // Where the sign is as smooth as this, equations tell the term from an offset.
    let smooth = Experiment { velocity: 0.3, ..experiment };
    let terms = [COULOMB_DIRECTION];
    let found = smooth.found(&terms, COULOMB_DIRECTION);
    let offset = smooth.found(&terms, OFFSET);
    for i in 0..2 {
        assert!((found[i] / by_direction[i].0 - 1.0).abs() < 1e-2, "{found:?}");
        assert!((offset[i] / own[i].1 - 1.0).abs() < 1e-2, "{offset:?}");
    }
}

#[test]
fn simulated_friction_by_position_is_found_by_its_terms() {
    let experiment = Experiment { kind: EffectKind::PositionFriction, magnitude: 0.3, velocity: 0.01 };
    let terms = [POSITION_COSINE, POSITION_SINE];
    for term in terms {
        let (found, truth) = (experiment.found(&terms, term), experiment.truth(term));
        for i in 0..2 {
            assert!((found[i] / truth[i].0 - 1.0).abs() < 1e-2, "{term:?} {found:?} {truth:?}");
        }
    }
    // Without them it is taken for more or less Coulomb friction, by where the motion goes.
    let (coulomb, own) = (experiment.found(&[], COULOMB), experiment.truth(COULOMB));
    for i in 0..2 {
        assert!((coulomb[i] / own[i].1 - 1.0).abs() > 0.1, "{coulomb:?}");
    }
}

/// Torque of the strands of a cable of unit stiffness along a periodic path that begins at rest: in each of four, friction of
/// 0.2/8 N·m that holds until it has been bent by so much.
fn strands(path: &[f64]) -> Vec<f64> {
    let strength = 0.2 / 8.0;
    let (mut held, mut at, mut torque) = ([0.0_f64; 4], path[0], Vec::new());
    for &q in path.iter().cycle().take(2 * path.len()) {
        for (j, bend) in [0.05, 0.1, 0.15, 0.2].into_iter().enumerate() {
            held[j] = (held[j] + strength * (q - at) / bend).clamp(-strength, strength);
        }
        at = q;
        torque.push(held.iter().sum());
    }
    torque.split_off(path.len())
}

#[test]
fn simulated_spring_of_a_cable_is_found_by_its_term_but_for_what_its_strands_add() {
    let experiment = Experiment { kind: EffectKind::Cable, magnitude: 0.02, velocity: 0.01 };
    let truth = experiment.truth(SPRING);
    // What least squares make of the strands' torque along the motion as it is planned.
    let (robot, _, _) = experiment.arm();
    let columns = Columns::RIGID_ROTOR_FRICTION.with_term(SPRING);
    let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let regressor = JointTorqueRegressor::new(&robot, columns).expect("columns of motion");
    let states = motion(&robot).sample(1000);
    let torque: Vec<Vec<f64>> =
        (0..2).map(|i| strands(&(0..1000).map(|k| states.q(k)[i]).collect::<Vec<f64>>())).collect();
    let d = DVector::from_fn(2000, |row, _| truth[row % 2].0 * torque[row % 2][row / 2]);
    let w = base.select_columns(&regressor.stack(&states));
    let bias = w.svd(true, true).solve(&d, 1e-12).unwrap();
    let found = experiment.found(&[SPRING], SPRING);
    for index in 0..2 {
        let id = ParameterId { kind: ParameterKind::Term(SPRING), index };
        let place = base.kept.iter().position(|&kept| regressor.parameters()[kept] == id).unwrap();
        // Equations near reversals, where strands turn over, are left out of what is found: 1.5 % of the stiffness is measured.
        let expected = truth[index].0 + bias[place];
        assert!((found[index] - expected).abs() < 0.02 * truth[index].0, "{found:?} {expected} {truth:?}");
    }
}
